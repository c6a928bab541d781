// SPDX-License-Identifier: GPL-3.0-or-later
//
// Facets of a defect by their angle to the flawless surface below them, sorted, and the angle that
// 99 % of the area stay under: a quantile, since the steepest facet of a mesh says little.
// docs/theory/imprint.md, "Slope".
#include "defects/part/defect_slope.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/units.h"
#include "defects/surface/surface_normals.h"
#include "simulator/geometry/surface/surface_sampling.h"

namespace glint {
namespace {

using Eigen::Vector3d;

struct Facet {
  double angle_rad = 0.0;
  double area_mm2 = 0.0;
};

/// The normal of the flawless surface that a facet of a defect took the place of. On an exact
/// surface the one that the defect lies in, also beyond its edges; else the nearest, but of round
/// defects none beyond a sharp edge or on the other side of a thin wall.
Vector3d flawless_normal(const Defect& defect,
                         const Part& clean,
                         const Bvh& bvh,
                         const Vector3d& at_mm) {
  const std::int32_t patch = clean.mesh.patch_of(static_cast<std::size_t>(defect.triangle));
  if (patch >= 0) {
    const auto normal = exact_normal(clean.patches[static_cast<std::size_t>(patch)], at_mm);
    return normal.value_or(defect.place.normal);
  }
  const auto nearest = bvh.nearest(clean.mesh, at_mm, std::numeric_limits<double>::infinity());
  GLINT_CHECK(nearest.has_value(), "a part has triangles");
  const Vector3d normal = smooth_point(clean, nearest->triangle, nearest->point_mm).normal;
  const bool is_elsewhere = normal.dot(defect.place.normal) < std::cos(kSharpBend_rad);
  return is_elsewhere && !is_line(defect.type) ? defect.place.normal : normal;
}

double slope_of(std::vector<Facet> facets) {
  std::ranges::sort(facets, {}, &Facet::angle_rad);
  double area_mm2 = 0.0;
  for (const Facet& facet : facets) {
    area_mm2 += facet.area_mm2;
  }
  double flatter_mm2 = 0.0;
  for (const Facet& facet : facets) {
    flatter_mm2 += facet.area_mm2;
    if (flatter_mm2 >= kSlopeShare * area_mm2) {
      return std::min(facet.angle_rad, 0.5 * kPi);
    }
  }
  return 0.0;
}

}  // namespace

std::vector<double> defect_slopes_rad(const DefectivePart& made,
                                      const TriangleMesh& mesh,
                                      const Part& clean,
                                      const Bvh& bvh) {
  std::vector<std::vector<Facet>> facets(made.defects.size());
  for (std::size_t i = 0; i < made.labels.size(); ++i) {
    if (made.labels[i] <= 0) {
      continue;
    }
    const auto number = static_cast<std::size_t>(made.labels[i] - 1);  // ids count from 1
    const Vector3d area = area_vector(mesh, i);
    const Vector3d centre = (mesh.vertex(i, 0) + mesh.vertex(i, 1) + mesh.vertex(i, 2)) / 3.0;
    const Vector3d normal = flawless_normal(made.defects[number].defect, clean, bvh, centre);
    facets[number].push_back({.angle_rad = std::atan2(area.cross(normal).norm(), area.dot(normal)),
                              .area_mm2 = area.norm()});
  }
  std::vector<double> slopes;
  std::ranges::transform(facets, std::back_inserter(slopes), slope_of);
  for (const HeightFeature& feature : made.features) {
    slopes[static_cast<std::size_t>(feature.id - 1)] = std::atan(feature.max_slope_rad());
  }
  return slopes;
}

}  // namespace glint
