// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sample_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"
#include "core/pose.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kAnywhere_mm = std::numeric_limits<double>::infinity();

/// Never -0.
double in_hundredths(double value) {
  return std::round(100.0 * value) / 100.0 + 0.0;
}

/// "; x 19.2 mm, y 1 mm is on it": the place seen from above that is nearest, some way inwards of
/// the edge; empty where none is found.
std::string place_nearby(const Part& part, const Bvh& bvh, double x_mm, double y_mm) {
  constexpr double kInwards = 0.02;  // of the part's diagonal
  const Vector3d given(x_mm, y_mm, part.box_in_part_mm.max_mm.z());
  const auto nearest = bvh.nearest(part.mesh, part.scene_from_part * given, kAnywhere_mm);
  if (!nearest) {
    return "";
  }
  const Vector3d there = inverse(part.scene_from_part) * nearest->point_mm;
  const Eigen::Vector2d way = (there - given).head<2>();
  const double inwards_mm = kInwards * part.box_in_part_mm.size_mm().head<2>().norm();
  const Eigen::Vector2d at = there.head<2>() + inwards_mm * way.normalized();
  const double at_x_mm = in_hundredths(at.x());
  const double at_y_mm = in_hundredths(at.y());
  return place_on_surface(part, bvh, at_x_mm, at_y_mm)
             ? fmt::format("; x {:g} mm, y {:g} mm is on it", at_x_mm, at_y_mm)
             : std::string();
}

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
            "{:g} mm{}",
            i + 1,
            group.x_mm[i],
            group.y_mm[i],
            part.box_in_part_mm.size_mm().x(),
            part.box_in_part_mm.size_mm().y(),
            place_nearby(part, bvh, group.x_mm[i], group.y_mm[i])));
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
