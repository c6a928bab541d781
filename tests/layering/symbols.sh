#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: symbols.sh LIBRARY...
#
# Two rooms that define the same function compile and link; at run time one of them calls the
# other's. Prints the functions and variables of Glint that more than one of the shared libraries
# defines; exit 1 when there is any, 77 when fewer than two libraries are given (static builds).
set -euo pipefail

if (($# < 2)); then
  echo "no shared libraries to compare"
  exit 77
fi

# Inline functions and templates (W, V, u) may stand in many.
twice=$(
  for library in "$@"; do
    nm -D --defined-only "$library" |
      awk -v name="${library##*/}" '$2 ~ /^[TDB]$/ && $3 ~ /5glint/ { print $3, name }'
  done | LC_ALL=C sort | awk '$1 == symbol { print symbol, first, $2 } { symbol = $1; first = $2 }'
)
if [[ -n $twice ]]; then
  c++filt <<<"$twice"
  exit 1
fi
echo "no function is defined twice"
