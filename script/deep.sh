# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# The parts of `script/test --deep`: what is checked more rarely than at each commit, because it
# takes hours. To be sourced after common.sh. A part is a function deep_<name>; each is meant to
# stay below 40 minutes on two cores, so that one can be run at a time; the first part of a sanitizer
# builds everything for it besides.

# part, what it does
deep_parts='
clang          the fast tests, built by clang
release        the release build of program and benchmarks
asan           the fast tests but those of studies and cli, under AddressSanitizer and UBSan
asan_studies   those of studies, but the next two, under AddressSanitizer and UBSan
asan_runs      those of whole runs: run, validate, calibrate, population, frontier
asan_gallery   those of the gallery
asan_cli       those of cli
tsan           tests of core and optimizer under ThreadSanitizer
tsan_studies   tests of studies, but the next two, under ThreadSanitizer
tsan_runs      those of whole runs: run, validate, calibrate, population, frontier
tsan_gallery   those of the gallery
tsan_hardware  tests of hardware under ThreadSanitizer
tidy_core      clang-tidy on core, metrics, optimizer, defects and cli
tidy_simulator clang-tidy on simulator
tidy_studies   clang-tidy on studies
tidy_hardware  clang-tidy on hardware
tidy_tests     clang-tidy on tests
fuzz           each fuzzer for a minute
optuna         Optuna opens exported runs, with its importances and plots; left out with a word where it cannot be installed
slow           tests labelled slow, but those below
slow_loop      the loop of robot_cell in small pictures, and the hand-eye of three cells in whole ones
slow_docs      the commands of the pages, predicted costs, the package
slow_search    the searches of the gallery again, from their study files
slow_golden    every file that the studies of the gallery write, against its digest
slow_changes   two hundred known changes that glint compare names, and twenty of roughness; goes on where it was when it is run again
slow_stranger  eleven parts that no study was made for: glint new, glint run, the verdict
'

list_deep_parts() {
  printf '%-15s %-7s %s\n' part minutes 'what it does'
  printf '%s\n' "$deep_parts" | while read -r name text; do
    [[ -z $name ]] || printf '%-15s %-7s %s\n' "$name" "$(last_minutes "$name")" "$text"
  done
}

# How long a part took when it last passed on this machine, as report_part() wrote it down; "-": it
# never did.
last_minutes() { # part
  local told=$root/build/deep/parts.txt minutes=-
  [[ ! -f $told ]] || minutes=$(awk -v part="$1" '$2 == part && $5 == "passed" { last = $3 } END { print last == "" ? "-" : last }' "$told")
  echo "$minutes"
}

# ctest on a preset's folder, two tests at once.
run_tests() { # preset, options of ctest
  local preset=$1 jobs
  shift
  jobs=$(job_count)
  GTEST_BRIEF=1 ctest --test-dir "$root/build/$preset" --output-on-failure --no-tests=error \
    -j "$((jobs < 2 ? jobs : 2))" "$@"
}

# Tests of whole runs: more work under a sanitizer than all others of studies together.
whole_runs='^studies_(run|validate|calibrate|population|frontier)$'

# Tests that look at files and text alone, or run other programs than ours.
outside='^(layering|bench_against|golden)'

# `&&` throughout: bash forgets `set -e` in what a condition calls.
deep_clang() {
  "$root/script/bootstrap" --fuzz && build_preset clang && run_tests clang -LE slow
}

# What users build: at -O3 the compiler warns of other things than in the tests' build.
deep_release() {
  build_preset release && build_preset bench
}

run_under_asan() { # options of ctest
  "$root/script/bootstrap" --fuzz && build_preset asan || return
  LSAN_OPTIONS="suppressions=$root/tests/support/lsan_suppressions.txt" \
    run_tests asan -LE slow "$@"
}

deep_asan() { run_under_asan -E "$outside|^(studies|cli)"; }
deep_asan_studies() { run_under_asan -R '^studies' -E "$whole_runs|^studies_gallery\$"; }
deep_asan_runs() { run_under_asan -R "$whole_runs"; }
deep_asan_gallery() { run_under_asan -R '^studies_gallery$'; }
deep_asan_cli() { run_under_asan -R '^cli'; }

# Without the search for deadlocks: what libraries lock in inlined code and unlock in their own, which
# is passed over, counts as held until 64 locks are too many.
run_under_tsan() { # options of ctest
  "$root/script/bootstrap" --fuzz && build_preset tsan || return
  TSAN_OPTIONS="suppressions=$root/tests/support/tsan_suppressions.txt halt_on_error=1 detect_deadlocks=0" \
    run_tests tsan -LE slow "$@"
}

deep_tsan() { run_under_tsan -R '^(core|optimizer)'; }
deep_tsan_studies() { run_under_tsan -R '^studies' -E "$whole_runs|^studies_gallery\$"; }
deep_tsan_runs() { run_under_tsan -R "$whole_runs"; }
deep_tsan_gallery() { run_under_tsan -R '^studies_gallery$'; }

# Not the camera's twin: pictures of five million pixels do not come within the product's deadlines
# where every access takes ten times as long.
deep_tsan_hardware() { run_under_tsan -R '^hardware' -E '^hardware_camera_twin$'; }

deep_tidy_core() { tidy_folders core metrics optimizer defects cli; }
deep_tidy_simulator() { tidy_folders simulator; }
deep_tidy_studies() { tidy_folders studies; }
deep_tidy_hardware() { tidy_folders hardware; }
deep_tidy_tests() { tidy_folders tests; }

tidy_folders() { "$root/script/lint" --tidy "$@"; }

deep_fuzz() {
  "$root/script/bootstrap" --fuzz && build_preset fuzz || return
  local program name status=0
  for program in "$root"/build/fuzz/tests/fuzz/fuzz_*; do
    name=${program##*/fuzz_}
    [[ -x $program && -f $program ]] || continue
    fuzz_for_a_minute "$program" "$name" || status=1
  done
  return "$status"
}

# Begins with what users write: a fuzzer that starts from nothing never gets past the first line.
fuzz_for_a_minute() { # program, name
  local -a seeds=()
  case $2 in
    toml) seeds=("$root/studies/gallery/tunnel_shape" "$root/studies/gallery/gear_ring") ;;
    mesh) seeds=("$root/../shared/data/meshes") ;;
    ies) seeds=("$root/../shared/data/field/ies") ;;
    nk) seeds=("$root/../shared/data/field/nk") ;;
    pose) seeds=("$root/../shared/data/field/handeye_franka") ;;
    robot) seeds=("$root/tests/fuzz/corpus/robot") ;;
  esac
  local corpus=$root/build/fuzz/corpus_$2 seed
  local -a folders=("$corpus")
  mkdir -p "$corpus"
  for seed in "${seeds[@]}"; do
    [[ ! -d $seed ]] || folders+=("$seed")
  done
  # OpenImageIO keeps its messages for as long as the program runs.
  local leaks=1
  [[ $2 != picture ]] || leaks=0
  echo "fuzzing $2" >&2
  ASAN_OPTIONS=detect_leaks=$leaks "$1" -max_total_time=60 -max_len=4000 -verbosity=0 \
    -artifact_prefix="$root/build/fuzz/$2-" "${folders[@]}"
}

# A machine without network or rights may lack Optuna; that is said, and is no fault of Glint.
deep_optuna() {
  if ! "$root/script/bootstrap" --peers || ! /usr/bin/python3 -c 'import optuna, sklearn'; then
    echo "left out: python3-optuna and python3-sklearn are missing and cannot be installed" >&2
    return 0
  fi
  /usr/bin/python3 -c 'import plotly' || echo "left out: Optuna's plots, python3-plotly is missing" >&2
  build_preset dev && run_tests dev -R '^studies_export$'
}

loop_tests='^loop_(robot_cell|hand_eye_seeds)$'
docs_tests='^(docs_commands_.*|predicted_costs|package)$'
changes_tests='^cli_compare_changes$'
search_tests='^gallery_search$'
golden_tests='^golden'
stranger_tests='^stranger'

deep_slow() {
  build_preset dev &&
    run_tests dev -L slow -E "$loop_tests|$docs_tests|$changes_tests|$search_tests|$golden_tests|$stranger_tests"
}

deep_slow_loop() {
  build_preset dev && run_tests dev -L slow -R "$loop_tests"
}

deep_slow_docs() {
  build_preset dev && run_tests dev -L slow -R "$docs_tests"
}

deep_slow_search() {
  build_preset dev && run_tests dev -L slow -R "$search_tests"
}

deep_slow_golden() {
  local told=$root/build/deep/slow_golden_tests.txt
  build_preset dev && run_tests dev -R "$golden_tests" | tee "$told" && has_compared_files "$told"
}

# Studies are skipped on a kind of machine that no digests are recorded for: then nothing is shown.
has_compared_files() { # what ctest printed
  awk '/ golden_/ && !/ golden_negative_control / && / Passed / { found = 1 } END { exit !found }' "$1" && return
  echo "nothing compared: no digests are recorded for this kind of machine (tests/golden/check.sh --record)" >&2
  return 1
}

# What the rows of slow_changes depend on: the program, its libraries, the test and the pictures' width.
changes_key() { # build folder
  (
    cd "$1" || exit
    find . -type f \( -name 'libglint*.so*' -o -path ./glint -o -path ./tests/cli/test_cli_compare_changes \) -print0 |
      LC_ALL=C sort -z | xargs -0 sha256sum
    echo "${GLINT_COMPARE_WIDTH:-}"
  ) | sha256sum | cut -c1-16
}

# Cases take hours: at most 35 minutes of them at a time, what was said of each is kept for this build.
deep_slow_changes() {
  build_preset dev || return
  local cases=200 rough=20 state status=0
  state=$root/build/deep/changes_$(changes_key "$root/build/dev").jsonl
  GLINT_COMPARE_CASES=$cases GLINT_COMPARE_ROUGH_CASES=$rough GLINT_COMPARE_BUDGET_S=2100 GLINT_COMPARE_STATE=$state \
    "$root/build/dev/tests/cli/test_cli_compare_changes" --gtest_filter=KnownChanges.AreNamedWithHonestSigmas || status=1
  if (($(wc -l <"$state") < cases + rough)); then
    echo "$(wc -l <"$state") of $((cases + rough)) cases are done: run slow_changes again" >&2
    return 1
  fi
  return "$status"
}

deep_slow_stranger() {
  build_preset dev && run_tests dev -L slow -R "$stranger_tests"
}

# Runs the named parts, all without a name, and says of each how it ended and how long it took.
run_deep() { # parts...
  local -a known parts failed=()
  mapfile -t known < <(printf '%s\n' "$deep_parts" | awk 'NF { print $1 }')
  parts=("$@")
  (($# > 0)) || parts=("${known[@]}")
  local part begin log
  for part in "${parts[@]}"; do
    if [[ " ${known[*]} " != *" $part "* ]]; then
      echo "test: no part $part, allowed are ${known[*]}" >&2
      return 2
    fi
  done
  mkdir -p "$root/build/deep"
  for part in "${parts[@]}"; do
    begin=$SECONDS
    log=$root/build/deep/$part.log
    echo "deep: $part" >&2
    if "deep_$part" 2>&1 | tee "$log"; then
      report_part "$part" passed "$begin"
    else
      report_part "$part" "FAILED, see build/deep/$part.log" "$begin"
      failed+=("$part")
    fi
  done
  ((${#failed[@]} == 0))
}

report_part() { # part, how it ended, when it began
  awk -v part="$1" -v how="$2" -v s="$((SECONDS - $3))" \
    'BEGIN { printf "deep: %-15s %6.1f min  %s\n", part, s / 60, how }' | tee -a "$root/build/deep/parts.txt" >&2
}
