# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# What the scripts of this folder share. Sourced, not run.

repository=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

# One line about the step that follows.
say() {
  printf '== %s\n' "$*"
}

# Names from packages.txt for the given uses (build, test), those that may be left out included.
packages_for() {
  local use
  for use in "$@"; do
    awk -v use="$use" '$1 == use || $1 == use "?" { print $2 }' "$repository/deploy/packages.txt"
  done
}

# Whether packages.txt lets one be left out.
may_be_left_out() {
  awk -v name="$1" '$1 ~ /[?]$/ && $2 == name { found = 1 } END { exit !found }' \
    "$repository/deploy/packages.txt"
}

# Those of the given packages that are not installed.
missing_packages() {
  local name
  for name in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] ||
      printf '%s\n' "$name"
  done
}

apt_get() {
  DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o DPkg::Lock::Timeout=600 "$@"
}

# Makes sure that the packages for the given uses are there: installs what is missing where that
# is possible, else prints the exact list. Without dpkg nobody can tell what is missing, so the
# build goes on and names it.
need_packages() {
  local -a all missing needed=()
  local name
  mapfile -t all < <(packages_for "$@")
  if ! command -v dpkg-query >/dev/null; then
    say "not Debian: these Debian 12 packages, or what they hold, must be installed"
    printf '%s\n' "${all[@]}"
    return
  fi
  mapfile -t missing < <(missing_packages "${all[@]}")
  if [ "${#missing[@]}" -eq 0 ]; then
    say "packages: all ${#all[@]} are installed"
    return
  fi
  if [ "$(id -u)" -ne 0 ]; then
    for name in "${missing[@]}"; do
      may_be_left_out "$name" || needed+=("$name")
    done
    if [ "${#needed[@]}" -eq 0 ]; then
      say "packages: going on without ${missing[*]}, which may be left out"
      return
    fi
    say "packages: ${#missing[@]} are missing and only root may install them; run"
    printf 'apt-get install --no-install-recommends %s\n' "${missing[*]}"
    return 1
  fi
  say "packages: installing ${missing[*]}"
  apt_get update >/dev/null
  apt_get install --no-install-recommends "${missing[@]}" >/dev/null
}

# Cores this process may use.
cores() {
  nproc
}

# Configures a CMake preset and builds the given targets of it, or everything.
build_preset() {
  local preset=$1
  shift
  local -a targets=()
  [ "$#" -eq 0 ] || targets=(--target "$@")
  say "configuring preset $preset in build/$preset"
  (cd -- "$repository" && cmake --preset "$preset" >/dev/null)
  say "building preset $preset with $(cores) jobs"
  (cd -- "$repository" && cmake --build --preset "$preset" --parallel "$(cores)" "${targets[@]}")
}

# Open MPI refuses root unless told that it is meant, as in a container.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
