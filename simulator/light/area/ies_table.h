// SPDX-License-Identifier: GPL-3.0-or-later
//
// Luminous intensity measured by a goniophotometer, from IES LM-63 files (1986 to 2019), type C.
//
// The vertical angle counts from straight down (from the light's axis); the horizontal angle counts
// from the length of the luminous opening, counterclockwise as seen from behind the light. Between
// the measured angles the intensity is bilinear in both. docs/theory/lights.md
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// One file. Intensities are in candela, or whatever the file says it holds instead (mW/sr).
struct IesTable {
  std::string file;                           ///< for messages
  std::vector<double> vertical_rad;           ///< rising, at least two
  std::vector<double> horizontal_rad;         ///< rising; one: the same all round; else 0 to 2 pi
  std::vector<double> intensity;              ///< by horizontal, then by vertical angle; >= 0
  bool is_absolute = false;                   ///< lumens -1: not relative to a lamp's flux
  double lumens_per_lamp = 0.0;               ///< <= 0: absolute
  bool is_round = false;                      ///< the opening is a disc or a cylinder
  Eigen::Vector3d size_mm = {0.0, 0.0, 0.0};  ///< of the opening: length (0 degrees), width, height
  /// TILT=INCLUDE: the file has factors of the lamp's output against its tilt, which at() leaves
  /// out.
  bool has_tilt = false;
  double min_tilt_factor = 1.0;
  double max_tilt_factor = 1.0;
  std::vector<std::string> keywords;  ///< lines before TILT

  /// @param direction  unit, away from the light, in its axes: z its axis, x the 0 degree plane.
  /// 0 outside the measured range.
  double at(const Eigen::Vector3d& direction) const;

  /// The integral of at() over all directions, exact.
  double flux() const;

  double highest() const;
};

}  // namespace glint
