#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Re-tabulates the straight-driving trials of the source into points.csv.
#   sh retabulate.sh smooth_wheel_trials.csv > points.csv
# The input has one row per trial and the columns named below. Standard deviations are between
# trials (n - 1).
set -eu
export LC_ALL=C
awk -F, '
{ sub(/\r$/, "") }
NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
$column["beta"] == 0 {
  rim = $column["Vry"] + 0
  if (!(rim in trials)) order[++conditions] = rim
  n = ++trials[rim]
  slip[rim] += $column["slip"]
  add(rim, n, 1, -$column["avg_Fy"])
  add(rim, n, 2, -$column["avg_Fz"])
  add(rim, n, 3, -$column["avg_Z"])
  add(rim, n, 4, $column["avg_Fy"] / $column["avg_Fz"])
}
function add(rim, n, channel, value) { sum[rim, channel] += value; each[rim, channel, n] = value }
function deviation(rim, channel, mean,    k, squares) {
  for (k = 1; k <= trials[rim]; ++k) squares += (each[rim, channel, k] - mean) ^ 2
  return sqrt(squares / (trials[rim] - 1))
}
END {
  split("pull load sinkage pull_coefficient", name, " ")
  print "condition,slip,kind,observable,value,uncertainty,trials"
  for (a = 1; a <= conditions; ++a)      # ascending rim speed
    for (b = a + 1; b <= conditions; ++b)
      if (order[b] < order[a]) { t = order[a]; order[a] = order[b]; order[b] = t }
  for (a = 1; a <= conditions; ++a) {
    rim = order[a]
    for (c = 1; c <= 4; ++c) {
      mean = sum[rim, c] / trials[rim]
      printf "rim_%g_mm_s,%.4f,lab,%s,%.5g,%.3g,%d\n", rim, slip[rim] / trials[rim], name[c], mean,
             deviation(rim, c, mean), trials[rim]
    }
  }
}' "$1"
