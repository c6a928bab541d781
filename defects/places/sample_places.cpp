// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sample_places.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kAnywhere_mm = std::numeric_limits<double>::infinity();

FixedPlace seen_from_above(const Part& part,
                           const Bvh& bvh,
                           const std::string& table,
                           const DefectGroup& group,
                           std::size_t i) {
  const auto place = place_on_surface(part, bvh, group.x_mm[i], group.y_mm[i]);
  if (!place) {
    throw ConfigError(
        table,
        fmt::format(
            "place {} at x {:g} mm, y {:g} mm is beside the part; the part reaches over {:g} x "
            "{:g} mm",
            i + 1,
            group.x_mm[i],
            group.y_mm[i],
            part.box_in_part_mm.size_mm().x(),
            part.box_in_part_mm.size_mm().y()));
  }
  const auto nearest = bvh.nearest(part.mesh, place->centre_mm, kAnywhere_mm);
  GLINT_CHECK(nearest.has_value(), "a part has triangles");
  return {.point = {.point_mm = place->centre_mm,
                    .normal = place->normal,
                    .triangle = nearest->triangle}};
}

FixedPlace on_nearest_surface(const Part& part,
                              const Bvh& bvh,
                              const std::string& table,
                              const DefectGroup& group,
                              std::size_t i) {
  const Vector3d given(group.at_mm[3 * i], group.at_mm[3 * i + 1], group.at_mm[3 * i + 2]);
  const Vector3d p = part.scene_from_part * given;
  const auto nearest = bvh.nearest(part.mesh, p, kAnywhere_mm);
  GLINT_CHECK(nearest.has_value(), "a part has triangles");
  const double allowed_mm = std::max(1.0, 0.01 * part.box_in_part_mm.size_mm().norm());
  if (nearest->distance_mm > allowed_mm) {
    throw ConfigError(
        table + ".at_mm",
        fmt::format("place {} at {:g}, {:g}, {:g} mm: coordinates off the surface by {:.4g} mm; "
                    "allowed: up to {:.4g} mm",
                    i + 1,
                    given.x(),
                    given.y(),
                    given.z(),
                    nearest->distance_mm,
                    allowed_mm));
  }
  const SurfacePoint point = smooth_point(part, nearest->triangle, nearest->point_mm);
  return {.point = point, .off_mm = (point.point_mm - p).norm()};
}

}  // namespace

std::vector<FixedPlace> fixed_places(const Part& part,
                                     const Bvh& bvh,
                                     const std::string& table,
                                     const DefectGroup& group) {
  std::vector<FixedPlace> places;
  if (group.at_mm.empty()) {
    for (std::size_t i = 0; i < group.x_mm.size(); ++i) {
      places.push_back(seen_from_above(part, bvh, table, group, i));
    }
    return places;
  }
  for (std::size_t i = 0; i < group.at_mm.size() / 3; ++i) {
    places.push_back(on_nearest_surface(part, bvh, table, group, i));
  }
  return places;
}

}  // namespace glint
