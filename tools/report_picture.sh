#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Puts two drawings of a report into one SVG file that stands by itself: bed and wheel of a run, and
# the pull over slip.
#   tools/report_picture.sh REPORT.html RUN OUT.svg
set -euo pipefail
[ "$#" -eq 3 ] || { sed -n '3,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2; exit 2; }
report=$1 run=$2 out=$3

# drawing LABEL: the SVG element of the report that is called so.
drawing() {
  awk -v label="aria-label=\"$1\"" '
    index($0, label) { sub(/.*<svg/, "<svg"); on = 1; found = 1 }
    on { print }
    on && /<\/svg>/ { exit }
    END { exit !found }' "$report" | sed '$s#</svg>.*#</svg>#' ||
    { echo "$report has no drawing '$1'" >&2; return 1; }
}

# placed X Y WIDTH HEIGHT: the element that comes in, at this place.
placed() {
  sed "1s/<svg/<svg x=\"$1\" y=\"$2\" width=\"$3\" height=\"$4\"/"
}

# Colours and the rules for drawings, without those that lay out a page.
style() {
  awk '/^<style>|^:root/ { on = 1 } /^\* \{/ { on = 0 } /^svg text/ { on = 1 }
    /^(@container|@media [(]max|@media print)/ { skipped = 1 }
    on && !skipped && !/^(<style>|\/\*|[.]scale|[.]run )/ { print }
    /^\}/ { skipped = 0 } /<\/style>/ { exit }' "$report" | sed '/<\/style>/d'
}

bed=$(drawing "$run: bed and wheel, coloured by displacement")
pull=$(drawing 'Pull coefficient over slip')
{
  echo '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 400" font-family="system-ui, sans-serif">'
  echo '<style>'
  style
  echo '</style>'
  placed 0 0 530 400 <<<"$bed"
  placed 560 50 440 300 <<<"$pull"
  echo '</svg>'
} >"$out"
echo "$out: $(wc -c <"$out") bytes"
