#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: check.sh PROGRAM STUDY [--record]
#
# Runs a study of the gallery with PROGRAM, as its README does, and compares the digests of all
# files that it writes, but for those that hold times (run.json, log.txt, the database), with those
# recorded for this kind of machine in <machine>/<study>.txt: a change of a single byte is seen. Date and
# duration in a report's element of the id "when" are left out.
# Results are the same bytes for the same machine, compiler, Embree and OpenImageIO only, so each
# kind of machine has a folder of its own; without one the check is skipped (exit 77). --record
# writes it: check out the commit to compare with, build, record, go back, check. Exit 1 when a file
# differs.
# GLINT_GOLDEN_RECORDS names another folder for the records.
set -euo pipefail

program=$(readlink -f "$1")
study=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
gallery=$here/../../studies/gallery
records=${GLINT_GOLDEN_RECORDS:-$here}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$gallery" "$folder/gallery"
cd "$folder"

# Version of a library that the program is linked with, by the name of the library's file.
library_version() { # name
  local file
  file=$(ldd "$program" 2>/dev/null |
    awk -v file="^lib$1[0-9]*[.]so" '$1 ~ file { print $3; exit }') || true
  if [[ -n $file ]]; then
    readlink -f "$file" | sed 's/.*[.]so[.]//'
  else
    echo unknown
  fi
}

# Vendor, instruction set, compiler and the libraries that trace rays and write pictures: what the
# bytes depend on.
machine_kind() { # run.json
  local vendor isa compiler
  vendor=$(awk -F': ' '/^vendor_id/ { print $2; exit }' /proc/cpuinfo)
  isa=$(sed -n 's/.*"isa": "\([^"]*\)".*/\1/p' "$1" | head -n 1)
  compiler=$(sed -n 's/.*"compiler": "\([a-z]* [0-9.]*\).*/\1/p' "$1" | head -n 1)
  printf '%s %s %s embree %s oiio %s\n' "${vendor:-$(uname -m)}" "$isa" "$compiler" \
    "$(library_version embree)" "$(library_version OpenImageIO)" | tr -s ' ' '-'
}

# One line for all files of a folder whose names differ in numbers only: digest, how many, name.
digests() { # folder
  (
    cd "$1"
    find . -type f ! -name run.json ! -name log.txt ! -name 'study.sqlite*' -printf '%P\n' |
      LC_ALL=C sort | xargs -r -d '\n' sha256sum
  ) | awk '{
    name = $2
    gsub(/[0-9]+/, "*", name)
    if (!(name in count)) order[++kinds] = name
    ++count[name]
    digest[name] = digest[name] $1
  }
  END { for (i = 1; i <= kinds; ++i) print digest[order[i]], count[order[i]], order[i] }' |
    while read -r digest count name; do
      printf '%s %s %s\n' "$(sha256sum <<<"$digest" | cut -c 1-16)" "$count" "$name"
    done
}

if [[ -e gallery/$study/study.toml ]]; then
  verb=(run "gallery/$study/study.toml" --jobs 2)
elif [[ $study == gear_defects ]]; then
  verb=(imprint "gallery/$study/scene.toml" --count 5 --seed 7)
else
  verb=(render "gallery/$study/scene.toml")
fi
"$program" "${verb[@]}" --out out --threads 2 --quiet
find out -name report.html -exec sed -i 's|<span id="when">[^<]*</span>|<span id="when"></span>|' {} +

expected=$records/$(machine_kind out/run.json)/$study.txt
digests out >digests.txt
if [[ ${3:-} == --record ]]; then
  mkdir -p "${expected%/*}"
  cp digests.txt "$expected"
elif [[ ! -e $expected ]]; then
  echo "skipped: no digests are recorded for this kind of machine, $(basename "${expected%/*}")"
  exit 77
elif ! diff --unified=0 "$expected" digests.txt; then
  echo "golden: files of $study differ from those recorded"
  exit 1
fi
