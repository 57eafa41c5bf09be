#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The manager against a real Slurm on this machine (deploy/slurm.sh), with the stand-in engine:
#   tests/slurm/slurm_campaign.sh GROUSER FAKE_ENGINE SCENARIO...
# As root. Every scenario ends with all runs COMPLETED and the bits of undisturbed ones.
set -euo pipefail
repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
slurm=$repository/deploy/slurm.sh
user='grouser-test'
base=${GROUSER_SLURM_ROOT:-/var/tmp/grouser-slurm}
work=$(mktemp -d /var/tmp/grouser-slurm-test.XXXXXX)

fail() {
  echo "FAILED: $scenario: $*" >&2
  as_user "$work/grouser" status -C "$root" >&2 || true
  cat "$root"/tick.log >&2 || true
  exit 1
}

clean() {
  scancel --user="$user" 2>/dev/null || true
  rm -rf -- "$work"
}

# As an ordinary user: limits do not bind root.
as_user() {
  runuser -u "$user" -- env SLURM_CONF="$SLURM_CONF" GROUSER_ENGINE="$work/fake_engine" \
    FAKE_STEP_MICROSECONDS="${pace:-2000}" HOME="$work" "${extra[@]}" "$@"
}

# campaign HEAD: writes the YAML of three wheel runs on one bed.
campaign() {
  root=$work/$scenario
  mkdir -p "$root"
  cat >"$root.yaml" <<YAML
grouser: 1
campaign: $scenario
$1
case:
  box: {length: 40 cm, width: 12 cm, depth: 10 cm}
  grains:
    density: 2650 kg/m3
    size_curve: [{diameter: 0.4 mm, finer: 0 %}, {diameter: 0.8 mm, finer: 100 %}]
    coarse_graining: 12
  contact:
    grain_grain: {restitution: 0.5, friction: 0.5}
    grain_box: {restitution: 0.5, friction: 0.5}
    grain_wheel: {restitution: 0.5, friction: 0.5}
  bed: {depth: 6 cm}
  wheel:
    diameter: 12.5 cm
    width: 6 cm
    load: 24 N
    forward_speed: 20 cm/s
    travel: 4 cm
    average_travel: 2 cm
  output: {checkpoint_interval: 20 ms}
sweep:
  - axis: slip
    points:
      - {label: towed, set: {wheel.drive: towed}}
      - {label: slip_00, set: {wheel.slip: 0 %}}
      - {label: slip_20, set: {wheel.slip: 20 %}}
YAML
  chown -R "$user" "$work"
}

settings() { # MORE-OF-RESOURCES: what most scenarios share
  printf 'scheduler: slurm\nresources: {walltime: 5min, launcher: env, memory: 50M%s}\n' "${1:-}"
  printf 'retries: {infrastructure: 5, delay: 1s}\n'
}

submit() { as_user "$work/grouser" submit "$root.yaml" --root "$root" --grace 5 >>"$root/tick.log" 2>&1; }
tick() { as_user "$work/grouser" tick -C "$root" --grace 5 >>"$root/tick.log" 2>&1 || [ $? -eq 1 ]; }
ask() { as_user "$work/grouser" query -C "$root" --json "$1" | sed -n 's/^ *"x": "\{0,1\}\([^"]*\)"\{0,1\}$/\1/p'; }
state_of() { ask "SELECT state AS x FROM v_runs WHERE label LIKE '$1%'"; }
job_of() { ask "SELECT job AS x FROM v_attempts WHERE run LIKE '$1%' ORDER BY number DESC LIMIT 1"; }
open_runs() { ask "SELECT count(*) AS x FROM v_runs WHERE state <> 'COMPLETED'"; }

# until_true SECONDS CONDITION: ticks until it holds.
until_true() {
  local end=$((SECONDS + $1))
  shift
  until eval "$*"; do
    [ "$SECONDS" -lt "$end" ] || fail "did not come true: $*"
    tick
    sleep 0.5
  done
}

runs_on() { squeue -h -j "$1" -o %N; }
is_running() { [ "$(squeue -h -j "$(job_of "$1")" -t R -o %i 2>/dev/null)" != "" ]; }
has_progress() { [ -n "$(find "$root" -path "*$1*/progress.json")" ]; }

hashes() { as_user "$work/grouser" query -C "$1" "SELECT label, step, state_hash FROM v_runs ORDER BY label"; }

finish() {
  until_true "${1:-60}" '[ "$(open_runs)" = 0 ]'
  hashes "$root" >"$root.hashes"
  diff "$work/calm.hashes" "$root.hashes" || fail "other bits"
  local differences
  differences=$(as_user "$work/grouser" fsck -C "$root" | grep -cv -e 'left an outcome' -e 'nothing to do') || true
  [ "$differences" -le 1 ] || fail "fsck: $(as_user "$work/grouser" fsck -C "$root")"
}

calm() { # what all others are compared with, on this machine without Slurm
  local scenario=calm root
  campaign 'scheduler: local'
  pace=0 as_user "$work/grouser" submit "$root.yaml" --root "$root" >"$root/tick.log" 2>&1 || fail calm
  hashes "$root" >"$work/calm.hashes"
}

array() { # a sweep as one array, two at once, of which one task fails on its own
  campaign "$(settings ', array: true, concurrent: 2')"
  extra=(FAKE_ONLY=slip_00 FAKE_KILL_AT=100)
  submit
  finish
  local arrays
  arrays=$(find "$root/arrays" -name '*.sh' | wc -l)
  [ "$arrays" -ge 1 ] || fail "no array was submitted"
  grep -q '^#SBATCH --array=0-2%2$' "$root"/arrays/*.sh || fail "no limit on the array"
  [ "$(ask "SELECT count(*) AS x FROM v_attempts WHERE run LIKE 'slip_00%'")" -ge 2 ] ||
    fail "the failed task was not tried again"
}

cancelled_pending() { # tasks that are cancelled while they wait leave no record at all
  campaign "$(settings ', array: true, concurrent: 1')"
  submit
  pace=10000
  until_true 60 'is_running towed'
  scancel "$(job_of slip_20)"
  finish 90
}

chain() { # many short jobs of each run
  campaign "$(settings)
chunks: {count: 4}"
  submit
  finish 90
  [ "$(ask "SELECT count(*) AS x FROM v_attempts")" = 13 ] || fail "not one job for each chunk"
}

prologue() { # nobody ticks: each job queues its successor first
  campaign "$(settings)
chain: prologue"
  submit
  local end=$((SECONDS + 90))
  until [ "$(open_runs)" = 0 ]; do
    [ "$SECONDS" -lt "$end" ] || fail "the chain broke: $(cat "$root/wake.log")"
    sleep 1
  done
  finish
}

epilogue() { # nobody ticks: each job carries the campaign on at its end
  campaign "$(settings)
chain: epilogue
chunks: {count: 2}"
  submit
  local end=$((SECONDS + 90))
  until [ "$(open_runs)" = 0 ]; do
    [ "$SECONDS" -lt "$end" ] || fail "the chain broke: $(cat "$root/wake.log")"
    sleep 1
  done
  finish
}

preempt() { # a job of a better partition takes the nodes
  campaign "$(settings ', partition: low')"
  pace=20000
  submit
  until_true 60 'is_running bed && has_progress bed'
  as_user sbatch --partition=high --ntasks=16 --time=1 --wrap='sleep 3' --output=/dev/null >/dev/null
  until_true 60 '[ "$(ask "SELECT count(*) AS x FROM v_attempts")" -ge 2 ]'
  pace=2000
  finish 120
}

crash() { # a node dies with all that is on it
  campaign "$(settings)"
  pace=20000
  submit
  until_true 60 'is_running bed && has_progress bed'
  local node
  node=$(runs_on "$(job_of bed)")
  "$slurm" crash "$node"
  pace=2000
  finish 120
  "$slurm" back "$node"
}

lost() { # a node is lost to the controller, and its engine computes on: two writers
  campaign "$(settings)"
  pace=100000  # not done before the manager has noticed
  submit
  until_true 60 'is_running bed && has_progress bed'
  local node token
  node=$(runs_on "$(job_of bed)")
  token=$(ask "SELECT token AS x FROM v_attempts ORDER BY attempt_id LIMIT 1")
  "$slurm" lost "$node"
  until_true 60 '[ "$(ask "SELECT count(*) AS x FROM v_attempts WHERE run LIKE '"'bed%'"'")" -ge 2 ]'
  pace=2000
  finish 120
  # The lost one found that the run was another's, and wrote nothing more.
  [ ! -e "$(find "$root/beds" -name "outcome-$token.json")" ] || fail "the lost engine had a last word"
  "$slurm" back "$node"
}

stopped_controller() { # sbatch times out although the job is taken
  campaign "$(settings)"
  local pid
  pid=$(cat "$base/slurmctld.pid")
  (sleep 0.2; kill -STOP "$pid"; sleep 9; kill -CONT "$pid") &
  sleep 0.4
  submit || true
  wait
  finish 90
  [ "$(sacct -nX --user="$user" -S now-1minutes -o jobname%20 | sort | uniq -d | wc -l)" = 0 ] ||
    fail "two jobs under one name"
}

controller_down() { # nothing is assumed while nobody answers
  campaign "$(settings)"
  pace=300000  # longer than the controller is down
  submit
  until_true 60 'is_running bed'
  kill "$(cat "$base/slurmctld.pid")"
  local end=$((SECONDS + 30)) attempts
  attempts=$(ask "SELECT count(*) AS x FROM v_attempts")
  while [ "$SECONDS" -lt "$end" ]; do tick; sleep 1; done
  [ "$(ask "SELECT count(*) AS x FROM v_attempts")" = "$attempts" ] || fail "assumed an end"
  slurmctld
  pace=2000
  finish 150
}

limit() { # the site lets a user have one job at a time
  campaign "$(settings)"
  sacctmgr -iQ modify user "$user" set MaxSubmitJobs=1 >/dev/null
  submit
  until_true 60 '[ "$(state_of bed)" = COMPLETED ]'
  until_true 30 'grep -q MaxSubmit "$root/tick.log" || grep -q SubmitJobLimit "$root/tick.log"'
  sacctmgr -iQ modify user "$user" set MaxSubmitJobs=-1 >/dev/null
  finish 150
}

held() { # the controller holds a job whose start failed; a person releases it
  campaign "$(settings)"
  pace=10000
  scontrol update nodename=n[1-4] state=drain reason=test
  submit
  local job
  job=$(job_of bed)
  as_user scontrol hold "$job"
  scontrol update nodename=n[1-4] state=resume
  until_true 20 '[ "$(ask "SELECT reason AS x FROM v_runs WHERE label LIKE '"'bed%'"'")" != "" ]'
  [ "$(state_of bed)" = QUEUED ] || fail "a held job is not waiting"
  as_user scontrol release "$job"
  pace=2000
  finish 90
}

timeout_handler() { # at the walltime; Slurm says TIMEOUT 0:0 whatever the script ends with
  campaign "$(settings | sed 's/5min/1min/')"
  extra=(FAKE_ONLY=beds/ FAKE_HANG_AT=40)
  submit
  extra=(FAKE_NONE=1)
  until_true 200 '[ "$(ask "SELECT count(*) AS x FROM v_attempts WHERE outcome_class = '"'CONTINUE'"'")" -ge 1 ]'
  sacct -nX -j "$(ask "SELECT job AS x FROM v_attempts ORDER BY attempt_id LIMIT 1")" -o state |
    grep -q TIMEOUT || fail "the job did not end at its walltime"
  finish 120
}

forgotten() { # the controller forgets a finished job after 2 s, and there are no accounts
  campaign "$(settings)"
  submit
  sleep 15
  finish 90
}

memory() { # more memory than asked for
  campaign "$(settings)"
  extra=(FAKE_ONLY=beds/ FAKE_EAT_MEMORY_AT=40)
  submit
  until_true 60 '[ "$(state_of bed)" = HELD ]'
  ask "SELECT reason AS x FROM v_runs WHERE label LIKE 'bed%'" | grep -q 'out of memory' ||
    fail "held for another reason"
  extra=(FAKE_NONE=1)
  as_user "$work/grouser" resume --all -C "$root" >>"$root/tick.log" 2>&1 || true
  finish 90
}

grouser=$1
engine=$2
shift 2
export SLURM_CONF=$base/slurm.conf
extra=(FAKE_NONE=1)
chmod 755 "$work"
cp -- "$grouser" "$work/grouser"
cp -- "$engine" "$work/fake_engine"
chown -R "$user" "$work"
trap clean EXIT
scenario=calm
calm
for scenario; do
  pace=2000
  extra=(FAKE_NONE=1)
  from=$SECONDS
  "$scenario"
  printf '%-20s passed %4d s\n' "$scenario" "$((SECONDS - from))"
done
