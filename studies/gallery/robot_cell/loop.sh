#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: loop.sh [OUT]   the whole loop on twins: calibrate, run, acquire, validate; default out/cell
#
# GLINT names the program, else build/release/glint; WIDTH=306 makes pictures a quarter as wide,
# SAMPLES=64 renders with so many samples a pixel, on both sides; TARGET_PX is how well a point must
# be known for the calibration to end, which in pictures of 1224 pixels and more is also to know the
# hand-eye to 0.04 mm and 0.012 degree; SPEEDUP=40 lets the arm's twin move so many times as fast;
# DESIGNS="ring dome" tries these alone on the robot; SEED=8 draws other errors of the arm and of the
# pictures; CALIBRATE_ONLY=1 ends after the calibration.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
out=${1:-out/cell}
glint=${GLINT:-$here/../../../build/release/glint}
mkdir -p "$out"
out=$(cd "$out" && pwd)
ready=$out/twins.json
designs=${DESIGNS:-ring dome tunnel}

twins_down() { [[ ! -e $ready ]] || "$glint" cell twin stop "$ready" >/dev/null 2>&1 || true; }
trap twins_down EXIT

# Smaller pictures show the same: fewer and larger pixels.
resize=""
if [[ -n ${WIDTH:-} && $WIDTH != 1224 ]]; then
  height=$((WIDTH * 1025 / 1224))
  pixel_um=$(awk "BEGIN { print 6.9 * 1224 / $WIDTH }")
  object_mm=$(awk "BEGIN { print 0.05 * 1224 / $WIDTH }")
  resize=$(printf '\n[camera]\nwidth_px = %d\nheight_px = %d\npixel_um = %s\nobject_pixel_mm = %s\n' \
    "$WIDTH" "$height" "$pixel_um" "$object_mm")
fi

if [[ -n ${SAMPLES:-} ]]; then
  resize+=$(printf '\n[render.paths]\nsamples = %d\n' "$SAMPLES")
fi

# Only the truth has a seed: it is of what nobody knows.
truth=$resize
if [[ -n ${SEED:-} ]]; then
  truth+=$(printf '\n[truth]\nseed = %d\n' "$SEED")
fi

# A cell whose camera sees the truth, or the board where the part will lie.
cell_of() {  # NAME CALIBRATION TRUTH-FILES...
  local name=$1 calibration=$2 includes=""
  shift 2
  for file in "$@"; do includes+="\"$file\", "; done
  printf 'schema = 2\ninclude = [%s]\n%s\n' "${includes%, }" "$truth" >"$out/truth_$name.toml"
  printf 'include = ["%s"]\n[calibration]\nfile = "%s"\n[twin]\ntruth = "truth_%s.toml"\nmotion_speedup = %s\n' \
    "$here/cell.toml" "$calibration" "$name" "${SPEEDUP:-10}" >"$out/cell_$name.toml"
}

"$glint" calibrate --print_board "$here/board.toml" --out "$out/board"
cell_of board "$here/drawing.toml" "$here/hidden.toml" "$out/board/board_part.toml"
cell_of part "$out/calibrate/calibration/calibration.toml" "$here/truth.toml"
printf 'schema = 2\ninclude = ["%s"]\n%s\n' "$here/study.toml" "$resize" >"$out/study.toml"

# 1. The camera's lens and its place on the flange.
"$glint" cell twin both "$out/cell_board.toml" --port 0 --detach --ready_file "$ready"
hand_eye=()
if ((${WIDTH:-1224} >= 1224)); then hand_eye=(--target_mm 0.04 --target_deg 0.012 --max_rounds 8); fi
status=0
"$glint" calibrate --cell "$out/cell_board.toml" --twin "$ready" --board "$here/board.toml" \
  --target_px "${TARGET_PX:-0.3}" "${hand_eye[@]}" --out "$out/calibrate" --move || status=$?
if [[ $status -eq 1 && -e $out/calibrate/calibration/calibration.toml ]]; then
  echo "going on with this calibration"
elif [[ $status -ne 0 ]]; then
  exit "$status"  # no calibration at all
fi
twins_down
[[ -z ${CALIBRATE_ONLY:-} ]] || exit 0

# 2. The study: which of the three designs is best in simulation?
"$glint" run "$out/study.toml" --out "$out/run"

# 3. Real pictures of each design.
"$glint" cell twin both "$out/cell_part.toml" --port 0 --detach --ready_file "$ready"
for design in $designs; do
  "$glint" acquire "$out/run/$design/scene.toml" --cell "$out/cell_part.toml" --twin "$ready" \
    --out "$out/acquired/$design" --move
done
twins_down

# 4. Do both sides agree?
"$glint" validate "$out/run" --pictures "$out/acquired" \
  --designs "${designs// /,}" --refit --out "$out/validate"
