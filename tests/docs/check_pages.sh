#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The reference pages say what the program does: exit codes as in the code, and the tables of the
# checkpoint page as in the files of a small campaign.
#   check_pages.sh BIN
set -euo pipefail
bin=$(realpath -- "$1")
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
export LC_ALL=C

# compare WHAT: the two lists in the folder must be one.
compare() {
  if [ ! -s "$folder/code" ] || [ ! -s "$folder/page" ]; then
    echo "$1: nothing to compare"
    exit 1
  fi
  diff -u --label "what the program has" --label "$1" "$folder/code" "$folder/page"
  echo "$1: $(wc -l <"$folder/page") rows as in the program"
}

# First four cells of the rows below the header that begins with the given cells; backquotes go.
rows() {
  awk -F ' *[|] *' -v header="$2" '
    { gsub(/`/, "") }
    index($0, header) == 1 { on = 1; next }
    !/^[|]/ { on = 0 }
    on && !/^[|]---/ { print $2, $3, $4, $5 }' "$1"
}

page=docs/reference/exit_codes.md
{
  # Name and number from the header, the word from the function that gives it.
  awk '/^enum class EngineCode/ { on = 1; next } on && /};/ { exit }
       on && /=/ { name = $1; number = $3; sub(/,/, "", number); print name, number }' \
    base/run_contract.hpp | sort >"$folder/numbers"
  awk '/^const char\* word_of/ { on = 1 } on && /^}/ { exit }
       on && /case/ { sub(/.*::/, ""); sub(/:.*/, ""); name = $0 }
       on && /return/ { gsub(/.*return "|".*/, ""); print name, $0 }' base/run_contract.cpp |
    sort >"$folder/words"
  join "$folder/numbers" "$folder/words" | awk '{ print "engine", $2, $3 }'
  awk '/inline constexpr int/ { sub(/;/, "", $6); print "grouser", $6 }' campaign/cli/exit_codes.hpp
} | sort >"$folder/code"
awk -F ' *[|] *' '
  /^## / { part = $0; sub(/^## /, "", part); sub(/grouser-engine/, "engine", part) }
  (part == "engine" || part == "grouser") && $2 ~ /^[0-9]+$/ {
    word = part == "engine" ? " " $3 : ""; gsub(/`/, "", word); print part, $2 word }' "$page" |
  sort >"$folder/page"
compare "$page"

page=docs/reference/formats/checkpoint.md
"$bin/grouser" submit configs/campaigns/small_wheel.yaml --root "$folder/campaign" \
  >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
checkpoint=$(find "$folder/campaign/runs" -name '*.h5' | sort | tail -n 1)
# Group, dataset, components and unit, from h5dump's description of the file.
h5dump -A "$checkpoint" | awk '
  /^ *GROUP "/ { group = $2; gsub(/"/, "", group) }
  /^ *DATASET "/ { dataset = $2; gsub(/"/, "", dataset) }
  /DATASPACE  SIMPLE/ { width = $6 }
  /ATTRIBUTE "/ { attribute = $2; gsub(/"/, "", attribute) }
  /\(0\): / && attribute == "unit" { unit = $0; gsub(/.*\(0\): "|"$/, "", unit); print group, dataset, width, unit }' |
  sort >"$folder/code"
rows "$page" '| group | dataset |' | sort >"$folder/page"
compare "$page"
