#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# All that must hold before a change is taken: format, include rules, shell scripts, a build with
# warnings as errors, and every test; those that need a real Slurm (label `slurm`, its short part)
# when root runs it on Debian. tests/slurm/all.sh has the others of Slurm.
#   bash deploy/test.sh
# Installs what tests need, goes on after a failed check and ends with a summary.
set -euo pipefail
# shellcheck source=deploy/lib.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"
cd -- "$repository"

summary=()
failed=0

# check NAME COMMAND...: runs it, notes how it ended and how long it took.
check() {
  local name=$1 from=$SECONDS word=passed
  shift
  say "$name"
  "$@" || { word=FAILED; failed=1; }
  summary+=("$(printf '%-16s %-7s %5d s' "$name" "$word" "$((SECONDS - from))")")
  [ "$word" = passed ]
}

close() {
  say "summary"
  printf '%s\n' "${summary[@]}"
  exit "$failed"
}

check packages need_packages build test || close
check format tools/check_format.sh || true
check includes tools/check_includes.sh || true
check scripts tools/check_scripts.sh || true
check build build_preset dev || close
check tests ctest --test-dir build/dev --output-on-failure --parallel "$(cores)" \
  --label-exclude '^slurm$' || true
if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
  check slurm ctest --test-dir build/dev --output-on-failure --label-regex '^slurm$' || true
else
  say "slurm: left out, only root can start one"
fi
close
