#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Puts the tables of `grouser schema` into docs/reference/campaign_yaml.md, below its own text.
# Usage: tools/update_reference.sh GROUSER
set -eu
page="$(dirname "$0")/../docs/reference/campaign_yaml.md"
tables=$("$1" schema)
text=$(sed '/^## Campaign$/,$d' "$page")
printf '%s\n\n%s\n' "$text" "$tables" >"$page.new"
mv "$page.new" "$page"
