// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/part.h"

namespace glint {

/// What `glint part` says about a part.
struct MeshReport {
  std::string name;
  std::string unit;                                   ///< of the file: "mm", "cm", "m", "inch"
  Eigen::Vector3d size_mm = Eigen::Vector3d::Zero();  ///< bounding box in the part frame
  double area_mm2 = 0.0;
  double volume_mm3 = 0.0;  ///< of a watertight mesh, otherwise 0
  std::size_t num_triangles = 0;
  std::size_t num_vertices = 0;
  std::size_t open_edges = 0;
  std::size_t nonmanifold_edges = 0;     ///< more than two faces
  std::size_t flipped_edges = 0;         ///< two faces turned against each other
  std::size_t degenerate_triangles = 0;  ///< no area
  bool is_watertight = false;  ///< every edge has exactly one partner that runs against it
  bool is_inside_out = false;  ///< watertight with negative volume

  /// Angle between neighbouring facets that are shaded as one smooth surface (below the crease
  /// angle), over the edges that stand for no exact surface.
  double largest_facet_angle_rad = 0.0;
  double facet_angle_95_rad = 0.0;  ///< 95 % of these edges stay below
  double smallest_slope_rad = 0.0;
  bool has_exact_surface = false;  ///< every triangle stands for an exact surface
  bool is_fine_enough = false;     ///< 95 % angle <= 0.1 smallest slope, or exact

  std::string verdict = {};                ///< one sentence about facets under fringes
  std::string action = {};                 ///< what to do about it, empty when nothing
  std::vector<std::string> warnings = {};  ///< open edges and the like

  RigidTransform scene_from_part = {};
};

/// Facets steeper than this share of the smallest slope of interest show up as defects.
inline constexpr double kFacetShare = 0.1;

/// @param smallest_slope_rad  of the defects to be seen, > 0
/// @param crease_rad          edges sharper than this are meant to be edges
MeshReport report(const Part& part, double smallest_slope_rad, double crease_rad);

}  // namespace glint
