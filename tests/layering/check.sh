#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: check.sh [SOURCE_DIR]
#
# Checks what the compiler does not: heavy headers, and words that are not wanted.
# One line per violation, `file:line: what is wrong`; exit 1 when there is any. Which room may
# include which is checked by rooms.mjs.
set -euo pipefail

cd "${1:-$(dirname "${BASH_SOURCE[0]}")/../..}"

rooms=()
for room in core simulator defects metrics optimizer hardware studies cli tests script .ci docs; do
  if [[ -e $room ]]; then
    rooms+=("$room")
  fi
done

list() {
  find "${rooms[@]}" -name node_modules -prune -o -type f "$@" -print | LC_ALL=C sort
}

violations=$(mktemp)
trap 'rm -f "$violations"' EXIT

# --- C++ files ------------------------------------------------------------------------------------
# The patterns are put together from parts so that this file does not contain what it looks for.
read -r -d '' cpp_rules <<'AWK' || true
BEGIN {
  tops = "^(core|simulator|defects|metrics|optimizer|hardware|studies|cli|tests)$"
  heavy = "^(CGAL/|ceres/|opencv2/|toml\\+\\+|sqlite3|embree3/|embree4/|nlopt|OpenImageIO/|spdlog/|CLI/)"
  unwanted = "std::format[^_a-z]|<format>|std::expected|<expected>|source_location|[^_a-z]views::"
  unwanted = unwanted "|std::random_device|std::mt19937|std::[a-z_]+_distribution|ffast-math"
  unfinished = "TO" "DO|FIX" "ME"
  # Not for a single character, as that of a line's end.
  searched = "(note|message|remark|problem|change|reason|why|sentence|doc|text\\(\\)|what\\(\\))s?"
  searched = searched "\\)?\\.(r?find|starts_with|ends_with)\\([^']"
}

# "simulator/light/tunnel/tunnel.h" -> simulator
function top_of(path) { return substr(path, 1, index(path, "/") - 1) }

function report(text) { print FILENAME ":" FNR ": " text }

function end_of_file() {
  if (file == "") return
  if (file ~ /\.h$/ && !has_pragma) print file ":1: has no #pragma once"
}

FNR == 1 {
  end_of_file()
  file = FILENAME
  has_pragma = 0
  room = top_of(file)
  if ($0 != "// SPDX-License-Identifier: GPL-3.0-or-later") report("has no SPDX line at its top")
}

/^#pragma once$/ { has_pragma = 1 }

/^[ \t]*#[ \t]*include[ \t]*[<"]/ {
  target = $0
  sub(/^[^<"]*[<"]/, "", target)
  sub(/[>"].*$/, "", target)
  if ($0 ~ /"/ && top_of(target) !~ tops) {
    report("includes \"" target "\": write it relative to the root of the repository")
  }
  if (file ~ /\.h$/ && target ~ heavy) report("includes <" target ">: heavy, keep it in one .cpp")
}

$0 ~ unwanted { report("uses what gcc 12 and clang 14 lack or what breaks reproducibility") }
$0 ~ unfinished { report("is marked as unfinished") }
/thread_local/ && room != "tests" { report("keeps state of a thread; let an object own it") }
room ~ /^(studies|cli|hardware|optimizer)$/ && $0 ~ searched { report("searches a text that people read; give it a kind") }
/std::(cout|cerr)/ && room != "cli" && room != "tests" { report("prints; libraries never do") }

END { end_of_file() }
AWK

list \( -name '*.h' -o -name '*.cpp' \) | xargs -r -d '\n' awk "$cpp_rules" >>"$violations"

# --- All text files -------------------------------------------------------------------------------
# A path of somebody's machine works nowhere else.
read -r -d '' text_rules <<'AWK' || true
/(^|[^A-Za-z0-9_.}])\/(home|root|Users|mnt|work)\// {
  print FILENAME ":" FNR ": names a path of one machine"
}
AWK

{
  list \( -name '*.h' -o -name '*.cpp' -o -name '*.cmake' -o -name 'CMakeLists.txt' -o -name '*.md' \
    -o -name '*.toml' -o -name '*.sh' -o -name '*.js' -o -name '*.mjs' -o -name '*.json' \
    -o -path 'script/*' -o -path '.ci/*' \)
  find . -maxdepth 1 -type f \( -name '*.md' -o -name 'CMake*' \) | sed 's|^\./||'
} | xargs -r -d '\n' awk "$text_rules" >>"$violations"

if [[ -s $violations ]]; then
  cat "$violations"
  echo "layering: $(wc -l <"$violations") violation(s)"
  exit 1
fi
echo "layering: no violation"
