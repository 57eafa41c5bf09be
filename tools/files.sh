#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Names the repository's files, one a line, whose names end in one of the given words (none: all):
# those git knows, or, in a copy without git, all but what builds and runs leave.
#   tools/files.sh [.cpp .hpp ...]
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

list() {
  git ls-files 2>/dev/null ||
    find . -path './build*' -prune -o -path ./runs -prune -o -type f -printf '%P\n' | LC_ALL=C sort
}

list | while read -r file; do
  [ -f "$file" ] || continue
  [ "$#" -gt 0 ] || printf '%s\n' "$file"
  for ending in "$@"; do
    [[ $file != *"$ending" ]] || printf '%s\n' "$file"
  done
done
