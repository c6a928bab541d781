#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Shows that sizes.mjs can fail: files and functions of the greatest length pass, and each that is
# longer by one line is found and named, and nothing else with it. Exit 1 when one slips through.
set -euo pipefail

sizes=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/sizes.mjs
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

lines() { # number, format: so many lines
  seq -f "${2:-// %g}" "$1"
}

function_of() { # head, number: a function of so many lines
  printf '%s {\n' "$1"
  lines "$(($2 - 2))" '  // %g'
  printf '}\n'
}

clean_tree() {
  rm -rf "${tree:?}"/*
  mkdir -p "$tree"/{core,tests/core}
  printf '#define GLINT_WIDE __attribute__((flatten))\n' >"$tree/core/simd.h"
  {
    function_of 'int plain(int a)' 60
    function_of 'GLINT_WIDE void Kernel::run(const float* __restrict values) const' 60
    function_of 'void visit_keys(KeyVisitor& keys, Settings& settings)' 200
    lines 130
  } >"$tree/core/a.cpp"
  lines 300 >"$tree/core/a.h"
  {
    function_of 'TEST(Thing, IsSo)' 60
    function_of 'TEST_F(Thing, IsSo)' 30
  } >"$tree/tests/core/a_test.cpp"
}

expect_clean() { # what to expect in the output
  local output
  if ! output=$(node "$sizes" "$tree") || [[ $output != *"$1"* ]]; then
    echo "the clean tree does not pass with: $1"
    echo "got: $output"
    failures=$((failures + 1))
  fi
}

expect_found() { # what to expect in the output
  local output
  if output=$(node "$sizes" "$tree"); then
    echo "not found: $1"
    failures=$((failures + 1))
  elif [[ $output != *"$1"* || $output != *"sizes: 1 violation(s)"* ]]; then
    echo "expected only: $1"
    echo "got: $output"
    failures=$((failures + 1))
  fi
}

# Functions of 60, 60 and 200 lines in files of 450, 300 and 1; tests of 60 and 30 lines in one of
# 90: 90 / 751 = 0.12. Of code are the heads and braces of three functions, and of two tests:
# 4 / 6 = 0.67.
clean_tree
expect_clean 'functions in sources         3      60     200     200     200'
expect_clean 'files in sources             3     300     450     450     450'
expect_clean 'functions in tests           2      30      60      60      60'
expect_clean 'tests to sources: 90 / 751 lines = 0.12'
expect_clean 'tests to sources: 90 / 751 lines of all languages = 0.12'
expect_clean 'tests to sources: 4 / 6 lines of code in .cpp files = 0.67'
printf '\n/* Two lines\n   of a comment. */\nint answer() { return 42; }  // code\n' >>"$tree/tests/core/a_test.cpp"
expect_clean 'tests to sources: 5 / 6 lines of code in .cpp files = 0.83'
mkdir -p "$tree/tests/core/node_modules"
printf 'one\ntwo\n' >"$tree/tests/core/pages.mjs"
printf 'one\n' >"$tree/core/page.css"
cp "$tree/core/page.css" "$tree/tests/core/node_modules/page.js"
expect_clean 'tests to sources: 96 / 752 lines of all languages = 0.13'
rm -r "$tree/tests/core/node_modules" "$tree/tests/core/pages.mjs" "$tree/core/page.css"

echo '// one more' >>"$tree/core/a.cpp"
expect_found 'core/a.cpp:451: has 451 lines, at most 450 are allowed'
clean_tree
echo '// one more' >>"$tree/core/a.h"
expect_found 'core/a.h:301: has 301 lines, at most 300 are allowed'
clean_tree
lines 451 >"$tree/tests/core/b_test.cpp"
expect_found 'tests/core/b_test.cpp:451: has 451 lines, at most 450 are allowed'

clean_tree
function_of 'static int long_one(int a)' 61 >"$tree/core/b.cpp"
expect_found 'core/b.cpp:1: long_one has 61 lines, at most 60 are allowed'
clean_tree
function_of 'GLINT_WIDE void Kernel::run(float* __restrict values)' 61 >"$tree/core/b.cpp"
expect_found 'core/b.cpp:1: run has 61 lines, at most 60 are allowed'
clean_tree
function_of 'TEST(Thing, IsLong)' 61 >"$tree/tests/core/b_test.cpp"
expect_found 'tests/core/b_test.cpp:1: TEST has 61 lines, at most 60 are allowed'

if ((failures > 0)); then
  echo "$failures violation(s) slipped through"
  exit 1
fi
echo "every violation is found"
