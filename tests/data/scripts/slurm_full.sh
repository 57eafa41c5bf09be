#!/bin/bash
#SBATCH --job-name=gabc123def456
#SBATCH --ntasks=10
#SBATCH --nodes=3
#SBATCH --time=0-08:00:00
#SBATCH --signal=B:USR1@300
#SBATCH --mem=64G
#SBATCH --partition=batch
#SBATCH --account=soil@gpu
#SBATCH --qos=normal
#SBATCH --no-requeue
#SBATCH --output=attempts/abc123def456.log
#SBATCH --open-mode=append
# Attempt abc123def456 of run slip_20-s1, campaign sweep; written by grouser.

. '/home/user/set up.sh'
token=abc123def456
cd -- '/scratch/it'\''s here/run' || exit 40

# A job that the batch system started over claims the run anew, so that its earlier life, which a
# lost node may still carry on, publishes nothing more.
claim=$token
owns_run() {
  [ "$(cat fence)" = "$claim" ]
}
if [ -e "attempts/$token.started" ]; then
  read -r owner life <fence || true
  claim="$token $((${life:-0} + 1))"
  if [ "$owner" = "$token" ]; then
    printf '%s' "$claim" >"fence.$token" && mv -f "fence.$token" fence
    rm -f "outcome-$token.json" "attempts/$token.exit" stop
  fi
fi

# The batch system wants the job to end: the engine is asked by its stop file, unless the run has
# gone over to another attempt.
ask_to_stop() {
  if owns_run && [ ! -e stop ]; then
    echo signal >stop
  fi
}
trap ask_to_stop TERM USR1

# The word of this script about itself; readers see a whole record or none.
record() {
  printf '{"token": "%s", "job": "%s", "host": "%s", "code": %d}\n' \
    "$token" "${SLURM_ARRAY_TASK_ID:+${SLURM_ARRAY_JOB_ID}_}${SLURM_ARRAY_TASK_ID:-${SLURM_JOB_ID:-}}" "$(uname -n)" "$2" >"attempts/$token.$1.tmp" &&
    mv -f "attempts/$token.$1.tmp" "attempts/$token.$1"
}

if ! owns_run; then
  echo "superseded: another attempt owns this run" >&2
  exit 22
fi
record started -1
'srun' '--mpi=pmix' '-n' '10' '/opt/grouser/bin/grouser-engine' '--run-dir' '/scratch/runs/sweep/runs/slip_20-s1-01234567' '--token' 'abc123def456' &
engine=$!
code=127
# A trapped signal ends `wait` early: wait again until the engine is gone.
while kill -0 "$engine" 2>/dev/null; do
  wait "$engine"
  code=$?
done
wait "$engine" 2>/dev/null
last=$?
[ "$last" -eq 127 ] || code=$last
if owns_run; then
  record exit "$code"
fi
exit "$code"
