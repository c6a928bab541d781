#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Shows that check.sh can fail: a stand-in for the program writes known files; the same bytes pass,
# a changed byte, a missing and an added file do not, changed times do not matter, and a kind of
# machine without records is skipped, as it is with another compiler or another Embree.
set -euo pipefail

check=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/check.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export GLINT_GOLDEN_RECORDS=$folder/records
failures=0

stand_in() { # compiler, lines that change what is written
  cat >"$folder/program" <<SCRIPT
#!/usr/bin/env bash
mkdir -p out/winner/sequence
date +%N >out/log.txt
printf '{ "isa": "any", "compiler": "$1", "started": %s }\n' "\$(date +%N)" >out/run.json
printf 'a\n' >out/winner/sequence/frame_000.png
printf 'b\n' >out/winner/sequence/frame_001.png
printf 'trial\n1\n' >out/trials.csv
$2
SCRIPT
  chmod +x "$folder/program"
}

# A script is linked with nothing, so ldd has a stand-in, too.
stand_in_ldd() { # version of Embree
  mkdir -p "$folder/bin"
  printf '#!/bin/sh\necho "libembree3.so.3 => %s/libembree3.so.%s (0x1)"\n' "$folder" "$1" \
    >"$folder/bin/ldd"
  chmod +x "$folder/bin/ldd"
}
PATH=$folder/bin:$PATH
stand_in_ldd 3.1.4

expect() { # exit code, what is shown
  local code=0
  bash "$check" "$folder/program" tunnel_shape >"$folder/output" 2>&1 || code=$?
  if ((code != $1)); then
    echo "$2: exit $code, expected $1"
    cat "$folder/output"
    failures=$((failures + 1))
  fi
}

stand_in "gcc 1.2.3" ""
bash "$check" "$folder/program" tunnel_shape --record
expect 0 "the same bytes"
stand_in "gcc 1.2.3" "printf 'c\n' >out/winner/sequence/frame_001.png"
expect 1 "a changed byte"
stand_in "gcc 1.2.3" "mv out/winner/sequence/frame_00{0,2}.png; mv out/winner/sequence/frame_00{1,0}.png
mv out/winner/sequence/frame_00{2,1}.png"
expect 1 "two frames that changed places"
stand_in "gcc 1.2.3" "rm out/winner/sequence/frame_001.png"
expect 1 "a missing file"
stand_in "gcc 1.2.3" "touch out/scores.json"
expect 1 "an added file"
stand_in "gcc 3.2.1" ""
expect 77 "another compiler"
stand_in "gcc 1.2.3" ""
stand_in_ldd 3.1.5
expect 77 "another Embree"
stand_in_ldd 3.1.4
expect 0 "the same bytes again"

if ((failures > 0)); then
  exit 1
fi
echo "every difference is found"
