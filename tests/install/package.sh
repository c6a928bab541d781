#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: package.sh BUILD_DIR WORK_DIR
#
# Packs a build as .deb and installs it with apt in a fresh Debian that mmdebstrap makes: with nothing
# but the package's own Depends the program runs a study there, and its files lie where Debian wants
# them. Exit 77 with the reason where that cannot be tried.
set -euo pipefail

build=$1
work=$2

skip() {
  echo "skipped: $*"
  exit 77
}

for program in cpack dpkg-shlibdeps dpkg-deb mmdebstrap; do
  command -v "$program" > /dev/null || skip "$program is not installed"
done
rm -rf "$work"
mkdir -p "$work"
if ! (cd "$work" && cpack -G DEB --config "$build/CPackConfig.cmake" -B "$work") > "$work/cpack.log" 2>&1; then
  tail -20 "$work/cpack.log"
  exit 1
fi
package=$(find "$work" -maxdepth 1 -name 'glint_*.deb')
depends=$(dpkg-deb -f "$package" Depends)
grep -q libembree <<< "$depends" || { echo "Depends lacks Embree: $depends"; exit 1; }

cat > "$work/study.toml" <<'STUDY'
[part]
shape = "strip"
[camera]
width_px = 60
height_px = 20
[scan]
positions = 4
[lighting.tunnel]
radius_mm = 80
STUDY
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
made=true
mmdebstrap --variant=apt --mode=auto \
  --customize-hook="copy-in $package $work/study.toml /tmp" \
  --customize-hook='chroot "$1" apt-get install --yes --no-install-recommends /tmp/'"$(basename "$package")" \
  --customize-hook='chroot "$1" sh -c "cd /tmp && glint --version && glint run study.toml --out run"' \
  --customize-hook='chroot "$1" test -e /tmp/run/report.html' \
  --customize-hook='chroot "$1" test -e /usr/share/zsh/vendor-completions/_glint' \
  --customize-hook='chroot "$1" test -e /usr/share/glint/study.schema.json' \
  --customize-hook='echo "the package works" > '"$work/works" \
  "$suite" /dev/null > "$work/mmdebstrap.log" 2>&1 || made=false
if $made && [ -e "$work/works" ]; then
  echo "$(basename "$package") installs and runs; Depends: $depends"
  exit 0
fi
if grep -qE 'E: (unable to|cannot|failed to) (unshare|mount|mknod)|Operation not permitted|not permitted' \
  "$work/mmdebstrap.log" && ! grep -q 'Setting up glint' "$work/mmdebstrap.log"; then
  skip "a root is not permitted here: $(tail -1 "$work/mmdebstrap.log")"
fi
if grep -qE 'Temporary failure resolving|Could not resolve|Failed to fetch' "$work/mmdebstrap.log"; then
  skip "no network: $(tail -1 "$work/mmdebstrap.log")"
fi
tail -30 "$work/mmdebstrap.log"
exit 1
