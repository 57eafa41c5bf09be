#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every ctest command in the pages (`... -R 'A|B'` or `... -L 'A|B'`) names tests that exist, each
# alternative at least one.
#   check_test_names.sh BUILD
set -euo pipefail
build=$(realpath -- "$1")
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."

mapfile -t pages < <(tools/files.sh .md)
bad=0
seen=0
while IFS=: read -r page line command; do
  # In a table a | is written \|.
  read -r option pattern < <(sed -E "s/.*(-[RL]) +'?([^'\` ]+).*/\\1 \\2/; s/\\\\[|]/|/g" <<<"$command")
  for alternative in ${pattern//|/ }; do
    seen=$((seen + 1))
    if ctest --test-dir "$build" -N "$option" "$alternative" | grep -qx 'Total Tests: 0'; then
      echo "$page:$line: no test has $option '$alternative'"
      bad=$((bad + 1))
    fi
  done
done < <(grep -noHE 'ctest --test-dir [^`]* -[RL] [^`]*' -- "${pages[@]}")
[ "$seen" -gt 0 ] || { echo "no ctest command found"; exit 1; }
[ "$bad" -eq 0 ] || exit 1
echo "test names: $seen looked at"
