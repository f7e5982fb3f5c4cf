#!/usr/bin/env bash
# Merges simulated sessions of different sensors, platforms, days and places, and the real drive in two
# halves, and writes what came out as a Markdown table to standard output.
#
#   tests/benchmarks/merge_table.sh build/release/groundloop WORK_FOLDER [KITTI_FOLDER] > table.md
#
# LENGTH (m, 600; a walker goes half of it), SEED (5), THREADS (2). Sessions stay in WORK_FOLDER and are not run again.
set -u
binary=$(realpath "$1") work=$2 drive=${3:-}
length=${LENGTH:-600} seed=${SEED:-5} threads=${THREADS:-2}
mkdir -p "$work"

# session NAME RECORDING [OPTION]...: runs it once.
session() {
  local name=$1 recording=$2
  shift 2
  [ -f "$work/$name/manifest.json" ] && return
  "$binary" --quiet --threads "$threads" run "$recording" --out "$work/$name" --set map.write=false "$@" >&2 ||
    echo "session $name failed" >&2
}

# row CASE REFERENCE QUERY...: merges and prints one row of the table.
row() {
  local name=$1 out="$work/merged_$(echo "$*" | tr -c 'a-z0-9\n' _)"
  shift
  local inputs=()
  for s in "$@"; do inputs+=("$work/$s"); done
  "$binary" --quiet --threads "$threads" merge "${inputs[@]}" --out "$out" --set map.write=false 2> "$out.log" ||
    { echo "| $name | $* | failed: $(tail -1 "$out.log") |"; return; }
  python3 - "$name" "$*" "$out" << 'PYTHON'
import json, sys
name, sessions, out = sys.argv[1:]
m = json.load(open(out + "/metrics.json"))
truth = m.get("closures_against_ground_truth")
joined = sum(1 for p in m["pairs"] if p["one_frame"])
drifts = [s["odometry_drift"] for s in m["sessions"].values()]
drift = ", ".join(f"{d['kitti_translation_percent']:.2f} / {d['end_error_percent']:.2f}" if d else "" for d in drifts)
cells = [name, sessions, drift, f"{joined} of {len(m['pairs'])}",
         f"{m['closures']['between_sessions']['candidates']}",
         f"{m['closures']['between_sessions']['accepted']}",
         f"{truth['precision']:.2f}" if truth else "",
         f"{truth['translation_m']['median']:.2f} m, {truth['rotation_deg']['median']:.2f} deg" if truth else ""]
by_reference = []
for s in m["sessions"].values():
    ape = s["ape"]["by_reference"]
    by_reference.append(f"{ape['translation_m']['rmse']:.2f}" if ape else "")
cells.append(" ".join(x for x in by_reference if x))
cells.append(f"{m['ape']['optimised']['translation_m']['rmse']:.2f}" if m.get("ape") and m["ape"]["optimised"] else "")
cells.append(f"{m['timing_s']['total']:.1f}")
print("| " + " | ".join(cells) + " |", flush=True)
PYTHON
}

town="sim:town?length=$length&seed=$seed"
session spin64 "$town&sensor=spin64&route=1"
session changed "$town&sensor=spin64&route=2&change=1"
session spin128 "$town&sensor=spin128&route=1&change=1"
session raster "$town&sensor=raster&route=1&change=1"
session rosette "$town&sensor=rosette&route=1&change=2"
session walker "sim:town?length=$((length / 2))&seed=$seed&sensor=spin64&carrier=walker&route=1&change=1"
session west "$town&sensor=spin64&side=west&route=1"
session east "$town&sensor=spin64&side=east&route=2&change=1"
session back "$town&sensor=spin64&route=1&way=back&change=1"
session raster_back "$town&sensor=raster&route=1&way=back&change=1"
session rosette_back "$town&sensor=rosette&route=1&way=back&change=2"
session elsewhere "sim:town?length=$length&seed=$((seed + 4))&sensor=spin64"
session bridge "sim:bridge?length=$length&seed=1&sensor=spin32"
session other_bridge "sim:bridge?length=$length&seed=5&sensor=spin32"

echo "| case | sessions | drift of odometry, % | pairs joined | candidates | accepted | precision | median error of closures | APE by the reference's alignment, m | joint APE, m | s |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
row "same sensor, changed world, other route" spin64 changed
row "64 beams, 128 beams" spin64 spin128
row "spinning, raster" spin64 raster
row "spinning, rosette" spin64 rosette
row "raster, rosette" raster rosette
row "car, walker" spin64 walker
row "opposite way: same sensor" spin64 back
row "opposite way: spinning, raster" spin64 raster_back
row "opposite way: spinning, rosette" spin64 rosette_back
row "opposite way: rasters" raster raster_back
row "one street in common" west east
row "no overlap" spin64 elsewhere
row "look-alikes: a bridge, another bridge" bridge other_bridge
row "three, of which one is unconnected" spin64 changed elsewhere
cp -r "$work/changed" "$work/damaged" 2> /dev/null && head -c 1000 "$work/changed/loop_database.bin" > "$work/damaged/loop_database.bin"
row "three, of which one is damaged" spin64 spin128 damaged
if [ -n "$drive" ]; then
  session first_half "$drive" --count 950
  session second_half "$drive" --first 950
  row "the real drive in two halves" first_half second_half
fi
