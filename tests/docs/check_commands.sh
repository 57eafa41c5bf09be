#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the commands of one page that stand in fences marked ```sh check, or ```sh check=CODE where
# they must end with CODE. They run one after another in one new folder that shows the
# repository's files, with the built programs first on the path.
#   check_commands.sh BIN PAGE
set -euo pipefail
bin=$(realpath -- "$1")
repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
page=$2

folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
ln -s -- "$repository"/{configs,docs,deploy,tools} "$folder/"
export PATH=$bin:$PATH

# Splits the page into FOLDER/blocks/LINE.CODE, LINE being where the block begins.
mkdir -- "$folder/blocks"
awk -v blocks="$folder/blocks" '
  /^```sh check(=[0-9]+)?$/ { code = $0; sub(/^```sh check=?/, "", code); file = sprintf("%s/%05d.%d", blocks, NR, code); next }
  /^```/ { if (file) close(file); file = ""; next }
  file { print > file }' "$repository/$page"

ran=0
for block in "$folder"/blocks/*; do
  [ -e "$block" ] || break
  name=$(basename -- "$block")
  line=$((10#${name%.*}))
  wanted=${name##*.}
  code=0
  (cd -- "$folder" && bash -euo pipefail "$block") >"$folder/output" 2>&1 || code=$?
  if [ "$code" -ne "$wanted" ]; then
    cat -- "$block" "$folder/output"
    echo "$page:$line: ends with code $code instead of $wanted"
    exit 1
  fi
  ran=$((ran + 1))
done
[ "$ran" -gt 0 ] || { echo "$page: no marked commands"; exit 1; }
echo "$page: $ran blocks of commands ran"
