#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Shows that check.sh can fail: a small clean tree passes, and each single violation put into it is
# found and named. Exit 1 when one slips through.
set -euo pipefail

check=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/check.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

spdx='// SPDX-License-Identifier: GPL-3.0-or-later'

clean_tree() {
  rm -rf "${tree:?}"/*
  mkdir -p "$tree"/{core,metrics,optimizer,hardware,simulator/{light,geometry,render},defects,studies,cli}
  printf '%s\n#pragma once\n#include <vector>\n' "$spdx" >"$tree/core/error.h"
  printf '%s\n#include "core/error.h"\n#include <CGAL/a.h>\n' "$spdx" >"$tree/core/error.cpp"
  printf '%s\n#pragma once\n#include "simulator/light/a.h"\n' "$spdx" >"$tree/simulator/render/a.h"
  printf '%s\n#pragma once\n#include "simulator/light/b.h"\n' "$spdx" >"$tree/simulator/light/a.h"
  printf '%s\n#include "studies/a.h"\n#include "metrics/a.h"\n' "$spdx" >"$tree/cli/main.cpp"
  printf '%s\n#include "simulator/geometry/a.h"\n' "$spdx" >"$tree/defects/a.cpp"
}

expect_found() { # what to expect in the output
  local output
  if output=$(bash "$check" "$tree"); then
    echo "not found: $1"
    failures=$((failures + 1))
  elif [[ $output != *"$1"* || $output != *"layering: 1 violation"* ]]; then
    echo "expected only: $1"
    echo "got: $output"
    failures=$((failures + 1))
  fi
}

add() { # file, line: a violation at the end of a clean file
  clean_tree
  printf '%s\n' "$2" >>"$tree/$1"
}

clean_tree
if ! output=$(bash "$check" "$tree"); then
  echo "the clean tree does not pass: $output"
  failures=$((failures + 1))
fi

add core/error.cpp '#include "error.h"'
expect_found "core/error.cpp:4: includes \"error.h\": write it relative to the root"
add core/error.h '#include <opencv2/core.hpp>'
expect_found "core/error.h:4: includes <opencv2/core.hpp>: heavy"
add core/error.h '#include <toml++/toml.h>'
expect_found "core/error.h:4: includes <toml++/toml.h>: heavy"

for line in 'auto a = std::format("{}", 1);' '#include <source_location>' \
  'for (int i : std::views::iota(0, 3)) {' 'std::normal_distribution<double> d;'; do
  add core/error.cpp "$line"
  expect_found "core/error.cpp:4: uses what gcc 12 and clang 14 lack"
done
add core/error.cpp "// TO""DO later"
expect_found "core/error.cpp:4: is marked as unfinished"
add core/error.cpp 'std::cout << 1;'
expect_found "core/error.cpp:4: prints"
add defects/a.cpp 'thread_local int count = 0;'
expect_found "defects/a.cpp:3: keeps state of a thread"
for line in 'return note.find(words) != note.npos;' 'if (cell.message.starts_with("The wall")) {' \
  'return std::string_view(error.what()).ends_with("px");'; do
  add cli/main.cpp "$line"
  expect_found "cli/main.cpp:4: searches a text that people read"
done
for line in 'return change.starts_with(table + ".");' 'if (reason.starts_with(name)) {' \
  'return why.find("closed") == 0;' 'if (row.doc.ends_with(words)) {'; do
  for file in hardware/link.cpp optimizer/step.cpp; do
    clean_tree
    printf '%s\n' "$spdx" "$line" >"$tree/$file"
    expect_found "$file:2: searches a text that people read"
  done
done
clean_tree
printf '%s\n' "message = message.substr(0, message.find('\\n'));" >>"$tree/cli/main.cpp"
if ! output=$(bash "$check" "$tree"); then
  echo "the first line of a message does not pass: $output"
  failures=$((failures + 1))
fi
add core/error.cpp "const char* p = \"/ho""me/ann/part.stl\";"
expect_found "core/error.cpp:4: names a path of one machine"

clean_tree
printf '#include <vector>\n' >"$tree/core/b.cpp"
expect_found "core/b.cpp:1: has no SPDX line"
clean_tree
printf '%s\n#include <vector>\n' "$spdx" >"$tree/core/b.h"
expect_found "core/b.h:1: has no #pragma once"

if ((failures > 0)); then
  echo "$failures violation(s) slipped through"
  exit 1
fi
echo "every violation is found"
