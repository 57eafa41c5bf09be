#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs every ready query of docs/reference/queries.md on a campaign with a stand-in engine.
#   check_queries.sh GROUSER FAKE_ENGINE
set -euo pipefail
repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
grouser=$1
GROUSER_ENGINE=$2
export GROUSER_ENGINE FAKE_STEP_MICROSECONDS=0
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd -- "$folder"
"$grouser" init campaign.yaml >/dev/null
"$grouser" submit campaign.yaml --every 0.1 >/dev/null

count=0
while IFS= read -r sql; do
  "$grouser" query "$sql" >out || { echo "queries: does not run: $sql" >&2; exit 1; }
  count=$((count + 1))
done < <(grep '^SELECT' "$repository/docs/reference/queries.md")
[ "$count" -eq 12 ] || { echo "queries: $count of 12" >&2; exit 1; }
echo "queries: $count run"
