#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every scenario on a real Slurm, some ten minutes: tests/slurm/all.sh BUILD-FOLDER
# Brings Slurm up three times: with accounting, without, and with memory confined by cgroups.
set -euo pipefail
repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
build=$(cd -- "$1" && pwd)
slurm=$repository/deploy/slurm.sh
failed=0

with() { # KIND SCENARIO...
  local kind=$1 scenario
  shift
  for scenario; do
    GROUSER_SLURM=$kind "$slurm" up >/dev/null  # also after one that failed half-way
    "$repository/tests/slurm/slurm_campaign.sh" "$build/bin/grouser" \
      "$build/tests/fakes/fake_engine" "$scenario" || failed=1
  done
  "$slurm" down
}

with full array cancelled_pending chain prologue epilogue preempt crash lost stopped_controller \
  controller_down limit held timeout_handler
with bare forgotten
if [ -w /sys/fs/cgroup/memory ]; then
  with memory memory
else
  echo "memory: left out, there are no writable cgroups of version 1 here"
fi
exit "$failed"
