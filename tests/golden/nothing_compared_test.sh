#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: nothing_compared_test.sh SOURCE_DIR
#
# script/test --deep slow_golden fails where every study was skipped: has_compared_files() of
# script/deep.sh asks what ctest has printed.
set -euo pipefail

source "$1/script/deep.sh"
told=$(mktemp)
trap 'rm -f "$told"' EXIT

cat >"$told" <<'END'
 1/3 Test #901: golden_tunnel_shape ..............***Skipped   0.02 sec
 2/3 Test #902: golden_gear_ring .................***Skipped   0.02 sec
 3/3 Test #903: golden_negative_control ..........   Passed    1.20 sec
END
if has_compared_files "$told" 2>/dev/null; then
  echo "two skipped studies count as compared"
  exit 1
fi
sed -i 's/golden_gear_ring .*/golden_gear_ring .................   Passed   92.10 sec/' "$told"
if ! has_compared_files "$told"; then
  echo "a compared study does not count"
  exit 1
fi
