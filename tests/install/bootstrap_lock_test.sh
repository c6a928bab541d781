#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: bootstrap_lock_test.sh SOURCE_DIR
#
# script/bootstrap waits while another installation holds the lock of the package lists, and does
# not wait when updating them fails for another reason. Stand-ins are found in PATH before the real
# programs: no package is installed.
set -euo pipefail

bootstrap=$1/script/bootstrap
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export folder PATH="$folder:$PATH"

stand_in() { # program; its text is read
  { echo '#!/bin/bash' && cat; } >"$folder/$1"
  chmod +x "$folder/$1"
}
stand_in dpkg-query </dev/null # nothing is installed
stand_in sudo <<<'exec "$@"'
# shellcheck disable=SC2016 # meant for the stand-in
stand_in sleep <<<'echo "sleep $1" >>"$folder/calls"'
stand_in apt-get <<'END'
case " $* " in
  *" update "*)
    echo update >>"$folder/calls"
    (($(grep -c update "$folder/calls") > $(<"$folder/refused"))) && exit
    echo "E: $(<"$folder/why")" >&2
    exit 100
    ;;
  *" install "*) echo install >>"$folder/calls" ;;
esac
END

expect() { # exit code, how often updating is refused, why, the calls
  local code=0
  rm -f "$folder/calls"
  echo "$2" >"$folder/refused"
  echo "$3" >"$folder/why"
  "$bootstrap" --run >"$folder/said" 2>&1 || code=$?
  if ((code != $1)) || [[ $(paste -sd ' ' "$folder/calls") != "$4" ]]; then
    echo "refused $2 times with \"$3\": exit code $code, calls: $(paste -sd ' ' "$folder/calls")"
    cat "$folder/said"
    exit 1
  fi
}
lock='Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (apt-get)'
expect 0 0 '' 'update install'
expect 0 2 "$lock" 'update sleep 5 update sleep 5 update install'
expect 2 1 'The repository has no Release file' 'update'
# Ten minutes: 120 times, with a wait between them.
expect 2 1000 "$lock" "update$(printf ' sleep 5 update%.0s' {2..120})"
