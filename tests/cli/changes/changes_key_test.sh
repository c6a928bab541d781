#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: changes_key_test.sh SOURCE_DIR
#
# What script/test --deep slow_changes has kept is kept for one build and one width: changes_key()
# of script/deep.sh is another one when the program, a library, the test or the width is.
set -euo pipefail

source "$1/script/deep.sh"
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
mkdir -p "$build/studies/compare" "$build/tests/cli"
files=(glint studies/compare/libglint_studies_compare.so tests/cli/test_cli_compare_changes)
unset GLINT_COMPARE_WIDTH

for file in "${files[@]}"; do
  echo 1 >"$build/$file"
done
first=$(changes_key "$build")
echo 2 >"$build/studies/compare/notes.txt"
if [[ $(changes_key "$build") != "$first" ]]; then
  echo "another key for the same build"
  exit 1
fi
for file in "${files[@]}"; do
  echo 2 >"$build/$file"
  if [[ $(changes_key "$build") == "$first" ]]; then
    echo "the same key for another $file"
    exit 1
  fi
  echo 1 >"$build/$file"
done
if [[ $(GLINT_COMPARE_WIDTH=612 changes_key "$build") == "$first" ]]; then
  echo "the same key for another width"
  exit 1
fi
