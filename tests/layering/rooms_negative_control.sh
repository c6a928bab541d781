#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Shows that rooms.mjs can fail: a small clean tree passes, and each single violation put into it is
# found and named, and nothing else with it. Exit 1 when one slips through.
#
# shellcheck disable=SC2016  # backticks of Markdown and variables of CMake stay as they are
set -euo pipefail

rooms=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/rooms.mjs
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

write() { # file, lines: a file with an SPDX line and these
  mkdir -p "$(dirname "$tree/$1")"
  printf '%s\n' '// SPDX-License-Identifier: GPL-3.0-or-later' "${@:2}" >"$tree/$1"
}

library() { # folder, call of glint_library
  printf '%s\n' "glint_library($2)" >"$tree/$1/CMakeLists.txt"
}

write_map() {
  cat >"$tree/CONTRIBUTING.md" <<'MAP'
## Module map

| room | target | what it holds | may see |
|---|---|---|---|
| `core/` | `glint::core` | errors | - |
| `core/config/` | `glint::core::config` | keys | core |
| `simulator/light/` | `glint::light` | lamps | `core` |
| `simulator/render/` | - | pictures | light, core |
| `simulator/render/rays/` | `glint::render::rays` | rays | - |
| `simulator/render/wall/` | `glint::render::wall` | hits | rays |
| `simulator/render/scan/` | `glint::render::scan` | frames | wall |
| `metrics/` | `glint::metrics` | scores | core |
| `cli/` | `glint` | the program | render metrics |

## Something else

| `planned/` | `glint::planned` | is no row of the map | everything |
MAP
}

write_core() {
  write core/error.h '#pragma once' 'namespace glint {' 'class Error {' ' public:' \
    '  ~Error();' '  int code(int a, int b = 0) const;' ' private:' '  struct Data;' '};' \
    'bool operator==(const Error&, const Error&);' \
    'template <class T>' 'T value_of(const Error& error);' \
    'void fail(int code);' 'void fail(int code, int line);' \
    'void note(const std::vector<std::pair<int, int>>& values, int count = 0);' '}'
  write core/error.cpp '#include "core/error.h"' \
    '#define GLINT_WIDE __attribute__((target_clones("default", "avx2")))' \
    '#define GLINT_UNUSED [[maybe_unused]]' \
    'namespace glint {' 'namespace {' 'void hidden() {}' '}' \
    'static void also_hidden() {}' 'GLINT_WIDE static void hidden_clones() {}' \
    'struct Error::Data {' '  Data();' '  void fill() {}' '};' 'Error::Data::Data() {}' \
    'Error::~Error() = default;' 'int Error::code(int a, int b) const { return a + b; }' \
    'bool operator==(const Error&, const Error&) { return true; }' \
    'template <>' 'int value_of<int>(const Error&) { return 0; }' \
    'GLINT_WIDE void fail(int code) {' '  const auto throw_it = [&] { return code; };' '}' \
    'void fail(int code, GLINT_UNUSED int line) {}' \
    'using Values = std::vector<std::pair<int, int>>;' \
    'void note(const Values& values, const int count) {}' '}'
  library core 'core HEADERS error.h SOURCES error.cpp PUBLIC fmt::fmt'
  write core/config/keys.h '#pragma once' '#include "core/error.h"'
  write core/config/keys.cpp '#include "core/config/keys.h"' '#include <CGAL/a.h>'
  library core/config 'core::config HEADERS keys.h SOURCES keys.cpp ${BUILD}/page.cpp
    PUBLIC # not (only) glint::metrics
    glint::core'
}

write_simulator() {
  write simulator/light/lamp.h '#pragma once' '#include "core/config/keys.h"'
  library simulator/light 'light HEADERS lamp.h PUBLIC glint::core::config'
  write simulator/render/rays/rays.h '#pragma once' '#include "core/error.h"' \
    '#include "simulator/light/lamp.h"'
  library simulator/render/rays 'render::rays HEADERS rays.h
    PUBLIC glint::core PRIVATE glint::light'
  write simulator/render/wall/hits.h '#pragma once' '#include "simulator/render/rays/rays.h"'
  library simulator/render/wall 'render::wall HEADERS hits.h PUBLIC glint::render::rays'
  write simulator/render/scan/scan.h '#pragma once' '#include "simulator/render/wall/hits.h"'
  library simulator/render/scan 'render::scan HEADERS scan.h PUBLIC glint::render::wall'
}

write_program() {
  write metrics/scores.h '#pragma once' '#include <core/error.h>'
  library metrics 'metrics HEADERS scores.h PUBLIC glint::core'
  write cli/commands.h '#pragma once' 'namespace glint {' 'int run_command();' '}'
  write cli/run.cpp '#include "cli/commands.h"' '#include "metrics/scores.h"' \
    '#include "simulator/render/scan/scan.h"' \
    'namespace glint {' 'int run_command() { return 0; }' '}'
  write cli/main.cpp '#include "cli/commands.h"' 'int main() { return glint::run_command(); }'
  printf '%s\n' 'add_executable(glint main.cpp run.cpp)' \
    'target_link_libraries(glint PRIVATE' \
    '  glint::render::scan glint::metrics glint_flags CLI11::CLI11)' \
    >"$tree/cli/CMakeLists.txt"
  write tests/core/error_test.cpp '#include "metrics/scores.h"' 'void not_declared() {}'
}

clean_tree() {
  rm -rf "${tree:?}"/*
  write_map
  write_core
  write_simulator
  write_program
}

expect_found() { # what to expect in the output
  local output
  if output=$(node "$rooms" "$tree"); then
    echo "not found: $1"
    failures=$((failures + 1))
  elif [[ $output != *"$1"* || $output != *"rooms: 1 violation"* ]]; then
    echo "expected only: $1"
    echo "got: $output"
    failures=$((failures + 1))
  fi
}

expect_clean() { # what the tree has, what to expect in the output
  local output
  if ! output=$(node "$rooms" "$tree") || [[ $output != *"$2"* ]]; then
    echo "$1 does not pass with: $2"
    echo "got: $output"
    failures=$((failures + 1))
  fi
}

add() { # file, line: a line at the end of a file
  printf '%s\n' "$2" >>"$tree/$1"
}

include() { # file, header
  add "$1" "#include \"$2\""
}

edit() { # file, sed script, which must change something
  cp "$tree/$1" "$tree/before"
  sed -i "$2" "$tree/$1"
  if cmp -s "$tree/$1" "$tree/before"; then
    echo "changes nothing: $2"
    failures=$((failures + 1))
  fi
  rm "$tree/before"
}

may_see() { # room, cell: what its row says
  edit CONTRIBUTING.md "s#^\(| .$1/. |.*|\)[^|]*|\$#\1 $2 |#"
}

clean_tree
expect_clean "the clean tree" "render: 3 rooms on 3 levels, 2 arrows"
expect_clean "the clean tree" "core: 2 rooms on 2 levels, 1 arrow"
if ! node "$rooms" --arrows "$tree" | grep -qxF 'simulator/render/rays/: - | core light'; then
  echo "--arrows does not say what simulator/render/rays/ includes"
  failures=$((failures + 1))
fi

# --- What includes what ---------------------------------------------------------------------------
clean_tree
include simulator/render/scan/scan.h simulator/render/rays/rays.h
expect_found 'simulator/render/scan/scan.h:4: includes "simulator/render/rays/rays.h": '\
'render/scan must not see render/rays'
clean_tree
include metrics/scores.h simulator/light/lamp.h
expect_found 'metrics/scores.h:4: includes "simulator/light/lamp.h": metrics must not see light'
clean_tree
include simulator/render/wall/hits.h metrics/scores.h
expect_found 'simulator/render/wall/hits.h:4: includes "metrics/scores.h": '\
'render must not see metrics'
clean_tree
add metrics/scores.h '  # include <simulator/render/rays/rays.h>'
expect_found 'metrics/scores.h:4: includes "simulator/render/rays/rays.h": '\
'metrics must not see render'
clean_tree
may_see core/config -
expect_found 'core/config/keys.h:3: includes "core/error.h": core/config must not see core'
clean_tree
include core/error.cpp tests/core/error.h
expect_found 'core/error.cpp:28: includes "tests/core/error.h", which lies in no room'

clean_tree
may_see simulator/render/scan 'wall rays'
expect_found 'CONTRIBUTING.md:11: simulator/render/scan/ may see rays, but nothing here includes it'
clean_tree
may_see metrics 'core light'
expect_found 'CONTRIBUTING.md:12: metrics/ may see light, but nothing here includes it'
clean_tree
may_see simulator/render 'light core wall'
expect_found 'CONTRIBUTING.md:8: simulator/render/ may see wall, but nothing here includes it'

# The map may allow a circle, the check does not.
clean_tree
may_see simulator/render/rays wall
include simulator/render/rays/rays.h simulator/render/wall/hits.h
edit simulator/render/rays/CMakeLists.txt 's/PRIVATE/PRIVATE glint::render::wall/'
expect_found 'is part of the circle render/rays -> render/wall -> render/rays
    simulator/render/rays/rays.h:5 includes "simulator/render/wall/hits.h"
    simulator/render/wall/hits.h:3 includes "simulator/render/rays/rays.h"'
clean_tree
may_see simulator/render/rays scan
include simulator/render/rays/rays.h simulator/render/scan/scan.h
edit simulator/render/rays/CMakeLists.txt 's/PRIVATE/PRIVATE glint::render::scan/'
expect_found 'is part of the circle render/rays -> render/scan -> render/wall -> render/rays
    simulator/render/rays/rays.h:5 includes "simulator/render/scan/scan.h"
    simulator/render/scan/scan.h:3 includes "simulator/render/wall/hits.h"
    simulator/render/wall/hits.h:3 includes "simulator/render/rays/rays.h"'
# Rooms of two halls.
clean_tree
may_see simulator/light 'core metrics'
may_see metrics 'core light'
include simulator/light/lamp.h metrics/scores.h
include metrics/scores.h simulator/light/lamp.h
edit simulator/light/CMakeLists.txt 's/PUBLIC/PUBLIC glint::metrics/'
edit metrics/CMakeLists.txt 's/PUBLIC/PUBLIC glint::light/'
expect_found 'is part of the circle metrics -> light -> metrics'
# Two halls without a circle of rooms: core/config sees metrics, which sees core.
clean_tree
may_see core metrics
include core/config/keys.h metrics/scores.h
edit core/config/CMakeLists.txt 's/glint::core)/glint::core glint::metrics)/'
expect_found 'is part of the circle core -> metrics -> core
    core/config/keys.h:4 includes "metrics/scores.h"
    metrics/scores.h:3 includes "core/error.h"'

# --- The map --------------------------------------------------------------------------------------
clean_tree
edit CONTRIBUTING.md '/render\/scan/d'
expect_found 'CONTRIBUTING.md: simulator/render/scan/ has no row in the module map'
clean_tree
edit CONTRIBUTING.md '/simulator\/render\/`/d'
expect_found 'CONTRIBUTING.md: simulator/render/ has no row in the module map'
clean_tree
edit CONTRIBUTING.md '/`metrics/i | `optimizer/` | `glint::optimizer` | search | core |'
expect_found 'CONTRIBUTING.md:12: optimizer/ is no folder with .h or .cpp files, nor a hall'
clean_tree
edit CONTRIBUTING.md '/`metrics/p'
expect_found 'CONTRIBUTING.md:13: metrics/ has a row already, line 12'
clean_tree
edit CONTRIBUTING.md '/`metrics/s/ scores |/ /'
expect_found 'CONTRIBUTING.md:12: has 3 cells, must be room, target, what it holds, may see'
clean_tree
edit CONTRIBUTING.md 's/## Module map/## Rooms/'
expect_found 'CONTRIBUTING.md:1: has no table under "## Module map"'
clean_tree
may_see metrics 'core optimizer'
expect_found 'CONTRIBUTING.md:12: metrics/ may see "optimizer": there is no such room'
clean_tree
may_see metrics 'core, core'
expect_found 'CONTRIBUTING.md:12: metrics/ may see "core": named twice'
clean_tree
may_see simulator/render/wall 'rays light'
expect_found 'CONTRIBUTING.md:10: simulator/render/wall/ may see "light": '\
'only the row of a hall names other halls'
# A room that is called as another hall.
clean_tree
write metrics/light/a.h '#pragma once'
library metrics/light 'metrics::light HEADERS a.h'
edit CONTRIBUTING.md '/`metrics/a | `metrics/light/` | `glint::metrics::light` | a | - |'
may_see metrics 'core light'
expect_found 'metrics/ may see "light": may be metrics/light/ or simulator/light/; write the path'
may_see metrics 'core metrics/light'
include metrics/scores.h metrics/light/a.h
edit metrics/CMakeLists.txt 's/PUBLIC/PUBLIC glint::metrics::light/'
expect_clean "a path in the map" "metrics: 2 rooms on 2 levels, 1 arrow"

# --- Targets --------------------------------------------------------------------------------------
clean_tree
edit CONTRIBUTING.md 's/`glint::render::wall`/`glint::wall`/'
expect_found 'CONTRIBUTING.md:10: simulator/render/wall/ has the target glint::wall, '\
'must be glint::render::wall'
clean_tree
edit CONTRIBUTING.md 's/`glint` |/`glint::cli` |/'
expect_found 'CONTRIBUTING.md:13: cli/ has the target glint::cli, must be glint'
clean_tree
edit CONTRIBUTING.md 's/render\/` | -/render\/` | `glint::render`/'
expect_found 'CONTRIBUTING.md:8: simulator/render/ has the target glint::render, '\
'must be - as it holds no files'
clean_tree
edit simulator/render/wall/CMakeLists.txt 's/render::wall/render_wall/'
expect_found 'simulator/render/wall/CMakeLists.txt:1: declares glint::render_wall, '\
'must be glint::render::wall'
clean_tree
add metrics/CMakeLists.txt 'glint_library(inspection)'
expect_found 'metrics/CMakeLists.txt:2: declares a second target'
clean_tree
rm "$tree/metrics/CMakeLists.txt"
expect_found 'metrics/CMakeLists.txt: is missing'
clean_tree
printf '# glint_library(metrics)\n' >"$tree/metrics/CMakeLists.txt"
expect_found 'metrics/CMakeLists.txt:1: declares no target'

clean_tree
edit simulator/render/rays/CMakeLists.txt 's/glint::light//'
expect_found 'simulator/render/rays/rays.h:4: includes "simulator/light/lamp.h", '\
'but simulator/render/rays/CMakeLists.txt does not link glint::light'
clean_tree
edit cli/CMakeLists.txt 's/glint::metrics//'
expect_found 'cli/run.cpp:3: includes "metrics/scores.h", '\
'but cli/CMakeLists.txt does not link glint::metrics'
clean_tree
edit simulator/render/scan/CMakeLists.txt 's/PUBLIC/PUBLIC glint::core/'
expect_found 'simulator/render/scan/CMakeLists.txt:1: links glint::core, but includes nothing of it'
clean_tree
edit cli/CMakeLists.txt 's/PRIVATE/PRIVATE glint::light/'
expect_found 'cli/CMakeLists.txt:2: links glint::light, but includes nothing of it'
clean_tree
edit metrics/CMakeLists.txt 's/PUBLIC/PUBLIC glint::render/'
expect_found 'metrics/CMakeLists.txt:1: links glint::render, which is the target of no other room'

clean_tree
edit core/CMakeLists.txt 's/ error.cpp//'
expect_found 'core/CMakeLists.txt:1: SOURCES lacks error.cpp'
clean_tree
edit core/CMakeLists.txt 's/ error.h//'
expect_found 'core/CMakeLists.txt:1: HEADERS lacks error.h'
clean_tree
edit cli/CMakeLists.txt 's/ run.cpp//'
expect_found 'cli/CMakeLists.txt:1: SOURCES lacks run.cpp'
clean_tree
edit core/CMakeLists.txt 's/error.cpp/error.cpp gone.cpp/'
expect_found 'core/CMakeLists.txt:1: SOURCES lists gone.cpp, which is no such file of this folder'
clean_tree
edit core/CMakeLists.txt 's/error.h/error.h\n  config\/keys.h/'
expect_found 'core/CMakeLists.txt:2: HEADERS lists config/keys.h, '\
'which is no such file of this folder'

# --- Files and their headers ----------------------------------------------------------------------
in_error_cpp() { # line, name: this definition is not declared
  clean_tree
  add core/error.cpp "namespace glint { $1 }"
  expect_found "core/error.cpp:28: defines $2(), which error.h does not declare"
}
in_error_cpp 'void lost() {}' lost
in_error_cpp 'inline void lost() {}' lost
in_error_cpp 'GLINT_WIDE void lost(const float* __restrict a) {}' lost
in_error_cpp 'void fail(int code, int line, int column) {}' fail
in_error_cpp 'void fail(double code) {}' fail
in_error_cpp 'bool operator<(const Error& a, const Error& b) { return true; }' 'operator <'
in_error_cpp 'namespace other { void fail(int code) {} }' other::fail
in_error_cpp 'void Progress::show() {}' Progress::show
in_error_cpp 'Progress::~Progress() = default;' Progress::~Progress
clean_tree
add core/error.cpp 'int main() { return 0; }'
expect_clean "main()" "rooms: no violation"

without_header() { # folder, its sources in CMake, contents of its file lost.cpp
  clean_tree
  write "$1/lost.cpp" "$3"
  edit "$1/CMakeLists.txt" "s/$2/$2 lost.cpp/"
}
without_header core error.cpp '#include "core/error.h"
void glint::fail(int code) {}'
edit core/error.cpp '/void fail(int code) {/,/^}/d'
expect_found 'core/lost.cpp: has no header lost.h for fail()'
without_header core error.cpp 'void a() {} void b() {} void c() {} void d() {} void e() {}'
expect_found 'core/lost.cpp: has no header lost.h for a(), b(), c() and 2 more'
without_header core error.cpp 'namespace { void a() {} }'
expect_clean "a file without functions for others" "rooms: no violation"
without_header cli run.cpp 'namespace glint { int other_command() { return 0; } }'
expect_found 'cli/lost.cpp: has no header lost.h for other_command()'

# --- Questions ------------------------------------------------------------------------------------
in_run_cpp() { # code, what it asks
  clean_tree
  add cli/run.cpp "static bool is_so = $1;"
  expect_found "cli/run.cpp:8: asks $2: how a scene is rendered is asked in "
}
in_run_cpp 'needs_paths(scene)' needs_paths
in_run_cpp 'traced.is_sampled()' is_sampled
in_run_cpp '!scene.has_tunnel' has_tunnel
in_run_cpp 'scene.lights.empty()' 'lights.empty()'
in_run_cpp 'render.method == RenderSettings::Method::kSampled' Method::kSampled
in_run_cpp 'render.method == RenderMethod::kDirect' RenderMethod::kDirect
in_run_cpp 'is_direct(scene)' is_direct
in_run_cpp 'frames.method == "paths"' 'method == "paths"'
in_run_cpp 'std::holds_alternative<EnvironmentSettings>(light.settings)' 'holds_alternative<EnvironmentSettings>'
in_run_cpp 'std::is_same_v<Light, IesLightSettings>' 'is_same_v<Light, IesLightSettings>'
in_run_cpp 'path_view_of(scene, part) != nullptr' path_view_of
in_run_cpp 'rung.level == "blurred"' '.level =='
in_run_cpp 'compared_methods(scene).empty()' 'compared_methods(scene).empty()'
in_run_cpp 'compared_paths(scene).size() > 1' 'compared_paths(scene).size()'
in_run_cpp 'point.method.follows_paths' follows_paths
in_run_cpp '!is_surrounding(light.settings)' is_surrounding
in_run_cpp 'lights.first_tunnel_group >= 0' first_tunnel_group
in_run_cpp 'body.name == study.scene.tunnel_name' '== study.scene.tunnel_name'
in_run_cpp 'scene.tunnel_name != name' 'tunnel_name !='
in_script() { # code, what it asks
  clean_tree
  write cli/web/page.js "const isSo = $1;"
  expect_found "cli/web/page.js:2: asks $2: how a scene is rendered is asked in "
}
in_script "data.reference?.method === 'paths'" "method === 'paths'"
in_script "'sampled' !== point.method" "'sampled' !== point.method"
in_script 'kLooks[point.method]' '[point.method]'
in_script "family.name.startsWith('paths')" "startsWith('paths"
clean_tree
write cli/web/page.js "// method === 'paths'" 'const isSo = reference.is_noisy && row.method === other.method;'
expect_clean "noise and the same method in a script" "rooms: no violation"
clean_tree
add cli/run.cpp '// needs_paths() is asked elsewhere'
expect_clean "a question in a comment" "rooms: no violation"
clean_tree
write studies/definition/scene.h '#pragma once' 'inline bool is_lit = scene.has_tunnel;'
library studies/definition 'studies::definition HEADERS scene.h'
edit CONTRIBUTING.md '/`cli/i | `studies/` | - | studies | - |'
edit CONTRIBUTING.md '/`cli/i | `studies/definition/` | `glint::studies::definition` | scenes | - |'
expect_clean "a question in its room" "rooms: no violation"

# --- Types ----------------------------------------------------------------------------------------
two_types() { # of the first room, of the second one
  clean_tree
  add core/error.h "$1"
  write metrics/twin.h '#pragma once' "$2"
  edit metrics/CMakeLists.txt 's/HEADERS/HEADERS twin.h/'
}
two_types 'namespace glint { }
namespace glint {
struct Twin {' 'namespace glint {
enum class Twin {'
expect_found "defines glint::Twin, as core/error.h:"
two_types 'namespace glint {
struct Twin;' 'namespace glint {
struct Twin {'
expect_clean "a type that is announced" "rooms: no violation"
two_types 'namespace glint::one {
struct Twin {' 'namespace glint::two {
struct Twin {'
expect_clean "types of two namespaces" "rooms: no violation"

# --- Sizes ----------------------------------------------------------------------------------------
for room in tests/core tests/bench; do
  clean_tree
  for ((i = 0; i < 19; ++i)); do
    write "$room/a$i.cpp" 'void f() {}'
  done
  rm -f "$tree/tests/core/error_test.cpp"
  expect_found "$room: holds 19 .cpp files, at most 18 are allowed"
done
clean_tree
for ((i = 0; i < 17; ++i)); do
  write "metrics/a$i.cpp" 'static void f() {}'
  edit metrics/CMakeLists.txt "s/PUBLIC/SOURCES a$i.cpp PUBLIC/"
done
expect_clean "a room of 17 files" "rooms: no violation"
for i in 17 18; do
  write "metrics/a$i.cpp" 'static void f() {}'
  edit metrics/CMakeLists.txt "s/PUBLIC/SOURCES a$i.cpp PUBLIC/"
done
expect_found "metrics: holds 19 .cpp files, at most 18 are allowed"

if ((failures > 0)); then
  echo "$failures violation(s) slipped through"
  exit 1
fi
echo "every violation is found"
