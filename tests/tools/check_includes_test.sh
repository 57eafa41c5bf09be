#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# tools/check_includes.sh finds each kind of breach where it stands, and nothing in a tree without.
set -euo pipefail
check=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)/tools/check_includes.sh
tree=$(mktemp -d)
trap 'rm -rf -- "$tree"' EXIT

# put FILE LINE...: a source file of these lines.
put() {
  mkdir -p -- "$tree/$(dirname -- "$1")"
  printf '%s\n' "${@:2}" >"$tree/$1"
}

put base/units.cpp '#include "base/units.hpp"' '#include <udunits2.h>' '#include <yaml-cpp/yaml.h>'
put engine/core/communicator.cpp '#include <mpi.h>' '#include "base/check.hpp"'
put engine/dem/laws/table.hpp '#include "engine/dem/laws/rolling.hpp"' '#include "engine/core/vec3.hpp"'
put engine/io/h5.hpp '#include <hdf5.h>'
put engine/app/run.cpp '#include "engine/terrain/wheel.hpp"'
put schedulers/slurm.cpp '#include "base/errors.hpp"'
put campaign/store/database.cpp '#include <SQLiteCpp/SQLiteCpp.h>'
put campaign/main.cpp '#include "campaign/cli/verbs.hpp"'
put tests/engine/mpi_main.cpp '#include <mpi.h>' '#include "markup.hpp"' '#include "campaign/cli/text.hpp"'
"$check" "$tree" || { echo "a tree without breaches is refused"; exit 1; }

put base/case.cpp '' '#include "engine/core/vec3.hpp"' '#include <mpi.h>'
put engine/core/halo.cpp '#include "engine/dem/body.hpp"' '#include "campaign/store/store.hpp"'
put engine/dem/world.cpp '#include <mpi.h>' '  #  include "engine/terrain/bed.hpp"'
put engine/dem/laws/linear.hpp '#include "engine/io/checkpoint.hpp"'
put engine/io/series.cpp '#include "engine/dem/world.hpp"'
put engine/terrain/bed.cpp '#include <hdf5.h>' '#include "engine/io/series.hpp"'
put engine/fields/bins.cpp '#include "base/errors.hpp"'
put schedulers/pbs.cpp '#include "campaign/plan/names.hpp"' '#include "../engine/core/vec3.hpp"'
put campaign/plan/expand.cpp '#include <yaml-cpp/yaml.h>' '#include "campaign/store/store.hpp"'
put campaign/drive/submit.cpp '#include <sqlite3.h>' '#include "engine/app/run.hpp"'
put campaign/report/page.cpp '#include <SQLiteCpp/SQLiteCpp.h>'
put tests/engine/law_test.cpp '#include <mpi.h>'
code=0
"$check" "$tree" >"$tree/found" || code=$?
[ "$code" -eq 1 ] || { echo "breaches end with code $code instead of 1"; exit 1; }
cut -d: -f1,2 "$tree/found" | LC_ALL=C sort >"$tree/places"
LC_ALL=C sort >"$tree/wanted" <<'END'
base/case.cpp:2
base/case.cpp:3
campaign/drive/submit.cpp:1
campaign/drive/submit.cpp:2
campaign/plan/expand.cpp:1
campaign/plan/expand.cpp:2
campaign/report/page.cpp:1
engine/core/halo.cpp:1
engine/core/halo.cpp:2
engine/dem/laws/linear.hpp:1
engine/dem/world.cpp:1
engine/dem/world.cpp:2
engine/fields/bins.cpp:1
engine/io/series.cpp:1
engine/terrain/bed.cpp:1
engine/terrain/bed.cpp:2
includes: 19 breaches
schedulers/pbs.cpp:1
schedulers/pbs.cpp:2
tests/engine/law_test.cpp:1
END
diff -u "$tree/wanted" "$tree/places" && echo "every breach is found"
