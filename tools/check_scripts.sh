#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs shellcheck over the repository's shell scripts, known by their first line or their name.
#   tools/check_scripts.sh
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

# Scripts under tests/data are what the program writes, compared word by word elsewhere.
mapfile -t files < <(tools/files.sh |
  while read -r file; do
    [[ $file != tests/data/* ]] || continue
    if [[ $file == *.sh ]] || head -n 1 -- "$file" | grep -qaE '^#!.*\b(ba)?sh\b'; then
      printf '%s\n' "$file"
    fi
  done)
shellcheck --severity=warning --external-sources --source-path=SCRIPTDIR --source-path=. "${files[@]}"
echo "scripts: ${#files[@]} files looked at"
