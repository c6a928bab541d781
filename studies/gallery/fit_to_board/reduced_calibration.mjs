// SPDX-License-Identifier: GPL-3.0-or-later
//
// calibration.toml for a camera whose pixels are larger by a factor along both sides.

const lengthsPx = 4; // of the nine intrinsics: focal lengths and centre, then five without a unit
const intrinsics = 9;

/// Distances from the corner of the picture shrink, and their covariances twice or once.
/// @param text    of a calibration.toml @param factor  pixels of the photograph to one, along a side
export function reducedCalibration(text, factor) {
  const unit = (i) => (i < lengthsPx ? 1 / factor : 1);
  const rows = [...Array(intrinsics).keys()];
  const triangle = rows.flatMap((row) => rows.slice(0, row + 1).map((col) => unit(row) * unit(col)));
  const scales = { intrinsics: (i) => triangle[i], cross: (i) => unit(i % intrinsics) };
  return text
    .replace(/^((?:width|height|focal_x|focal_y|center_x|center_y)_px = )(\S+)$/gm, (_, key, value) => key + value / factor)
    .replace(/^(intrinsics|cross) = \[(.*)\]$/gm, (_, key, list) =>
      `${key} = [${list.split(",").map((value, i) => Number(value) * scales[key](i)).join(", ")}]`,
    );
}
