// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/part/part.h"

namespace glint {

/// A part's surface in small triangles, each with one point that stands for its area.
struct SurfaceCells {
  TriangleMesh mesh;                               ///< one triangle a cell; no shading normals
  std::vector<std::int32_t> triangle;              ///< of the part
  std::vector<Eigen::Vector3d> points_mm;          ///< anywhere in their cell, evenly
  std::vector<Eigen::Vector3d> normals;            ///< unit, of the smooth surface there
  std::vector<double> areas_mm2;                   ///< their sum is the part's area
  std::vector<std::array<std::int32_t, 2>> links;  ///< cells with an edge in common

  std::size_t size() const { return points_mm.size(); }
};

/// Cuts the part's triangles across their longest edges until there are about `count` cells of
/// about the same size; triangles that are smaller stay whole. Cells near to each other have
/// numbers near to each other. A sum over points weighted by areas has no bias: each point lies
/// anywhere in its cell with the same probability.
/// @param count  > 0
/// @param seed   of where in their cells points lie
SurfaceCells surface_cells(const Part& part, int count, int seed);

}  // namespace glint
