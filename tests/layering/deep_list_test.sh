#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: deep_list_test.sh SOURCE_DIR
#
# script/test --deep --list tells how long each part took when it last passed on this machine; each
# part that it lists can be run.
set -euo pipefail

source "$1/script/deep.sh"
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

fail() {
  echo "$1"
  exit 1
}

minutes_of() { # part
  list_deep_parts | awk -v part="$1" '$1 == part { print $2 }'
}

[[ $(minutes_of clang) == - ]] || fail "minutes of a part that never ran: $(minutes_of clang)"
mkdir -p "$root/build/deep"
{
  SECONDS=754
  report_part clang passed 0
  report_part clang "FAILED, see build/deep/clang.log" 400
  report_part tsan "FAILED, see build/deep/tsan.log" 0
} 2>/dev/null
[[ $(minutes_of clang) == 12.6 ]] || fail "754 s are 12.6 min, not $(minutes_of clang)"
[[ $(minutes_of tsan) == - ]] || fail "a part that failed at once has minutes: $(minutes_of tsan)"

while read -r part _; do
  declare -F "deep_$part" >/dev/null || fail "part $part has no function"
done < <(list_deep_parts | tail -n +2)
(($(list_deep_parts | wc -l) == $(declare -F | grep -c ' deep_[a-z_]*$') + 1)) ||
  fail "a part is not listed"
