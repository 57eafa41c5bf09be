#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Says where C++ sources differ from .clang-format; --fix rewrites them. Version 14 decides.
#   tools/check_format.sh [--fix]
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

options=(--dry-run -Werror)
[ "${1:-}" != --fix ] || options=(-i)
mapfile -t files < <(tools/files.sh .cpp .hpp)
clang-format "${options[@]}" "${files[@]}"
echo "format: ${#files[@]} files looked at"
