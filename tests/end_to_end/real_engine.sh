#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The real engine under cuts and kills: the final state must have the bits of the undisturbed run.
#   real_engine.sh SCENARIO GROUSER GROUSER_ENGINE
# Scenarios: chunks (ranks 1, 2, 4 x chunks 1, 3, 7), kills (engine killed in mid-chunk),
# manager (engine and manager killed under a whole campaign), full_disk, truncated,
# broken (overlap over its limit), signals (SIGTERM and SIGUSR1),
# snapshots (VTK's own reader opens them).
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
wheel_yaml() {
  echo 'wheel: {diameter: 14 cm, width: 6 cm, facets: 60, load: 30 N, settle_time: 40 ms, ramp_time: 5 ms,' \
       'forward_speed: 0.5 m/s, travel: 6 cm, average_travel: 2 cm, drive: towed, start: 0.35}'
}

new_run() {  # DIR [wheel]
  mkdir -p "$1"
  case_yaml >"$1/case.yaml"
  [ "${2:-}" = wheel ] && wheel_yaml >>"$1/case.yaml"
  return 0
}

attempts=0
launch() {  # RANKS DIR ARGUMENTS...: one attempt; sets $code
  local ranks=$1 dir=$2 token
  shift 2
  attempts=$((attempts + 1))
  token=$(printf 'attempt%06d' "$attempts")
  printf '%s' "$token" >"$dir/fence"
  code=0
  if [ "$ranks" = 1 ]; then
    "$engine" --run-dir "$dir" --token "$token" "$@" 2>>"$dir/log" || code=$?
  else
    mpirun -n "$ranks" --oversubscribe --bind-to none \
      "$engine" --run-dir "$dir" --token "$token" "$@" 2>>"$dir/log" || code=$?
  fi
  outcome=$dir/outcome-$token.json
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
        launch "$ranks" "$dir" --bed bed --until-time "$(awk "BEGIN {print 0.1625 * $chunk / $count}")"
        [ "$code" = 10 ] || fail "chunk $chunk of $dir ended with $code"
      done
      launch "$ranks" "$dir" --bed bed
      expect_same "$dir" "$ranks ranks, $count chunks"
    done
  done
}

# Kills every engine of this test that runs; returns whether there was one.
kill_engines() { pkill -9 -f -- "grouser-engine --run-dir $1"; }

kills() {
  prepare
  for ranks in 1 2 4; do
    local dir=killed-$ranks deaths=0
    new_run "$dir" wheel
    for delay in 0.2 0.5 0.9 0.4 0.7 1.1; do
      (sleep "$delay"; kill_engines "$dir") &
      local killer=$!
      launch "$ranks" "$dir" --bed bed
      [ "$code" = 0 ] || deaths=$((deaths + 1))
      kill "$killer" 2>/dev/null || true
      wait "$killer" 2>/dev/null || true
      [ "$code" = 0 ] && break
    done
    [ "$deaths" -gt 0 ] || fail "no engine was killed on $ranks ranks; the test shows nothing"
    if [ "$code" != 0 ]; then launch "$ranks" "$dir" --bed bed; fi
    expect_same "$dir" "$ranks ranks, killed $deaths times"
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

full_disk() {
  prepare
  [ "$(id -u)" = 0 ] || { echo "needs root to mount a small file system"; exit 77; }
  mkdir small
  mount -t tmpfs -o size=4m tmpfs small || { echo "cannot mount tmpfs here"; exit 77; }
  new_run small/run wheel
  launch 1 small/run --bed bed --until-time 0.05
  [ "$code" = 10 ] || fail "the first chunk ended with $code: $(tail -n 3 small/run/log)"
  before=$(ls small/run/checkpoints)
  dd if=/dev/zero of=small/filler bs=1k 2>/dev/null || true
  launch 1 small/run --bed bed
  [ "$code" = 40 ] || fail "on a full disk the engine ended with $code instead of 40"
  [ "$(ls small/run/checkpoints)" = "$before" ] || fail "the full disk changed the checkpoints"
  rm small/filler
  launch 1 small/run --bed bed
  expect_same small/run "after a full disk"
}

broken() {
  prepare
  new_run soft wheel
  launch 1 soft --bed bed --until-time 0.05
  kept=$(ls soft/checkpoints)
  sed -i 's/max_overlap: 30 %/max_overlap: 0.01 %/' soft/case.yaml
  launch 1 soft --bed bed
  [ "$code" = 30 ] || fail "an over-large overlap ended with $code instead of 30"
  grep -q 'overlap' "$outcome" || fail "the outcome does not say why"
  [ "$(ls soft/checkpoints)" = "$kept" ] || fail "the broken run changed the checkpoints"
  sed -i 's/max_overlap: 0.01 %/max_overlap: 30 %/' soft/case.yaml
  launch 1 soft --bed bed
  expect_same soft "after a breakdown"
}

signals() {
  prepare
  new_run told wheel
  launch 1 told --bed bed --restart required
  [ "$code" = 21 ] || fail "--restart required without a checkpoint ended with $code"
  for signal in TERM USR1; do
    (sleep 0.4; pkill "-$signal" -f -- "grouser-engine --run-dir told") &
    launch 1 told --bed bed --restart auto
    wait
    [ "$code" = 10 ] || fail "after SIG$signal the engine ended with $code instead of 10"
    grep -q '"by_signal": true' "$outcome" || fail "the outcome does not name the signal"
  done
  launch 1 told --restart required --max-seconds 2
  [ "$code" = 10 ] || fail "with --max-seconds the engine ended with $code instead of 10"
  touch told/stop
  launch 1 told
  [ "$code" = 12 ] || fail "with a stop file the engine ended with $code instead of 12"
  rm told/stop
  launch 1 told
  expect_same told "after two signals, --max-seconds and a stop file"
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

campaign_yaml() {
  printf 'grouser: 1\ncampaign: small\nscheduler: local\nresources: {ranks: %s}\nchunks: {count: 3}\n' "$1"
  printf 'retries: {infrastructure: 50}\ncase:\n'
  { case_yaml; wheel_yaml; } | sed 's/^/  /'
  printf 'sweep:\n  - axis: slip\n    points:\n      - {label: towed, set: {wheel.drive: towed}}\n'
  printf '      - {label: slip20, set: {wheel.drive: slip, wheel.slip: 20 %%}}\n'
}

final_hashes() { "$grouser" query -C "$1" "SELECT label, state_hash FROM v_runs ORDER BY label"; }

manager() {
  export GROUSER_ENGINE=$engine
  for ranks in 1 2; do
    campaign_yaml "$ranks" >"campaign$ranks.yaml"
    "$grouser" submit "campaign$ranks.yaml" --root "calm$ranks" >calm.log 2>&1 ||
      fail "undisturbed campaign: $(tail -n 5 calm.log)"
    local deaths=0
    for delay in 0.3 1.1 0.7 1.9 1.3 2.2; do
      "$grouser" submit "campaign$ranks.yaml" --root "killed$ranks" --every 0.1 >killed.log 2>&1 &
      local pid=$!
      sleep "$delay"
      kill -9 "$pid" 2>/dev/null && deaths=$((deaths + 1))
      wait "$pid" 2>/dev/null || true
      kill_engines "$work/killed$ranks" || true
    done
    [ "$deaths" -ge 3 ] || fail "only $deaths managers were killed; the test shows little"
    "$grouser" submit "campaign$ranks.yaml" --root "killed$ranks" --every 0.1 >killed.log 2>&1 ||
      fail "disturbed campaign: $(tail -n 5 killed.log)"
    [ "$(final_hashes "calm$ranks")" = "$(final_hashes "killed$ranks")" ] ||
      fail "the disturbed campaign has other bits"
    echo "same bits: campaign on $ranks ranks, $deaths managers killed"
  done
  [ "$(final_hashes calm1)" = "$(final_hashes calm2)" ] || fail "1 and 2 ranks differ"
}

"$scenario"
