#!/usr/bin/env bash
# Runs every Google Benchmark and a series of whole runs, and writes tables (Markdown, standard output) and a plot of
# what each stage costs as recordings grow (cost_by_length.svg beside this script).
#
#   tests/benchmarks/run_all.sh [BUILD_FOLDER] [WORK_FOLDER] > tests/benchmarks/benchmarks.md
#
# LENGTHS (m of way, "500 1000 2000 4000"), SENSORS ("spin16 spin64"), DRIVE (folder of a real recording, none), WRITTEN
# (m of a way with 64 beams that is written out first and read from disk, 600; 0: none),
# FILTER (of benchmarks, all), PARTS ("stages runs"). Sessions stay in WORK_FOLDER and are not run again.
# Processor seconds are compared, not the clock, where the machine is shared.
set -eu
cd "$(dirname "$0")/../.."
build=${1:-build/release} work=${2:-build/benchmarks}
lengths=${LENGTHS:-500 1000 2000 4000} sensors=${SENSORS:-spin16 spin64} drive=${DRIVE:-} written=${WRITTEN:-600} parts=${PARTS:-stages runs}
mkdir -p "$work"

printf '# Benchmarks\n\nMade by `tests/benchmarks/run_all.sh` on %s cores of %s; load average at the start %s.\n' "$(nproc)" \
  "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)" "$(cut -d' ' -f1 /proc/loadavg)"

if [[ $parts == *stages* ]]; then
  # A session of the real drive, whose local maps the stages of loop closing are measured on.
  if [ -n "$drive" ]; then
    [ -f "$work/drive_all/metrics.json" ] || "$build/groundloop" --quiet run "$drive" --out "$work/drive_all" >&2
    export GROUNDLOOP_SESSION=$work/drive_all
  fi
  printf '\n## Stages\n\n| benchmark | clock | processor, calling thread | counters |\n| --- | --- | --- | --- |\n'
  "$build/tests/benchmarks/groundloop_benchmarks" --benchmark_format=json --benchmark_filter="${FILTER:-.}" 2>"$work/log" |
    awk -F'": ' '
      function plain(text) { gsub(/[",]/, "", text); sub(/^ */, "", text); return text }
      function row() { if (name != "") printf "| `%s` | %.3g %s | %.3g %s |%s |\n", name, clock, unit, cpu, unit, counters; name = "" }
      /^ *"name"/ { row(); name = plain($2); counters = ""; unit = "" }
      /^ *"real_time"/ { clock = plain($2) } /^ *"cpu_time"/ { cpu = plain($2) }
      /^ *"time_unit"/ { unit = plain($2); next }
      unit != "" && /^ *"[^"]*": -?[0-9]/ { counters = counters sprintf("%s %s %.4g", counters == "" ? "" : ",", plain($1), plain($2)) }
      END { row() }'
fi
[[ $parts == *runs* ]] || exit 0

# number FILE KEY [OBJECT]: the first number of that name in a JSON file, within the named object if one is given.
number() {
  awk -v key="\"$2\":" -v object="${3:+\"$3\":}" '
    object != "" && !inside { inside = index($0, object) > 0; next }
    index($0, key) { sub(/.*: */, ""); sub(/[, ].*/, ""); print; exit }' "$1"
}

stages="read odometry ground_alignment density_image features matching consensus verification optimisation map"
printf '\n## Whole runs\n\nBusy milliseconds a scan by stage, and the peak of resident memory.\n\n| recording | scans | maps | closures |'
for stage in $stages; do printf ' %s |' "${stage//_/ }"; done
printf ' scans/s | peak MB |\n| --- | --- | --- | --- |'
for stage in $stages; do printf ' --- |'; done
printf ' --- | --- |\n'
: > "$work/runs.csv"
run() {  # SENSOR LENGTH RECORDING
  local out=$work/$1_$2
  [ -f "$out/metrics.json" ] || "$build/groundloop" --quiet run "$3" --out "$out" >&2
  local file=$out/metrics.json scans
  scans=$(number "$file" scans)
  printf '| `%s` | %s | %s | %s |' "$3" "$scans" "$(number "$file" local_maps)" "$(number "$file" accepted closures)"
  for stage in $stages; do
    local seconds
    seconds=$(number "$file" "$stage" timing_s)
    printf ' %s |' "$(awk -v s="$seconds" -v n="$scans" 'BEGIN { printf "%.2f", 1000 * s / n }')"
    printf '%s,%s,%s,%s\n' "$1" "$scans" "$stage" "$seconds" >> "$work/runs.csv"
  done
  printf ' %.1f | %.0f |\n' "$(number "$file" scans_per_second)" "$(number "$file" peak_memory_mb)"
}
for sensor in $sensors; do
  for length in $lengths; do run "$sensor" "$length" "sim:town?sensor=$sensor&length=$length&seed=3"; done
done
[ -z "$drive" ] || run drive all "$drive"
if [ "$written" != 0 ]; then
  [ -d "$work/written" ] || {
    "$build/groundloop" --quiet simulate "sim:town?sensor=spin64&length=$written&seed=3" --layout kitti --out "$work/written.part" >&2
    mv "$work/written.part" "$work/written"
  }
  run written "$written" "$work/written"
fi

# Busy seconds over scans, both axes logarithmic, for the first sensor: slope 1 is a constant cost a scan.
awk -F, -v sensor="${sensors%% *}" '
  function x(n) { return 60 + 400 * (log(n) - log(low)) / (log(high) - log(low)) }
  function y(s) { return 330 - 300 * (log(s) - log(0.01)) / (log(1000) - log(0.01)) }
  $1 == sensor && $4 > 0 { n[++count] = $2; stage[count] = $3; s[count] = $4 < 0.01 ? 0.01 : $4
    if (!low || $2 < low) low = $2; if ($2 > high) high = $2; if (!($3 in seen)) { seen[$3] = ++kinds; name[kinds] = $3 } }
  END {
    print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"620\" height=\"380\" font-family=\"sans-serif\" font-size=\"11\">"
    print "<rect width=\"620\" height=\"380\" fill=\"white\"/>"
    for (e = -2; e <= 3; ++e) printf "<path d=\"M60 %.1fH460\" stroke=\"#ddd\"/><text x=\"54\" y=\"%.1f\" text-anchor=\"end\">%g s</text>\n", y(10^e), y(10^e) + 4, 10^e
    for (i = 1; i <= count; ++i) if (!(n[i] in drawn)) { drawn[n[i]] = 1
      printf "<path d=\"M%.1f 30V330\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"346\" text-anchor=\"middle\">%d</text>\n", x(n[i]), x(n[i]), n[i] }
    print "<text x=\"260\" y=\"368\" text-anchor=\"middle\">scans</text><text x=\"60\" y=\"18\">busy time by stage, " sensor "</text>"
    for (k = 1; k <= kinds; ++k) {
      colour = sprintf("hsl(%d,70%%,42%%)", 360 * (k - 1) / kinds); line = ""
      for (i = 1; i <= count; ++i) if (stage[i] == name[k]) { line = line (line == "" ? "M" : "L") sprintf("%.1f %.1f", x(n[i]), y(s[i])); end = y(s[i]) }
      printf "<path d=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\"/>\n", line, colour
      printf "<path d=\"M478 %dh18\" stroke=\"%s\" stroke-width=\"3\"/><text x=\"502\" y=\"%d\">%s</text>\n", 40 + 18 * k, colour, 44 + 18 * k, name[k]
    }
    print "</svg>"
  }' "$work/runs.csv" > tests/benchmarks/cost_by_length.svg
printf '\n![Cost of each stage over the number of scans](cost_by_length.svg)\n'
