#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the fuzzers with clang and runs each: tests/fuzz/run.sh [SECONDS] [TARGET...]
# What it finds new is kept beside the build; only inputs that crashed belong into corpus/.
set -euo pipefail
repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
seconds=${1:-60}
shift || true
cd -- "$repository"
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzzers
programs=build/fuzz/tests/fuzz
[ $# -gt 0 ] || mapfile -t targets < <(cd "$programs" && compgen -G 'fuzz_*[a-z]' | sed 's/^fuzz_//' | sort)
[ $# -eq 0 ] || targets=("$@")
for target in "${targets[@]}"; do
  [ -x "$programs/fuzz_$target" ] || continue
  mkdir -p "$programs/found/$target"
  printf '%s: ' "$target"
  OMPI_MCA_btl=self "$programs/fuzz_$target" -max_total_time="$seconds" -max_len=65536 -timeout=10 \
    -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$programs/found/$target-" \
    "$programs/found/$target" "tests/fuzz/corpus/$target" 2>"$programs/found/$target.log" ||
    { tail -40 "$programs/found/$target.log"; exit 1; }
  awk '/number_of_executed_units/ { print $2 " inputs, no crash" }' "$programs/found/$target.log"
done
