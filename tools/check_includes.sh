#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Names every #include that breaks the arrows and fences of ARCHITECTURE.md, as file:line: reason.
#   tools/check_includes.sh [DIR]     DIR: a source tree, by default this one
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
tree=${1:-$here}

# Arrows: a folder and the folders it may include from, itself aside. Where folders nest, the
# longest name that fits decides. Tests may look at everything.
arrows='
base
schedulers       base
engine/core      base
engine/dem       base engine/core
engine/io        base engine/core
engine/lbm       base engine/core
engine/terrain   base engine/core engine/dem
engine/coupling  base engine/core engine/dem engine/lbm
engine/app       base engine/core engine/dem engine/lbm engine/coupling engine/io engine/terrain
campaign/plan    base schedulers
campaign/store   base
campaign/drive   base schedulers campaign/plan campaign/store
campaign/report  base campaign/store
campaign/cli     base schedulers campaign/plan campaign/store campaign/drive campaign/report
campaign/serve   base schedulers campaign/plan campaign/store campaign/drive campaign/report campaign/cli
campaign         base schedulers campaign/plan campaign/store campaign/drive campaign/report campaign/cli campaign/serve diagnosis/cli
diagnosis/recordings base campaign/report
diagnosis/models     base diagnosis/recordings
diagnosis/hypotheses base diagnosis/recordings diagnosis/models
diagnosis/inference  base diagnosis/recordings diagnosis/models diagnosis/hypotheses
diagnosis/report     base campaign/report diagnosis/recordings diagnosis/models diagnosis/hypotheses diagnosis/inference
diagnosis/blind      base diagnosis/recordings diagnosis/models diagnosis/hypotheses diagnosis/inference diagnosis/report
diagnosis/cli        base campaign diagnosis
bench            base engine
tests            base schedulers engine campaign diagnosis
'

# Fences: a pattern of headers and where alone they may be included.
fences='
^mpi[.]h$                     ^(engine/core/|tests/(engine/mpi_main|fuzz/checkpoint_fuzz)[.]cpp$)
^zoltan[.]h$                  ^engine/core/
^(hdf5|H5[A-Za-z]*|hdf5_hl)[.]h(pp)?$  ^engine/io/
^omp[.]h$                     ^engine/core/
^(sqlite3[.]h$|SQLiteCpp/)    ^campaign/store/
^yaml-cpp/                    ^base/
^httplib[.]h$                 ^(campaign/serve/|tests/end_to_end/serve_campaign_test[.]cpp$)
^(udunits2|xxhash)[.]h$       ^base/
'

cd -- "$tree"
if [ "$tree" = "$here" ]; then
  list=(tools/files.sh .cpp .hpp .hpp.in .cpp.in .h .c)
else
  list=(find . -type f -printf '%P\n')
fi
mapfile -t files < <("${list[@]}")
[ "${#files[@]}" -gt 0 ] || { echo "includes: no sources in $tree" >&2; exit 2; }

grep -nHE '^[[:space:]]*#[[:space:]]*include' -- "${files[@]}" |
  ARROWS=$arrows FENCES=$fences awk -v files="${#files[@]}" '
    BEGIN {
      count = split(ENVIRON["ARROWS"], lines, "\n")
      for (i = 1; i <= count; ++i) {
        words = split(lines[i], word, " ")
        if (words == 0) continue
        known[word[1]] = 1
        for (w = 2; w <= words; ++w) may[word[1], word[w]] = 1
      }
      count = split(ENVIRON["FENCES"], lines, "\n")
      for (i = 1; i <= count; ++i)
        if (split(lines[i], word, " ") == 2) { ++fences; header[fences] = word[1]; place[fences] = word[2] }
    }
    # The longest known folder that holds a path, "" when there is none.
    function folder_of(path,    folder) {
      folder = path
      while (sub("/[^/]*$", "", folder)) if (folder in known) return folder
      return ""
    }
    # Whether `from` may include from folder `to`, by itself or by one above it.
    function allowed(from, to) {
      if (from == to) return 1
      for (;;) {
        if ((from, to) in may) return 1
        if (!sub("/[^/]*$", "", to)) return 0
      }
    }
    function breach(reason) { printf "%s:%s: %s\n", file, line, reason; ++breaches }
    {
      at = index($0, ":"); file = substr($0, 1, at - 1); rest = substr($0, at + 1)
      at = index(rest, ":"); line = substr(rest, 1, at - 1); text = substr(rest, at + 1)
      if (!match(text, "[<\"][^>\"]+[>\"]")) next
      name = substr(text, RSTART + 1, RLENGTH - 2)
      from = folder_of(file)
      if (from == "") { breach("stands in no folder of ARCHITECTURE.md"); next }
      if (name ~ /(^|\/)[.][.]\//) { breach("\"" name "\" climbs; name the file from the root"); next }
      to = folder_of(name)
      if (to != "" && !allowed(from, to)) breach(from " must not include " to " (" name ")")
      for (f = 1; f <= fences; ++f)
        if (name ~ header[f] && file !~ place[f]) breach(name " stands outside its fence")
    }
    END {
      if (breaches) { printf "includes: %d breaches\n", breaches; exit 1 }
      printf "includes: %d files, no breach\n", files
    }'
