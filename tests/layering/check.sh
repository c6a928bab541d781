#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: check.sh [SOURCE_DIR]
#
# Checks what the compiler does not: which room includes which (the table below is the one of
# CONTRIBUTING.md), sizes of files, and words that are not wanted. One line per violation,
# `file:line: what is wrong`; exit 1 when there is any.
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
  simulator_parts = "geometry material light camera sensor"
  allow("core", "")
  n = split(simulator_parts, parts, " ")
  for (i = 1; i <= n; ++i) allow(parts[i], "core")
  allow("render", simulator_parts " core")
  allow("defects", "geometry material core")
  allow("metrics", "core")
  allow("optimizer", "core")
  allow("hardware", "geometry camera core")
  everything = simulator_parts " render defects metrics optimizer hardware core"
  allow("studies", everything)
  allow("cli", everything " studies")
  allow("tests", everything " studies cli")

  heavy = "^(CGAL/|opencv2/|toml\\+\\+|sqlite3|embree3/|embree4/|nlopt|OpenImageIO/|spdlog/|CLI/)"
  unwanted = "std::format[^_a-z]|<format>|std::expected|<expected>|source_location|[^_a-z]views::"
  unwanted = unwanted "|std::random_device|std::mt19937|std::[a-z_]+_distribution|ffast-math"
  unfinished = "TO" "DO|FIX" "ME"
}

function allow(room, list,    names, n, i) {
  known[room] = 1
  arrow[room, room] = 1
  n = split(list, names, " ")
  for (i = 1; i <= n; ++i) arrow[room, names[i]] = 1
}

# "simulator/light/tunnel.h" -> light, "core/error.h" -> core
function room_of(path,    parts) {
  split(path, parts, "/")
  return parts[1] == "simulator" ? parts[2] : parts[1]
}

function report(text) { print FILENAME ":" FNR ": " text }

function end_of_file() {
  if (file == "") return
  limit = file ~ /\.h$/ ? 300 : 600
  if (lines > limit) print file ":" lines ": has " lines " lines, at most " limit " are allowed"
  if (file ~ /\.h$/ && !has_pragma) print file ":1: has no #pragma once"
}

FNR == 1 {
  end_of_file()
  file = FILENAME
  has_pragma = 0
  room = room_of(file)
  if ($0 != "// SPDX-License-Identifier: GPL-3.0-or-later") report("has no SPDX line at its top")
}

{ lines = FNR }

/^#pragma once$/ { has_pragma = 1 }

/^[ \t]*#[ \t]*include[ \t]*[<"]/ {
  target = $0
  sub(/^[^<"]*[<"]/, "", target)
  sub(/[>"].*$/, "", target)
  other = room_of(target)
  if (other in known && index(target, "/") > 0) {
    if (!((room, other) in arrow)) report("includes \"" target "\": " room " must not see " other)
  } else if ($0 ~ /"/) {
    report("includes \"" target "\": write it relative to the root of the repository")
  }
  if (file ~ /\.h$/ && target ~ heavy) report("includes <" target ">: heavy, keep it in one .cpp")
}

$0 ~ unwanted { report("uses what gcc 12 and clang 14 lack or what breaks reproducibility") }
$0 ~ unfinished { report("is marked as unfinished") }
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
