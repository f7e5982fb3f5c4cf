#!/usr/bin/env bash
# fuzz.sh FOLDER [SECONDS] [TARGET...]: builds the fuzz targets with clang's libFuzzer and sanitizers, runs each for so many
# seconds (60), and prints executions, edges reached and findings. FOLDER keeps the inputs found
# from run to run: FOLDER/corpus/TARGET, findings in FOLDER/findings/TARGET. Needs clang and libclang-rt-dev.
set -euo pipefail
cd "$(dirname "$0")/../.."
[ $# -ge 1 ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
mkdir -p "$1"
folder=$(cd "$1" && pwd)
seconds=${2:-60}
shift $(($# > 2 ? 2 : $#))

cmake --preset fuzz >/dev/null
cmake --build --preset fuzz
bin=build/fuzz/tests/fuzz
$bin/groundloop_fuzz_replay --seeds "$folder/corpus"
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <($bin/groundloop_fuzz_replay --targets)

printf '| target | executions | a second | edges reached | inputs kept | findings |\n| --- | ---: | ---: | ---: | ---: | ---: |\n'
failed=0
for target in "${targets[@]}"; do
  findings=$folder/findings/$target
  mkdir -p "$findings" "$folder/log"
  # Leaks are looked for at the end only: every run of a target builds and drops whole pipelines.
  "$bin/fuzz_$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=65536 -detect_leaks=0 \
    -artifact_prefix="$findings/" -print_final_stats=1 "$folder/corpus/$target" >"$folder/log/$target" 2>&1 || failed=1
  log=$folder/log/$target
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  speed=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
  edges=$(grep -oE 'cov: [0-9]+' "$log" | tail -1 | cut -d' ' -f2)
  printf '| %s | %s | %s | %s | %s | %s |\n' "$target" "${executions:-?}" "${speed:-?}" "${edges:-?}" \
    "$(find "$folder/corpus/$target" -type f | wc -l)" "$(find "$findings" -type f | wc -l)"
done
exit $failed
