#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the benchmarks and runs one of them; see docs/performance/.
#   bench/run.sh dem [--json FILE] [--quick]
#   bench/run.sh lbm [--json FILE] [--cells N] [--rounds N] [--others]
#   bench/run.sh coupled [--json FILE] [--cells N] [--rounds N]
#   bench/run.sh scaling [--json FILE] [--ranks N,N,...] [--part N] [--svg FILE]
#   bench/run.sh reliability [--json FILE] [--manager-kills N] [--engine-kills N] [--no-space N]
#   bench/run.sh campaign [--json FILE] [--runs N] [--chunks N] [--active N]
# reliability: kills managers and engines, fills disks; campaign: the manager on 10 000 runs.
# dem: the DEM engine beside LAMMPS, LIGGGHTS and YADE on one settled bed. The first call prepares
# the bed (some ten minutes on two cores) and keeps it under build/bench/data.
# lbm: plain flow on a lattice beside the limit of bandwidth of the same run.
# coupled: a suspension of moving spheres on a lattice beside plain flow of the same run.
# scaling: the engine's messages on 64 to 4 096 simulated ranks; needs Debian's libsimgrid-dev.
# GROUSER_BENCH_BUILD: another build folder.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${GROUSER_BENCH_BUILD:-$root/build/bench}

scaling() {
  if ! command -v smpicxx >/dev/null; then
    echo "bench: smpicxx is missing: apt-get install libsimgrid-dev" >&2
    exit 2
  fi
  mkdir -p -- "$build/bin"
  (cd -- "$root" && smpicxx -std=c++20 -O3 -I. bench/scaling/{bed_share,scaling_driver}.cpp \
    engine/core/{communicator,decomposition,halo}.cpp base/{check,errors}.cpp \
    -o "$build/bin/scaling_driver")
  python3 "$root/bench/scaling/run.py" "$build/bin/scaling_driver" \
    --svg "$root/docs/performance/scaling.svg" "$@"
}

if [ "${1:-}" = scaling ]; then
  shift
  scaling "$@"
  exit 0
fi
if [ "${1:-}" = reliability ] || [ "${1:-}" = campaign ]; then
  bench=$1
  shift
  # With the tests' programs: GROUSER_BENCH_BUILD or build/dev.
  build=${GROUSER_BENCH_BUILD:-$root/build/dev}
  (cd -- "$root" && cmake --preset dev -B "$build") >&2
  cmake --build "$build" --target grouser grouser-engine fake_engine campaign_tests >&2
  programs=(--bin "$build/bin" --fake-engine "$build/tests/fakes/fake_engine")
  [ "$bench" = campaign ] || programs+=(--unit-tests "$build/tests/campaign/campaign_tests")
  python3 "$root/bench/$bench/run.py" "${programs[@]}" "$@"
  exit 0
fi
if [ "${1:-}" != dem ] && [ "${1:-}" != lbm ] && [ "${1:-}" != coupled ]; then
  sed -n '3,14s/^# \{0,1\}//p' -- "${BASH_SOURCE[0]}" >&2
  exit 2
fi
kind=$1
shift

export OMP_NUM_THREADS=1
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
mpi() { mpirun --oversubscribe --bind-to none -np "$@"; }

# hash_of FILE...: names a prepared bed by what it is made from.
hash_of() { cat -- "$@" | sha256sum | cut -c 1-12; }

# The engine goes on where it was interrupted, and does nothing when the bed is at rest.
prepare_bed() {
  echo "bench: the bed is in $bed" >&2
  mkdir -p -- "$bed"
  cp -- "$root/bench/dem/bed.yaml" "$bed/case.yaml"
  echo bench >"$bed/fence"
  mpi 2 "$build/bin/grouser-engine" --run-dir "$bed" --token bench
  "$build/bin/dem_bench" export "$bed"
}

# parameters.in is written last: without it the bed is not complete.
prepare_wheel() {
  [ ! -f "$wheel/parameters.in" ] || return 0
  echo "bench: lowering the wheel into the bed in $wheel" >&2
  mkdir -p -- "$wheel"
  cat -- "$root/bench/dem/bed.yaml" "$root/bench/dem/wheel.yaml" >"$wheel/case.yaml"
  mpi 2 "$build/bin/dem_bench" sink "$bed" "$wheel"
}

lbm() {
  cmake --build "$build" --target lbm_bench >&2
  python3 "$root/bench/lbm/compare.py" "$build/bin/lbm_bench" "$@"
}

coupled() {
  cmake --build "$build" --target coupled_bench >&2
  python3 "$root/bench/lbm/coupled.py" "$build/bin/coupled_bench" "$@"
}

(cd -- "$root" && cmake --preset release -B "$build" -DGROUSER_BENCH=ON) >&2
if [ "$kind" = coupled ]; then
  coupled "$@"
  exit 0
fi
if [ "$kind" = lbm ]; then
  lbm "$@"
  exit 0
fi
cmake --build "$build" --target grouser-engine dem_bench >&2
bed=$build/data/bed-$(hash_of "$root/bench/dem/bed.yaml")
wheel=$build/data/wheel-$(hash_of "$root"/bench/dem/{bed,wheel}.yaml "$root"/bench/*.cpp)
prepare_bed
prepare_wheel
python3 "$root/bench/dem/compare.py" "$build/bin/dem_bench" "$bed" "$wheel" "$@"
