#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The main job on a bare Debian 12 machine: installs the packages, builds, runs the slip sweep of
# the 71 cm wheel, prints its table and names the report.
#   bash deploy/demo.sh [--root DIR] [--fresh]
# Run again, it goes on with the campaign in DIR: what is done is kept, what was cut off continues
# from its last checkpoint. --fresh throws that campaign away first.
set -euo pipefail
# shellcheck source=deploy/lib.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

campaign=$repository/configs/campaigns/wheel_71cm_slip_sweep.yaml
root=$repository/runs/wheel_71cm_slip_sweep
fresh=no

usage() {
  sed -n '3,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
}

while [ "$#" -gt 0 ]; do
  case "$1" in
    --fresh) fresh=yes ;;
    --root)
      [ "$#" -ge 2 ] || { usage >&2; exit 2; }
      root=$(realpath -m -- "$2")
      shift
      ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done

# Only what is a campaign is removed, and only what a campaign consists of.
remove_campaign() {
  [ -e "$root" ] || return 0
  if [ ! -f "$root/grouser.db" ]; then
    say "$root is not a campaign; it is left alone" >&2
    exit 2
  fi
  say "removing the campaign in $root"
  rm -rf -- "$root"
}

need_packages build
build_preset release grouser grouser-engine
[ "$fresh" = no ] || remove_campaign
if [ -f "$root/grouser.db" ]; then
  say "going on with the campaign in $root (--fresh starts anew)"
else
  say "starting the campaign in $root"
fi
from=$SECONDS
code=0
"$repository/build/release/bin/grouser" submit "$campaign" --root "$root" || code=$?
say "the run part took $((SECONDS - from)) s"
exit "$code"
