// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/built_part.h"

#include <algorithm>
#include <limits>

#include "defects/part/defect_slope.h"
#include "studies/imaging/realisation.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Convex hull by Andrew's monotone chain, counter-clockwise.
std::vector<Vector2d> convex_hull(std::vector<Vector2d> points) {
  std::ranges::sort(points, [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Vector2d> hull;
  const auto turns_left = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()) > 0.0;
  };
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Vector2d& point : points) {
      while (hull.size() >= start + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point)) {
        hull.pop_back();
      }
      hull.push_back(point);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

BuiltPart with_bvh(Part part) {
  BuiltPart built;
  built.part = std::move(part);
  built.bvh = std::make_unique<Bvh>(built.part.mesh);
  std::vector<Vector2d> points;
  built.min_x_mm = std::numeric_limits<double>::infinity();
  built.max_x_mm = -built.min_x_mm;
  for (const Vector3d& vertex : built.part.mesh.vertices_mm) {
    points.emplace_back(vertex.y(), vertex.z());
    built.min_x_mm = std::min(built.min_x_mm, vertex.x());
    built.max_x_mm = std::max(built.max_x_mm, vertex.x());
  }
  built.outline_yz_mm = convex_hull(std::move(points));
  return built;
}

/// The clean part, with another surface.
Part with_mesh(const Part& clean, TriangleMesh mesh) {
  Part part;
  part.name = clean.name;
  part.mesh = std::move(mesh);
  part.patches = clean.patches;
  part.scene_from_part = clean.scene_from_part;
  part.box_in_part_mm = clean.box_in_part_mm;
  part.unit = clean.unit;
  part.is_from_file = clean.is_from_file;
  return part;
}

}  // namespace

BuiltPart build_part_with_bvh(const PartSettings& settings) {
  return with_bvh(build_part(settings));
}

std::vector<double> defect_slopes_rad(const BuiltDefects& part) {
  return defect_slopes_rad(part.made, part.built->part.mesh, part.clean->part, *part.clean->bvh);
}

DefectMaker defect_maker(const SceneSettings& scene,
                         const std::shared_ptr<const BuiltPart>& clean) {
  return {std::shared_ptr<const Part>(clean, &clean->part),
          std::shared_ptr<const Bvh>(clean, clean->bvh.get()),
          scene.defects,
          scene.imprint,
          scene.part.crease_rad};
}

BuiltDefects build_defects(const SceneSettings& scene,
                           std::shared_ptr<const BuiltPart> clean,
                           const DefectMaker& maker,
                           std::uint64_t seed,
                           const std::function<void(int)>& progress) {
  BuiltDefects result;
  result.made = maker.make(
      seed,
      [&](const Defect& defect, const DefectGroup& group) {
        return cheapest_realisation(defect, group, scene);
      },
      progress);
  result.built = clean;
  if (result.made.has_own_mesh()) {
    result.built = std::make_shared<const BuiltPart>(
        with_bvh(with_mesh(clean->part, std::move(result.made.mesh))));
  }
  result.clean = std::move(clean);
  result.detail = SurfaceDetail(result.made.features);
  return result;
}

}  // namespace glint
