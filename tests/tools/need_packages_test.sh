#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What deploy/lib.sh makes of missing packages where only root could install them: one that may be
# left out is left out, any other stops with the list. dpkg-query and id are stand-ins.
set -euo pipefail
repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT

printf '#!/bin/sh\necho 1000\n' >"$folder/id"
cat >"$folder/dpkg-query" <<'SH'
#!/bin/sh
for name in "$@"; do :; done
case " $MISSING " in *" $name "*) exit 1 ;; esac
printf installed
SH
chmod +x "$folder/id" "$folder/dpkg-query"

# expect CODE MISSING TEXT: need_packages ends so and says TEXT.
expect() {
  local code=0
  MISSING=$2 PATH=$folder:$PATH bash -euo pipefail -c \
    '. "$1/deploy/lib.sh"; need_packages build test' lib "$repository" >"$folder/output" || code=$?
  if [ "$code" -ne "$1" ] || ! grep -qxF -- "$3" "$folder/output"; then
    echo "without '$2': code $code instead of $1, or another text than '$3':"
    cat -- "$folder/output"
    exit 1
  fi
}

all=$(grep -cE '^(build|test)' "$repository/deploy/packages.txt")
expect 0 "" "== packages: all $all are installed"
expect 0 "ccache" "== packages: going on without ccache, which may be left out"
expect 1 "ccache cmake" "apt-get install --no-install-recommends cmake ccache"
expect 1 "shellcheck" "apt-get install --no-install-recommends shellcheck"
echo "packages: four machines as they should be"
