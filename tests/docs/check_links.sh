#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every relative link in the repository's Markdown leads to a file that is there, and to a heading
# that is there when it names one; file:line of each that does not. Files that the text names in
# backquotes below deploy/, tools/, configs/ and docs/ must be there too.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."

bad=0
complain() {
  echo "$1"
  bad=$((bad + 1))
}

# Headings of a page as GitHub names them in links.
anchors() {
  awk '/^```/ { fenced = !fenced } !fenced && /^#+ / {
    text = tolower($0); sub(/^#+ +/, "", text); gsub(/[^a-z0-9 _-]/, "", text); gsub(/ /, "-", text); print text }' "$1"
}

# file:line:target of every link outside fences.
links() {
  awk '/^```/ { fenced = !fenced } !fenced {
    rest = $0; gsub(/`[^`]*`/, "", rest)
    while (match(rest, /\]\([^)]+\)/)) {
      print FILENAME ":" FNR ":" substr(rest, RSTART + 2, RLENGTH - 3)
      rest = substr(rest, RSTART + RLENGTH)
    }
    if (match(rest, /(src|href)="[^"]+"/)) {
      rest = substr(rest, RSTART, RLENGTH); sub(/^[a-z]+="/, "", rest); sub(/"$/, "", rest)
      print FILENAME ":" FNR ":" rest
    }
  }' "$1"
}

# file:line:path of every path in backquotes that must exist.
named_files() {
  awk '{
    rest = $0
    while (match(rest, /`(deploy|tools|configs|docs)\/[A-Za-z0-9_.\/-]*`/)) {
      print FILENAME ":" FNR ":" substr(rest, RSTART + 1, RLENGTH - 2)
      rest = substr(rest, RSTART + RLENGTH)
    }
  }' "$1"
}

mapfile -t pages < <(tools/files.sh .md)
for page in "${pages[@]}"; do
  while IFS=: read -r file line target; do
    case $target in
      http://* | https://* | mailto:*) continue ;;
    esac
    path=${target%%#*}
    anchor=
    [[ $target != *'#'* ]] || anchor=${target#*#}
    full=$file
    [ -z "$path" ] || full=$(dirname -- "$file")/$path
    if [ ! -e "$full" ]; then
      complain "$file:$line: $target is not there"
    elif [ -n "$anchor" ] && ! anchors "$full" | grep -qxF -- "$anchor"; then
      complain "$file:$line: $path has no heading #$anchor"
    fi
  done < <(links "$page")
  while IFS=: read -r file line path; do
    [ -e "$path" ] || complain "$file:$line: $path is not there"
  done < <(named_files "$page")
done
[ "$bad" -eq 0 ] || exit 1
echo "links: ${#pages[@]} pages looked at"
