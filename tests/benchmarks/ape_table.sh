#!/usr/bin/env bash
# Absolute pose error without closures, with the detector's own, with robust solving and with everything,
# and the normalised squared error (NEES) of the accepted closures, as Markdown on standard output.
#
#   tests/benchmarks/ape_table.sh build/release WORK_FOLDER [KITTI_FOLDER] > table.md
#
# RECORDINGS: pairs NAME=RECORDING, one a line. Sessions stay in WORK_FOLDER and are not run again; the
# variants are solved on each by groundloop_back_end_study.
set -eu
build=$(realpath "$1") work=$2 drive=${3:-}
recordings=${RECORDINGS:-"town_64=sim:town?sensor=spin64&length=1000&seed=1
town_16=sim:town?sensor=spin16&length=1550&seed=3
bridge_32=sim:bridge?sensor=spin32&length=1600&seed=7
town_64_quiet=sim:town?sensor=spin64&noise=0.3&length=3000&seed=12
town_16_long=sim:town?sensor=spin16&length=16000&seed=3"}
mkdir -p "$work"
{
  [ -z "$drive" ] || echo "real_drive=$drive"
  echo "$recordings"
} | while IFS= read -r line; do
  name=${line%%=*} recording=${line#*=}
  [ -f "$work/$name/manifest.json" ] ||
    "$build/groundloop" --quiet run "$recording" --out "$work/$name" --set map.write=false < /dev/null >&2
  echo
  "$build/tests/benchmarks/groundloop_back_end_study" "$work/$name" < /dev/null | sed '1a\\'
done
