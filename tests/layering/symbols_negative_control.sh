#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: symbols_negative_control.sh COMPILER
#
# Shows that symbols.sh finds a function that two libraries define, and is content with inline ones.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

library() { # compiler, code, name
  printf '%s\n' "$2" | "$1" -x c++ -shared -fPIC -o "$folder/$3.so" -
}

compiler=$1
library "$compiler" 'namespace glint { int motion_of(int x) { return x; } }' one
library "$compiler" 'namespace glint { int motion_of(int x) { return -x; } }' two
library "$compiler" 'namespace glint { inline int seen(int x) { return x; }
int first(int x) { return seen(x); } }' three
library "$compiler" 'namespace glint { inline int seen(int x) { return x; }
int second(int x) { return seen(x); } }' four

if "$here/symbols.sh" "$folder/one.so" "$folder/two.so" >"$folder/out"; then
  echo "a function of two libraries slipped through"
  exit 1
fi
grep -q 'glint::motion_of(int) one.so two.so' "$folder/out"
"$here/symbols.sh" "$folder/three.so" "$folder/four.so"
