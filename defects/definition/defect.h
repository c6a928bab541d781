// SPDX-License-Identifier: GPL-3.0-or-later
//
// One defect with every number drawn: the metadata of a defective part, and what the realisations
// (height feature, displaced mesh, imprint, stain) are made from. Scene frame.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "defects/definition/defect_settings.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

struct Defect {
  std::string label;       ///< "<group>_<number from 1>"
  std::string group;       ///< name of its table
  std::int32_t id = 0;     ///< from 1 in the order of the file; the label of its faces
  int number = 0;          ///< within the group, from 0
  int attempt = 0;         ///< which sample this is, from 0
  std::uint64_t seed = 0;  ///< of its tool's noise; its own, whatever happens to other defects

  DefectType type = DefectType::kDent;
  Realisation realisation = Realisation::kNormal;  ///< never kAuto once drawn

  SurfacePlace place;            ///< on the smooth surface; u along a line, after the turn
  std::int32_t triangle = -1;    ///< of the part's mesh, at the place
  double off_surface_mm = 0.0;   ///< how far a fixed place was moved onto the surface
  double depth_mm = 0.0;         ///< > 0, of a bump its height
  double wanted_depth_mm = 0.0;  ///< before it was clamped to the wall
  double wall_mm = 0.0;          ///< thickness of the wall below the place; inf: none was met
  double diameter_mm = 0.0;      ///< round ones
  double length_mm = 0.0;        ///< lines
  double width_mm = 0.0;         ///< lines
  double angle_rad = 0.0;
  double tilt_rad = 0.0;
  double tilt_direction_rad = 0.0;  ///< about the normal, from u
  std::string tool;                 ///< "dent", "scratch", ...: procedural; or a file's name

  /// Half the width across and half the length of the line it is drawn along; for distances.
  double radius_mm() const { return 0.5 * (is_line(type) ? width_mm : diameter_mm); }

  double half_line_mm() const {
    return is_line(type) && length_mm > width_mm ? 0.5 * (length_mm - width_mm) : 0.0;
  }
};

}  // namespace glint
