#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: release_flags.sh SOURCE_DIR FOLDER
#
# Who builds the program without its tests is not stopped by a compiler's new warning: no file of the
# release build is compiled with -Werror. The build with tests is.
set -euo pipefail

source=$1
folder=$2
rm -rf "$folder"

commands_of() { # preset, options of cmake
  local preset=$1
  shift
  cmake -S "$source" --preset "$preset" -B "$folder/$preset" "$@" > "$folder.log" 2>&1 ||
    { tail -20 "$folder.log"; exit 1; }
  grep '"command":' "$folder/$preset/compile_commands.json"
}

release=$(commands_of release)
if grep -q -- '-Werror' <<< "$release"; then
  echo "release_flags: the release build stops at warnings"
  exit 1
fi
grep -q -- '-Wall' <<< "$release" || { echo "release_flags: it shows no warnings"; exit 1; }
tested=$(commands_of release -DGLINT_TESTS=ON)
grep -q -- '-Werror' <<< "$tested" || { echo "release_flags: the build of the tests goes on at warnings"; exit 1; }
rm -rf "$folder"
