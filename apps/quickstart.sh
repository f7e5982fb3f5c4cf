#!/usr/bin/env bash
# quickstart.sh demo|test|build|packages: installs what is missing from the distribution's packages (Debian 12), and but for
# `packages` configures, builds a release and runs the demo or the tests. A second call does no work twice.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  g++ cmake ninja-build ccache
  libeigen3-dev libceres-dev libsuitesparse-dev libopenblas-serial-dev libopencv-dev libpcl-dev libtbb-dev libembree-dev
  libspdlog-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libpng-dev libxxhash-dev libnanoflann-dev
  zlib1g-dev libjs-three libjs-d3
  librosbag-storage-dev libsqlite3-dev libzstd-dev liblz4-dev libbz2-dev
  libgtest-dev libgmock-dev libbenchmark-dev xz-utils
)

say() { printf 'quickstart: %s\n' "$*" >&2; }

install_packages() {
  local missing=()
  for package in "${packages[@]}" "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  say "installing ${missing[*]}"
  local sudo=()
  [ "$(id -u)" -eq 0 ] || sudo=(sudo)
  "${sudo[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

build() {
  install_packages
  local werror=OFF
  [ "${CI:-}" = true ] && werror=ON
  cmake --preset release -DGROUNDLOOP_WERROR=$werror >/dev/null
  cmake --build --preset release
}

case "${1:-}" in
  demo)
    build
    shift
    exec build/release/groundloop demo "$@"
    ;;
  test)
    build
    # Slow tests last, so that a plain failure shows early.
    exec ctest --preset release -j "$(nproc)"
    ;;
  build) build ;;
  # For those who build in another way (apps/packaging/build.sh); further packages may be named.
  packages) install_packages "${@:2}" ;;
  *)
    echo "usage: apps/quickstart.sh demo|test|build|packages" >&2
    exit 2
    ;;
esac
