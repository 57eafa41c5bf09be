#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The real engine under cuts and kills: the final state must have the bits of the undisturbed run.
#   real_engine.sh SCENARIO GROUSER GROUSER_ENGINE
# Scenarios: chunks (ranks 1, 2, 4 x chunks 1, 3, 7), kills (engine killed in mid-chunk, all of it and
# one rank alone), manager (killed in mid-submission, and the engines with it), full_disk, truncated,
# broken (overlap, NaN, lost grain), signals (SIGTERM and SIGUSR1, to ranks and to mpirun),
# snapshots (VTK's own reader opens them), fluid (placed grains with a history and a track, cut and
# moved between ranks), lattice (spheres in fluid on a lattice, killed and moved between ranks), wet_wheel (bed and
# wheel in a submerging fluid, cut and moved between ranks).
set -euo pipefail
reader=$(realpath -- "$(dirname -- "${BASH_SOURCE[0]}")/read_vtkhdf.py")
scenario=$1 grouser=$(realpath -- "$2") engine=$(realpath -- "$3")
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1
work=$(mktemp -d)
trap 'pkill -9 -f -- "$work" || true; mountpoint -q "$work/small" && umount "$work/small"; rm -rf "$work"' EXIT
cd "$work"

fail() { echo "FAILED: $*" >&2; exit 1; }

case_yaml() {
  cat <<'YAML'
box: {length: 30 cm, width: 16 cm, depth: 10 cm}
grains:
  density: 2650 kg/m3
  solid: {young_modulus: 10 MPa}
  size_curve: [{diameter: 9 mm, finer: 0}, {diameter: 14 mm, finer: 1}]
contact:
  rolling: elastic_plastic
  grain_grain: {restitution: 0.4, friction: 0.5, rolling_friction: 0.2}
  grain_box: {restitution: 0.4, friction: 0.5}
  grain_wheel: {restitution: 0.4, friction: 0.6, rolling_friction: 0.1}
bed: {depth: 5 cm, settled_energy_ratio: 1e-3}
numerics: {max_overlap: 30 %}
output: {series_interval: 1 ms, checkpoint_interval: 20 ms}
YAML
}
end_time=0.1625  # of the run that wheel_yaml describes
wheel_yaml() {
  echo 'wheel: {diameter: 14 cm, width: 6 cm, facets: 60, load: 30 N, settle_time: 40 ms, ramp_time: 5 ms,' \
       'forward_speed: 0.5 m/s, travel: 6 cm, average_travel: 2 cm, drive: towed, start: 0.35}'
}

wet=  # fluid of the case, if any
new_run() {  # DIR [wheel]
  mkdir -p "$1"
  case_yaml >"$1/case.yaml"
  echo "$wet" >>"$1/case.yaml"
  [ "${2:-}" = wheel ] && wheel_yaml >>"$1/case.yaml"
  return 0
}

attempts=0
launch() {  # RANKS DIR ARGUMENTS...: one attempt with a log of its own; sets $code and $outcome
  local ranks=$1 dir=$2 token starter=()
  shift 2
  attempts=$((attempts + 1))
  token=$(printf 'attempt%06d' "$attempts")
  printf '%s' "$token" >"$dir/fence"
  [ "$ranks" = 1 ] || starter=(mpirun -n "$ranks" --oversubscribe --bind-to none)
  code=0
  "${starter[@]}" "$engine" --run-dir "$work/$dir" --token "$token" "$@" 2>"$dir/log" || code=$?
  outcome=$dir/outcome-$token.json
}

# The full path of a run directory is in no command line but those of this test's own processes.
processes_of() {  # DIR NAME [RANK]: mpirun or engines of a run
  local pid
  for pid in $(pgrep -f -- "--run-dir $work/$1 "); do
    [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = "$2" ] || continue
    if [ -z "${3:-}" ] || grep -qsz "^OMPI_COMM_WORLD_RANK=$3$" "/proc/$pid/environ"; then
      echo "$pid"
    fi
  done
}
send() {  # SIGNAL DIR NAME [RANK]
  local pids
  pids=$(processes_of "${@:2}")
  [ -n "$pids" ] || fail "no $3 to send a signal to"
  # shellcheck disable=SC2086 # one word per process
  kill "-$1" $pids
}
kill_all() { pkill -9 -f -- "--run-dir $work/$1 "; }

newest_step() {  # DIR: step of the newest checkpoint that exists, 0 without one
  local file newest=0
  for file in "$1"/checkpoints/step_*.json; do
    [ -e "$file" ] || continue
    file=${file##*/step_}
    file=$((10#${file%%[-.]*}))
    [ "$file" -le "$newest" ] || newest=$file
  done
  echo "$newest"
}

# An attempt to which COMMAND, a string, is done as soon as it has published a checkpoint of its own
# behind the first step.
disturb() {  # COMMAND RANKS DIR ARGUMENTS...
  local command=$1 before watcher
  before=$(newest_step "$3")
  shift
  (
    while [ "$(newest_step "$2")" -le "$before" ]; do sleep 0.01; done
    eval "$command"
  ) &
  watcher=$!
  launch "$@"
  kill "$watcher" 2>/dev/null || true
  wait "$watcher" 2>/dev/null || true
  for _ in $(seq 500); do
    [ -n "$(processes_of "$2" grouser-engine)" ] || return 0
    sleep 0.02
  done
  fail "engines of $2 are left after their attempt has ended"
}

# The last attempt must have gone on where a checkpoint lay, not from the beginning.
expect_continued() {  # DIR STEP
  local from
  from=$(sed -n 's/.*app continues from [^ ]* step=\([0-9]*\).*/\1/p' "$1/log")
  [ "$2" -gt 0 ] && [ "${from:-0}" -ge "$2" ] || fail "$1 went on from '$from' instead of step $2"
}

hash_of() { sed -n 's/.*"state_hash": "\(.*\)",.*/\1/p' "$outcome"; }

prepare() {  # bed and undisturbed run
  new_run bed
  launch 1 bed
  [ "$code" = 0 ] || fail "bed ended with $code: $(tail -n 3 bed/log)"
  new_run straight wheel
  launch 1 straight --bed bed
  [ "$code" = 0 ] || fail "undisturbed run ended with $code: $(tail -n 3 straight/log)"
  expected=$(hash_of)
  [ -n "$expected" ] || fail "the undisturbed run has no state hash"
}

expect_same() {  # DIR WHAT
  [ "$code" = 0 ] || fail "$2 ended with $code: $(tail -n 3 "$1/log")"
  [ "$(hash_of)" = "$expected" ] || fail "$2 has other bits than the undisturbed run"
  cmp "$1/series.csv" straight/series.csv || fail "$2 has another time series"
  echo "same bits: $2"
}

chunks() {
  prepare
  for ranks in 1 2 4; do
    for count in 1 3 7; do
      local dir=r$ranks-c$count
      new_run "$dir" wheel
      for ((chunk = 1; chunk < count; ++chunk)); do
        launch "$ranks" "$dir" --bed bed --until-time "$(awk "BEGIN {print $end_time * $chunk / $count}")"
        [ "$code" = 10 ] || fail "chunk $chunk of $dir ended with $code"
      done
      launch "$ranks" "$dir" --bed bed
      expect_same "$dir" "$ranks ranks, $count chunks"
    done
  done
}

kill_in_mid_chunk() {  # RANKS CHUNKS
  local ranks=$1 count=$2 dir=killed-r$1-c$2 deaths=0 chunk until
  new_run "$dir" wheel
  # Many checkpoints in a chunk; the bits do not depend on them.
  sed -i 's/checkpoint_interval: 20 ms/checkpoint_interval: 4 ms/' "$dir/case.yaml"
  for ((chunk = 1; chunk <= count; ++chunk)); do
    until=(--until-time "$(awk "BEGIN {print $end_time * $chunk / $count}")")
    [ "$chunk" -lt "$count" ] || until=()
    code=137
    if [ $((chunk % 5)) = 1 ]; then
      disturb "kill_all '$dir'" "$ranks" "$dir" --bed bed "${until[@]}"
      if [ "$code" = 137 ]; then deaths=$((deaths + 1)); fi
    fi
    if [ "$code" = 137 ]; then
      local at
      at=$(newest_step "$dir")
      launch "$ranks" "$dir" --bed bed "${until[@]}"
      expect_continued "$dir" "$at"
    fi
    [ "$chunk" = "$count" ] || [ "$code" = 10 ] || fail "chunk $chunk of $dir ended with $code"
  done
  [ "$deaths" -gt 0 ] || fail "no engine was killed on $ranks ranks; the test shows nothing"
  expect_same "$dir" "$ranks ranks, $count chunks, killed $deaths times in mid-chunk"
}

kills() {
  prepare
  local ranks count rank at
  for ranks in 1 2 4; do
    for count in 1 3 7; do kill_in_mid_chunk "$ranks" "$count"; done
  done
  # A rank that dies alone must take the others with it, and harm nothing.
  for rank in 0 1; do
    new_run "one-$rank" wheel
    disturb "send KILL one-$rank grouser-engine $rank" 2 "one-$rank" --bed bed
    [ "$code" = 137 ] || fail "with rank $rank killed the run ended with $code instead of 137"
    [ ! -e "$outcome" ] || fail "with rank $rank killed there is an outcome"
    at=$(newest_step "one-$rank")
    echo half >"one-$rank/checkpoints/step_000000000001.h5"
    launch 2 "one-$rank" --bed bed
    expect_continued "one-$rank" "$at"
    expect_same "one-$rank" "2 ranks, rank $rank killed at step $at or later"
    [ "$(ls "one-$rank/checkpoints" | wc -l)" = 4 ] ||
      fail "beside two checkpoints there is more: $(ls "one-$rank/checkpoints")"
  done
}

truncated() {
  prepare
  new_run torn wheel
  launch 1 torn --bed bed --until-time 0.1
  newest=$(ls torn/checkpoints/*.h5 | tail -n 1)
  truncate -s 2000 "$newest"
  launch 1 torn --bed bed
  grep -q 'damaged checkpoint passed over' torn/log || fail "the torn checkpoint went unnoticed"
  expect_same torn "after a truncated checkpoint"
  h5dump -d /case -b -o torn/case.copy "$(ls torn/checkpoints/*.h5 | tail -n 1)" >/dev/null
  cmp torn/case.yaml torn/case.copy || fail "the checkpoint does not hold the frozen case"
}

fill_disk() {  # BYTES: how many are left
  dd if=/dev/zero of=small/filler bs=1k 2>/dev/null || true
  truncate -s "-$1" small/filler
}

full_disk() {
  prepare
  [ "$(id -u)" = 0 ] || { echo "needs root to mount a small file system"; exit 77; }
  mkdir small
  mount -t tmpfs -o size=4m tmpfs small || { echo "cannot mount tmpfs here"; exit 77; }
  local ranks dir at before
  for ranks in 1 2; do
    dir=small/run$ranks
    new_run "$dir" wheel
    launch "$ranks" "$dir" --bed bed --until-time 0.05
    [ "$code" = 10 ] || fail "the first chunk ended with $code: $(tail -n 3 "$dir/log")"
    at=$(newest_step "$dir")
    before=$(ls "$dir/checkpoints")
    # Events, series and progress fit, a checkpoint of half a megabyte does not.
    fill_disk 300k
    launch "$ranks" "$dir" --bed bed
    expect_continued "$dir" "$at"
    [ "$code" = 40 ] || fail "on a full disk the engine ended with $code instead of 40"
    grep -q '"reason": "checkpoint at step [0-9]* could not be written: .*bytes of room' "$outcome" ||
      fail "the outcome does not tell of the full disk: $(cat "$outcome")"
    [ "$(sed -n 's/.*"reason": "checkpoint at step \([0-9]*\) .*/\1/p' "$outcome")" -gt "$at" ] ||
      fail "the disk was full before the attempt's first step"
    grep -q "\"step\": $(sed -n 's/.*"reason": "checkpoint at step \([0-9]*\) .*/\1/p' "$outcome")," \
      "$outcome" || fail "the outcome does not tell where the run stood: $(cat "$outcome")"
    grep -q "\"checkpoint\": \"step_0*$at" "$outcome" ||
      fail "the outcome does not name the checkpoint that stands: $(cat "$outcome")"
    [ "$(ls "$dir/checkpoints")" = "$before" ] || fail "the full disk changed the checkpoints"
    fill_disk 0
    launch "$ranks" "$dir" --bed bed
    [ "$code" = 40 ] || fail "without any room the engine ended with $code instead of 40"
    [ "$(ls "$dir/checkpoints")" = "$before" ] || fail "no room at all changed the checkpoints"
    rm small/filler
    launch "$ranks" "$dir" --bed bed
    expect_continued "$dir" "$at"
    expect_same "$dir" "after a full disk on $ranks ranks"
    rm -r "$dir"
  done
}

verdict() { grep -E '"(reason|state_hash|checkpoint|step)"' "$outcome"; }

# A wheel that stands well and breaks the run once it drives. The last checkpoint before stays and
# leads to the same breakdown; so do two ranks.
expect_breakdown() {  # NAME REASON WHEEL
  local ranks dir kept last=
  for ranks in 1 2; do
    dir=$1-$ranks
    new_run "$dir"
    sed -i 's/max_overlap: 30 %/max_overlap: 100 %/' "$dir/case.yaml"
    echo "wheel: {diameter: 14 cm, width: 6 cm, facets: 60, load: 30 N, settle_time: 40 ms," \
      "ramp_time: 5 ms, start: 0.5, travel: 1 cm, average_travel: 1 cm, $3}" >>"$dir/case.yaml"
    launch "$ranks" "$dir" --bed bed
    [ "$code" = 30 ] || fail "$1 on $ranks ranks ended with $code instead of 30"
    grep -qE "\"reason\": \"at step [0-9]+, [0-9.e-]+ s, $2" "$outcome" ||
      fail "$1: the outcome tells of something else: $(cat "$outcome")"
    kept=$(ls "$dir/checkpoints")
    [ "$(newest_step "$dir")" -gt 0 ] || fail "$1 has no checkpoint from before its breakdown"
    [ "$(verdict)" = "${last:=$(verdict)}" ] || fail "$1 broke in another way on $ranks ranks"
    launch "$ranks" "$dir" --restart required
    [ "$code" = 30 ] || fail "$1 did not break a second time, it ended with $code"
    expect_continued "$dir" "$(newest_step "$dir")"
    [ "$(verdict)" = "$last" ] ||
      fail "$1 broke in another way after its last checkpoint"
    [ "$(ls "$dir/checkpoints")" = "$kept" ] || fail "$1 changed the checkpoints"
    echo "ended cleanly: $1 on $ranks ranks,$(sed -n 's/.*"reason"://p' "$outcome")"
  done
}

broken() {
  prepare
  new_run soft wheel
  launch 1 soft --bed bed --until-time 0.05
  kept=$(ls soft/checkpoints)
  sed -i 's/max_overlap: 30 %/max_overlap: 0.01 %/' soft/case.yaml
  launch 1 soft --bed bed
  [ "$code" = 30 ] || fail "an over-large overlap ended with $code instead of 30"
  grep -q 'overlap .* is over numerics.max_overlap 0.0001: grain [0-9]* at (.*) m and ' "$outcome" ||
    fail "the outcome does not say why: $(cat "$outcome")"
  [ "$(ls soft/checkpoints)" = "$kept" ] || fail "the broken run changed the checkpoints"
  sed -i 's/max_overlap: 0.01 %/max_overlap: 30 %/' soft/case.yaml
  launch 1 soft --bed bed
  expect_same soft "after a breakdown"
  # The square of the speed that this torque makes is not a number any more; a speed that is given
  # would be refused.
  expect_breakdown nan 'a force or velocity is not a number: grain [0-9]+' \
    'forward_speed: 0.1 m/s, drive: torque, torque: 1e200 N m'
  # Grains fly over walls and headroom.
  expect_breakdown lost 'a grain has left the box: grain [0-9]+ is at ' \
    'forward_speed: 0.03 m/s, drive: rim_speed, rim_speed: 25 m/s'
}

expect_paused_by() {  # COMMAND RANKS DIR CODE: the code of what the run was started with
  disturb "$1" "$2" "$3" --bed bed
  [ "$code" = "$4" ] || fail "after '$1' on $2 ranks the code was $code instead of $4"
  grep -q '"code": 10' "$outcome" || fail "the outcome of '$1' is not code 10: $(cat "$outcome")"
  grep -q '"by_signal": true' "$outcome" || fail "the outcome does not name the signal of '$1'"
  [ "$(sed -n 's/.*"step": \([0-9]*\).*/\1/p' "$outcome")" = "$(newest_step "$3")" ] ||
    fail "after '$1' the last step has no checkpoint"
}

signals() {
  prepare
  new_run told wheel
  # Each signal comes after a checkpoint of its attempt, and the run is to last for all of them.
  sed -i 's/checkpoint_interval: 20 ms/checkpoint_interval: 4 ms/' told/case.yaml
  launch 1 told --bed bed --restart required
  [ "$code" = 21 ] || fail "--restart required without a checkpoint ended with $code"
  for signal in TERM USR1; do
    expect_paused_by "send $signal told grouser-engine" 1 told 10
    for rank in 0 1; do
      expect_paused_by "send $signal told grouser-engine $rank" 2 told 10
    done
  done
  # mpirun hands SIGUSR1 on and reports its ranks' code. SIGTERM it hands on after a second, kills
  # what is left after another, and reports 1: this run lasts long enough to be met by it.
  expect_paused_by "send USR1 told mpirun" 2 told 10
  new_run slow wheel
  sed -i 's/forward_speed: 0.5/forward_speed: 0.05/' slow/case.yaml
  expect_paused_by "send TERM slow mpirun" 2 slow 1
  expect_paused_by "send TERM slow grouser-engine" 1 slow 10
  expect_continued slow 1
  launch 1 told --restart required --max-seconds 1
  [ "$code" = 10 ] || fail "with --max-seconds the engine ended with $code instead of 10"
  touch told/stop
  launch 1 told
  [ "$code" = 12 ] || fail "with a stop file the engine ended with $code instead of 12"
  rm told/stop
  launch 1 told
  expect_same told "after seven signals, --max-seconds and a stop file"
}

snapshots() {
  prepare
  for ranks in 1 2; do
    new_run "seen$ranks" wheel
    sed -i 's/checkpoint_interval: 20 ms/&, snapshot_interval: 50 ms/' "seen$ranks/case.yaml"
    launch "$ranks" "seen$ranks" --bed bed
    expect_same "seen$ranks" "with snapshots on $ranks ranks"
  done
  local count=0 seen
  for file in seen1/snapshots/*.vtkhdf; do
    h5diff "$file" "seen2/snapshots/$(basename "$file")" || fail "$file differs between 1 and 2 ranks"
    case $file in
      */grains_*)
        seen=$(/usr/bin/python3 "$reader" "$file" 1 id 'radius [m]' 'velocity [m s-1]' \
          'spin [rad s-1]' 'displacement [m]') || fail "$seen"
        [ "${seen%% *}" = "$(sed -n 's/.*"particles": \(.*\),/\1/p' "$outcome")" ] ||
          fail "$file has ${seen%% *} points" ;;
      */wheel_*) seen=$(/usr/bin/python3 "$reader" "$file" 5) || fail "$seen" ;;
    esac
    echo "$(basename "$file"): $seen"
    count=$((count + 1))
  done
  [ "$count" = 6 ] || fail "$count snapshots instead of 6"
}

campaign_yaml() {  # RANKS CHUNKS
  printf 'grouser: 1\ncampaign: small\nscheduler: local\nresources: {ranks: %s}\n' "$1"
  printf 'chunks: {count: %s}\nretries: {infrastructure: 50}\ncase:\n' "$2"
  # Small and short: there are many of them.
  { case_yaml; wheel_yaml; } | sed 's/checkpoint_interval: 20 ms/checkpoint_interval: 4 ms/
    s/width: 16 cm/width: 9 cm/; s/travel: 6 cm/travel: 3 cm/; s/^/  /'
}

final_hashes() { "$grouser" query -C "$1" "SELECT label, state_hash FROM v_runs ORDER BY label"; }

submit() {  # ROOT
  "$grouser" submit campaign.yaml --root "$1" --every 0.05 --grace 0.5 >log 2>&1
}

# Kills the engines of a campaign when its run has a checkpoint behind the first step.
kill_driving() {  # ROOT
  until grep -qs '"step": [1-9]' "$1"/runs/*/checkpoints/step_*.json &&
    pkill -9 -f -- "grouser-engine --run-dir $work/$1/runs/"; do
    sleep 0.02
  done
}

# Managers that die at the places of a submission, one after the other, on all ranks and chunks.
manager() {
  export GROUSER_ENGINE=$engine
  campaign_yaml 1 1 >campaign.yaml
  submit calm || fail "undisturbed campaign: $(tail -n 5 log)"
  expected=$(final_hashes calm)
  local first=(after_directories after_runs after_cancels)
  # Before these places nothing has come of a submission, so the next manager does it again ...
  local before=(after_tx1 after_fence after_script before_settle)
  # ... behind these it has: the next manager dies one submission further on.
  local behind=(after_submit after_tx2 after_settle)
  local number=0 ranks count root place killer places
  for ranks in 1 2 4; do
    for count in 1 3 7; do
      root=killed-r$ranks-c$count
      campaign_yaml "$ranks" "$count" >campaign.yaml
      places=("${first[number % 3]}" "${behind[number % 3]}" "${before[number % 4]}"
        "${behind[number % 3]}")
      # A run of one chunk has nothing more to submit.
      [ "$count" = 1 ] || places+=("${before[number % 4]}")
      number=$((number + 1))
      for place in "${places[@]}"; do
        code=0
        GROUSER_FAULT=$place submit "$root" || code=$?
        [ "$code" = 137 ] || fail "the manager did not die at $place: $(tail -n 5 log)"
      done
      kill_driving "$root" &
      killer=$!
      submit "$root" || fail "disturbed campaign: $(tail -n 5 log)"
      kill "$killer" 2>/dev/null && fail "no engine of $root was killed; the test shows nothing"
      wait "$killer" || true
      [ "$(final_hashes "$root")" = "$expected" ] || fail "the disturbed campaign has other bits"
      echo "same bits: campaign on $ranks ranks in $count chunks, managers killed ${places[*]}"
    done
  done
}

fluid_run() {  # DIR
  mkdir -p "$1"
  cat >"$1/case.yaml" <<'YAML'
box: {length: 6 cm, width: 6 cm, depth: 6 cm, solid: {young_modulus: 5 MPa}}
placed:
  duration: 0.15 s
  grains:
    - {diameter: 8 mm, x: 15 mm, y: 20 mm, z: 8 mm, velocity_x: 0.4 m/s, velocity_z: -0.3 m/s}
    - {diameter: 8 mm, x: 45 mm, y: 20 mm, z: 12 mm, velocity_x: -0.5 m/s, spin_y: 40 rad/s}
    - {diameter: 6 mm, x: 30 mm, y: 45 mm, z: 30 mm}
grains: {density: 2500 kg/m3, solid: {young_modulus: 5 MPa}}
contact:
  grain_grain: {restitution: 0.8, friction: 0.3}
  grain_box: {restitution: 0.8, friction: 0.3}
fluid:
  density: 950 kg/m3
  viscosity: 20 mPa s
  velocity_x: 0.05 m/s
  shear_rate: 2 s-1
  added_mass: {amplitude: 1}
  history: {law: mei_adrian, amplitude: 1}
  shear_lift: {amplitude: 1}
  spin_lift: {amplitude: 1}
  spin_drag: {amplitude: 1}
  lubrication: {amplitude: 1}
probes: [{grain: 1, axis: y, along: gap, from: 0 mm, peak: 5 mm, to: 20 mm, force: 1 mN}]
output: {series_interval: 1 ms, checkpoint_interval: 20 ms, track: {grain: 1, interval: 1 ms}}
YAML
}

fluid() {
  local ranks
  fluid_run straight
  launch 1 straight
  [ "$code" = 0 ] || fail "undisturbed run ended with $code: $(tail -n 3 straight/log)"
  expected=$(hash_of)
  [ "$(wc -l <straight/track.csv)" -ge 140 ] || fail "the track has $(wc -l <straight/track.csv) lines"
  for ranks in 1 2 4; do
    fluid_run "cut-$ranks"
    launch "$ranks" "cut-$ranks" --until-time 0.0613
    [ "$code" = 10 ] || fail "the first chunk ended with $code: $(tail -n 3 "cut-$ranks/log")"
    launch $((3 - ranks % 3)) "cut-$ranks" --restart required
    expect_same "cut-$ranks" "fluid cut on $ranks ranks, continued on $((3 - ranks % 3))"
    cmp "cut-$ranks/track.csv" straight/track.csv || fail "the track differs"
  done
}

# Three spheres on a lattice of cells, which has cuts of its own between ranks.
lattice_run() {  # DIR
  mkdir -p "$1"
  cat >"$1/case.yaml" <<'YAML'
box: {length: 24 mm, width: 24 mm, depth: 32 mm, solid: {young_modulus: 2 MPa}}
placed:
  duration: 0.12 s
  grains:
    - {diameter: 8 mm, x: 7 mm, y: 8 mm, z: 12 mm, velocity_z: -5 cm/s}
    - {diameter: 7 mm, x: 16 mm, y: 9 mm, z: 20 mm, spin_y: 10 rad/s}
    - {diameter: 6 mm, x: 12 mm, y: 18 mm, z: 26 mm}
grains: {density: 2500 kg/m3, solid: {young_modulus: 2 MPa}}
contact:
  grain_grain: {restitution: 0.8, friction: 0.3}
  grain_box: {restitution: 0.8, friction: 0.3}
fluid:
  mode: resolved
  density: 1000 kg/m3
  viscosity: 50 mPa s
  lattice: {cell: 1 mm, speed: 0.15 m/s, mach: 0.1, faces: {z_high: {kind: slip}}}
output: {series_interval: 2 ms, checkpoint_interval: 10 ms, snapshot_interval: 50 ms,
         track: {grain: 1, interval: 2 ms}}
YAML
}

lattice() {
  local ranks at file seen
  lattice_run straight
  launch 1 straight
  [ "$code" = 0 ] || fail "undisturbed run ended with $code: $(tail -n 3 straight/log)"
  expected=$(hash_of)
  grep -q 'app lattice of 24 x 24 x 32 cells of 0.001 m, .*Mach number' straight/log ||
    fail "the log does not tell of the lattice: $(cat straight/log)"
  for ranks in 1 2 3 4; do
    lattice_run "killed-$ranks"
    disturb "kill_all 'killed-$ranks'" "$ranks" "killed-$ranks"
    [ "$code" = 137 ] || fail "the engine was not killed on $ranks ranks, it ended with $code"
    at=$(newest_step "killed-$ranks")
    launch $((5 - ranks)) "killed-$ranks" --until-time 0.0913
    [ "$code" = 10 ] || fail "the chunk ended with $code: $(tail -n 3 "killed-$ranks/log")"
    expect_continued "killed-$ranks" "$at"
    launch 1 "killed-$ranks" --restart required
    expect_same "killed-$ranks" "lattice killed on $ranks ranks, continued on $((5 - ranks))"
    cmp "killed-$ranks/track.csv" straight/track.csv || fail "the track differs"
    for file in straight/snapshots/*.vtkhdf; do
      h5diff "$file" "killed-$ranks/snapshots/$(basename "$file")" || fail "$file differs"
    done
  done
  file=$(ls straight/snapshots/fluid_*.vtkhdf | tail -n 1)
  seen=$(/usr/bin/python3 "$reader" "$file" 11 'velocity [m s-1]' 'pressure [Pa]') ||
    fail "$seen"
  [ "$seen" = "18432 16399 0.0005 0.0235 0.0005 0.0235 0.0005 0.0315" ] || fail "$file has points and cells: $seen"
  # Far over the speed that the lattice was made for the run breaks, and keeps what was good.
  lattice_run fast
  sed -i 's/speed: 0.15 m\/s, mach: 0.1/relaxation_time: 0.502, collision: bgk/
    s/velocity_z: -5 cm/velocity_z: -2 cm/; s/duration: 0.12 s/duration: 4 s/; s/2500 kg/20000 kg/; s/viscosity: 50 mPa s/viscosity: 0.5 mPa s/' fast/case.yaml
  launch 2 fast
  [ "$code" = 30 ] || fail "a fluid that breaks down ended with $code instead of 30: $(tail -n 3 fast/log)"
  echo "ended cleanly:$(sed -n 's/.*"reason"://p' "$outcome")"
  [ "$(newest_step fast)" -gt 0 ] || fail "the broken run has no checkpoint"
}

wet_wheel() {
  wet='fluid: {density: 1000 kg/m3, viscosity: 10 mPa s, drag: {law: gidaspow}, void_fraction: 0.45}'
  prepare
  new_run cut wheel
  launch 2 cut --bed bed --until-time 0.07
  [ "$code" = 10 ] || fail "the first chunk ended with $code: $(tail -n 3 cut/log)"
  launch 1 cut --bed bed --restart required
  expect_same cut "bed and wheel in a fluid, cut on 2 ranks, continued on 1"
}

"$scenario"
