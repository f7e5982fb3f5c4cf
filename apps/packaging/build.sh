#!/usr/bin/env bash
# build.sh [OUT]: the Debian packages of this version in OUT (build/package/debs). Installs what the build needs.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=$(realpath -m "${1:-build/package/debs}")
apps/quickstart.sh packages pybind11-dev python3-dev python3-numpy dpkg-dev
# Files in a package are as old as the release: the same tree gives the same packages.
version=$(sed -n 's/^project(groundloop VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
day=$(sed -n "s/^## $version (\(.*\))$/\1/p" apps/docs/changelog.md)
SOURCE_DATE_EPOCH=$(date -u -d "$day 12:00" +%s)
export SOURCE_DATE_EPOCH
cmake --preset package > /dev/null
cmake --build --preset package
mkdir -p "$out"
(cd build/package && cpack -B "$out" > /dev/null)
rm -rf "$out/_CPack_Packages"
ls "$out"/*.deb
