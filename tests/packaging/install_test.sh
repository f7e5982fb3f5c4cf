#!/usr/bin/env bash
# install_test.sh BUILD SOURCE WORK: installs the build tree into WORK, builds the example against what was installed, there and
# nowhere else, and lets both go over one recording.
set -euo pipefail
build=$1
source=$2
work=$3
fail() { echo "install_test: $*" >&2; exit 1; }
rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --prefix "$work/usr" > "$work/install.log"

for file in bin/groundloop share/man/man1/groundloop.1.gz share/man/man1/groundloop-evaluate-map.1.gz \
  share/bash-completion/completions/groundloop include/groundloop/backend.hpp; do
  [ -e "$work/usr/$file" ] || fail "no $file"
done
# Presets and the report's scripts are found though the tree is not looked at.
cd "$work"
usr/bin/groundloop config handheld > preset.yaml
usr/bin/groundloop --quiet simulate "sim:town?sensor=spin16&length=260&seed=3" --layout folder --out recording

cp -r "$source/apps/packaging/example" example
cmake -G Ninja -S example -B example/build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/usr" > example.log
cmake --build example/build >> example.log || { tail -30 example.log; fail "the example does not build"; }
# WORK may lie within the source tree, as build folders do.
sees=$(sed "s#$work/##g" example/build/build.ninja | grep -c "$source/" || true)
[ "$sees" = 0 ] || fail "the example sees the source tree"
example/build/revisits recording | tee revisits.log
scans=$(find recording -name '*.bin' -o -name '*.pcd' -o -name '*.ply' | wc -l)
grep -q "^$scans scans, " revisits.log || fail "the example went over another number of scans than $scans"
