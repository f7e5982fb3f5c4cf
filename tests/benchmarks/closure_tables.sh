#!/usr/bin/env bash
# Runs the claims of the paper on simulated recordings and, where it is given, on the real drive, and
# writes them as Markdown to standard output.
#
#   tests/benchmarks/closure_tables.sh build/release/groundloop WORK_FOLDER [KITTI_FOLDER] > closure_tables.md
#
# Settings, all with defaults:
#   LENGTH   of simulated ways, m (1200); TILT_LENGTH of those of walker and segway, slow as they are (600)
#   SEEDS    of simulated worlds of the first sensor ("21 22 23 24 25", none of them used while tuning)
#   FEW      seeds of all other rows ("21 22")
#   TABLES   "sensors bridge tilt traffic drive"
#   SENSORS  of the table of sensors ("spin32 spin64 spin128 raster rosette")
#   SENSOR   of the other tables (spin32)
# Sessions stay in WORK_FOLDER, and neither they nor their evaluations are run again.
set -eu
binary=$(realpath "$1") work=$2 drive=${3:-}
length=${LENGTH:-1200} tilt_length=${TILT_LENGTH:-600}
seeds=${SEEDS:-21 22 23 24 25} few=${FEW:-21 22} tables=${TABLES:-sensors bridge tilt traffic drive}
sensors=${SENSORS:-spin32 spin64 spin128 raster rosette} sensor=${SENSOR:-spin32}
mkdir -p "$work"

# session NAME RECORDING [--set KEY=VALUE]...: runs it once, and its evaluation.
session() {
  local name=$1 recording=$2
  shift 2
  [ -f "$work/$name/manifest.json" ] || "$binary" --quiet run "$recording" --out "$work/$name" "$@" >&2
  [ -f "$work/$name.json" ] || "$binary" evaluate closures "$work/$name" --json > "$work/$name.json.part"
  [ -f "$work/$name.json" ] || mv "$work/$name.json.part" "$work/$name.json"
}

# value FILE PATH...: members of a JSON document by path ("a.b.c"), in a row of Markdown cells; three digits.
value() {
  local file=$1
  shift
  awk -v wanted="$*" '
    { line = $0; sub(/^ */, "", line); sub(/,$/, "", line) }
    match(line, /^"[^"]*": /) {
      key = substr(line, 2, RLENGTH - 4); rest = substr(line, RLENGTH + 1)
      if (rest == "{" || rest == "[") { path[++depth] = key; next }
      name = ""
      for (i = 1; i <= depth; ++i) if (path[i] != "") name = name path[i] "."
      found[name key] = rest
      next
    }
    line == "{" || line == "[" { path[++depth] = ""; next }
    line == "}" || line == "]" { --depth }
    END {
      n = split(wanted, keys, " ")
      for (i = 1; i <= n; ++i) {
        v = (keys[i] in found) ? found[keys[i]] : "-"
        if (v == "null") v = "-"
        else if (v ~ /^-?[0-9]+[.][0-9]/ || v ~ /e-/) v = sprintf("%.3f", v)
        printf " %s |", v
      }
    }' "$file"
}

row() {
  local name=$1
  printf '| %s |' "$name"
  value "$work/$name/metrics.json" scans local_maps kitti.odometry.translation_percent
  value "$work/$name.json" reference_closures detector.average_precision detector.recall_at_full_precision \
    detector.max_f1 detector.at_min_inliers.true_positives detector.at_min_inliers.false_positives \
    detector.at_min_inliers.below_overlap final_graph.true_positives final_graph.misaligned \
    final_graph.false_positives final_graph.below_overlap final_graph.recall
  value "$work/$name/metrics.json" ape.odometry.translation_m.rmse ape.optimised.translation_m.rmse
  printf '\n'
}

# mean_row NAME SESSION...: the mean of each figure over the sessions that have it.
mean_row() {
  local name=$1
  shift
  for session in "$@"; do row "$session"; done | awk -F'|' -v name="$name" '
    { for (i = 3; i < NF; ++i) if ($i ~ /[0-9]/) { sum[i] += $i; ++count[i] }; columns = NF }
    END {
      printf "| %s |", name
      for (i = 3; i < columns; ++i) printf(count[i] ? " %.3f |" : " - |", count[i] ? sum[i] / count[i] : 0)
      printf "\n"
    }'
}

header() {
  printf '\n## %s\n\n' "$1"
  echo '| recording | scans | maps | drift % | references | AP | R@1 | F1 | detector true | false | right pose | graph true | misaligned | false | right pose | recall | odometry APE m | APE m |'
  echo '| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |'
}

alignment() {
  printf '\n| recording | closures | initial m | initial deg | refined m | refined deg | absolute m | overlap error |\n'
  echo '| --- | --- | --- | --- | --- | --- | --- | --- |'
  for name in "$@"; do
    printf '| %s |' "$name"
    value "$work/$name.json" alignment.initial_to_proxy.closures alignment.initial_to_proxy.translation_m.median \
      alignment.initial_to_proxy.rotation_deg.median alignment.refined_to_proxy.translation_m.median \
      alignment.refined_to_proxy.rotation_deg.median alignment.refined_absolute.translation_m.median overlap_error.rmse
    printf '\n'
  done
  printf '\n| recording | same: references | found | opposite: references | found | crossing: references | found | other lane: references | found |\n'
  echo '| --- | --- | --- | --- | --- | --- | --- | --- | --- |'
  for name in "$@"; do
    printf '| %s |' "$name"
    value "$work/$name.json" by_direction.same.references by_direction.same.detected \
      by_direction.opposite.references by_direction.opposite.detected by_direction.crossing.references \
      by_direction.crossing.detected by_direction.other_lane.references by_direction.other_lane.detected
    printf '\n'
  done
}

# What the paper's Tables 5 and 6 solve: the detector's closures as they are.
plain="--set closures.verification=false --set pose_graph.robust=false --set revisits.enabled=false"

echo '# Closures: the claims of the paper'
printf '\nDefinitions: `groundloop evaluate closures --help`. "-" stands where a figure does not exist. False: the pair is no\n'
printf 'reference closure; right pose: of these, those whose pose is right, on an overlap below 0.25. Misaligned: a reference\n'
printf 'closure whose pose is more than 2 m or 5 degrees off at the origins of the maps, drift inside both included.\n'
printf 'Machine: %s cores. Length of simulated ways: %s m, of walker and segway %s m.\n' \
  "$(nproc)" "$length" "$tilt_length"

case $tables in *sensors*)
  header 'Various LiDARs, town, one configuration'
  names=
  for kind in $sensors; do
    of_kind= of_seeds=$few
    [ "$kind" != "${sensors%% *}" ] || of_seeds=$seeds
    for seed in $of_seeds; do
      name=town_${kind}_$seed
      session "$name" "sim:town?sensor=$kind&length=$length&seed=$seed"
      row "$name"
      of_kind="$of_kind $name"
    done
    mean_row "**mean of $kind**" $of_kind
    names="$names $of_kind"
  done
  alignment $names
esac

case $tables in *bridge*)
  header 'Perceptual aliasing: the bridge, there and back'
  for seed in $few; do
    bridge="sim:bridge?sensor=$sensor&length=$length&seed=$seed"
    session "bridge_pruned_$seed" "$bridge" $plain
    session "bridge_unpruned_$seed" "$bridge" $plain --set features.pruning=false
    session "bridge_$seed" "$bridge"
    row "bridge_pruned_$seed"
    row "bridge_unpruned_$seed"
    row "bridge_$seed"
  done
esac

case $tables in *tilt*)
  header 'Non-planar motion: ground alignment on and off'
  names=
  for seed in ${few%% *}; do
    for carrier in walker segway; do
      for enabled in true false; do
        name=${carrier}_alignment_${enabled}_$seed
        session "$name" "sim:town?carrier=$carrier&sensor=$sensor&length=$tilt_length&seed=$seed" \
          --set ground_alignment.enabled=$enabled
        row "$name"
        names="$names $name"
      done
    done
  done
  alignment $names
esac

case $tables in *traffic*)
  header 'Dynamics: the same drive with no, little and heavy traffic'
  for seed in ${few%% *}; do
    for traffic in 0 0.5 5; do
      name=traffic_${traffic}_$seed
      session "$name" "sim:town?sensor=$sensor&length=$length&seed=$seed&traffic=$traffic"
      row "$name"
    done
  done
esac

case $tables in *drive*)
  if [ -n "$drive" ]; then
    header 'Real drive (KITTI 00 key frames)'
    session drive "$drive"
    session drive_points "$drive" --set density_image.count=points --set density_image.saturation=0.999
    session drive_unpruned "$drive" --set features.pruning=false
    session drive_paper "$drive" --set density_image.count=points --set features.fast_threshold=35 \
      --set features.border_px=0 --set matching.method=tree \
      --set consensus.method=ransac --set consensus.orientation_gate_deg=180 --set consensus.guided_bits=0
    for name in drive drive_points drive_unpruned drive_paper; do row $name; done
    alignment drive drive_points drive_unpruned drive_paper
  fi
esac
