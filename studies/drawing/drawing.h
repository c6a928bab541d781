// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// What is needed to draw a lighting to scale, in the part's frame: +x along the tunnel's axis,
/// +z towards the camera, origin in the part.
struct CrossSection {
  /// Luminous walls as polylines (y, z); two walls leave the slot between them.
  std::vector<std::vector<Eigen::Vector2d>> panels_yz_mm = {};
  std::vector<Eigen::Vector2d> part_yz_mm = {};  ///< the part's outline (y, z)
  Eigen::Vector3d camera_mm = {0.0, 0.0, 0.0};   ///< centre of projection; at the origin: not drawn
  double view_half_angle_rad = 0.0;              ///< in the y-z plane; 0: only the axis is drawn
  double slot_mm = 0.0;                          ///< width of the camera slot, about y = 0; 0: none
  double length_mm = 0.0;                        ///< of the lighting along x, about x = 0
  double part_length_mm = 0.0;                   ///< of the part along x; 0: not drawn
  double period_mm = 0.0;                        ///< of the fringes; 0: the walls are plain
  double duty = 0.5;                             ///< bright share of a period, in [0, 1]
  double orientation_rad = 0.0;  ///< of the fringes on the wall; 0: they change along x only
  double step_mm = 0.0;          ///< travel between two images
  int positions = 0;             ///< images of a sequence; 0: not stated
  std::string title = {};
};

/// Drawing units per mm of the cross-section (the view across the axis). 0 when there is nothing to
/// draw.
double cross_section_scale(const CrossSection& section);

/// Two views under each other, as a complete SVG document of 440 units width: the cross-section in
/// y and z with width, height above the part, overall height, slot and camera distance (broken
/// where the camera is far away), and the side elevation in x and z with the fringes, one period
/// and the length. Each view has one scale for both its axes and a scale bar. Equal input gives
/// equal bytes, in any locale. Below stand the wall's arcs with points and radii (wall_plan.h) and
/// the scale: printed at 100 %, the cross-section has a usual one on A4.
std::string cross_section_svg(const CrossSection& section);

}  // namespace glint
