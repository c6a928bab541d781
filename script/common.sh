# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Shared by the scripts beside it: sets `root`, the folder of the repository, and defines
# build_preset. To be sourced.

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)

# Compilers at once: one a core, but 2 GB of memory for each, as the CGAL files take.
job_count() {
  local cores available_gb
  cores=$(nproc)
  available_gb=$(awk '/^MemAvailable:/ { print int($2 / 1048576) }' /proc/meminfo)
  local by_memory=$((available_gb / 2))
  ((by_memory >= 1)) || by_memory=1
  echo $((cores < by_memory ? cores : by_memory))
}

# Keeps the lines of Ninja in a log and shows how far it is on stderr: a counter on a terminal, a
# line a minute elsewhere.
show_progress() { # name, log
  local line count shown="" last=$SECONDS
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$2"
    [[ $line =~ ^\[([0-9]+/[0-9]+)\] ]] || continue
    count=${BASH_REMATCH[1]}
    if [[ -t 2 ]]; then
      printf '\r\033[Kbuilding %s: %s' "$1" "$count" >&2
      shown=yes
    elif ((SECONDS - last >= 60)); then
      echo "building $1: $count" >&2
      last=$SECONDS
    fi
  done
  if [[ -n $shown ]]; then
    printf '\r\033[K' >&2
  fi
}

# Configures if need be and builds; quick and silent when nothing changed.
build_preset() { # preset, targets...
  local preset=$1
  shift
  local folder=$root/build/$preset
  mkdir -p "$folder"
  # One build of a folder at a time; a second script waits here.
  (
    flock 9
    build_locked "$preset" "$folder" "$@"
  ) 9>"$folder/.lock"
}

build_locked() { # preset, folder, targets...
  local preset=$1 folder=$2 log=$2/build.log
  shift 2
  local -a fresh=()
  # CMake refuses a build folder that was copied or moved with its sources.
  if [[ -e $folder/CMakeCache.txt ]] &&
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
    fresh=(--fresh)
  fi
  if ((${#fresh[@]} > 0)) || [[ ! -e $folder/build.ninja ||
    $root/CMakePresets.json -nt $folder/build.ninja ]]; then
    echo "configuring $preset" >&2
    if ! cmake "${fresh[@]}" -S "$root" --preset "$preset" >"$log" 2>&1 9>&-; then
      rm -f "$folder/build.ninja"
      grep -A 12 'CMake Error' "$log" >&2 || tail -n 30 "$log" >&2
      echo "configuring $preset failed; everything is in $log" >&2
      return 4
    fi
    touch "$folder/build.ninja"
  fi
  : >"$log"
  if ! NINJA_STATUS='[%f/%t] ' ninja -C "$folder" -j "$(job_count)" "$@" 2>&1 9>&- |
    show_progress "$preset" "$log"; then
    grep -m 1 -A 40 -e '^FAILED:' "$log" >&2 || tail -n 40 "$log" >&2
    echo "building $preset failed; everything is in $log" >&2
    return 4
  fi
}
