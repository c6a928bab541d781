// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sample_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "core/error.h"
#include "core/pose.h"
#include "simulator/geometry/mesh_file/mesh_io.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Kind = DefectRegion::Kind;

/// What rounding may put a point out of a box that ends on the surface.
constexpr double kSlack_mm = 1e-6;

/// The box of the region, or around its sphere, in the part frame.
BoundingBox box_of(const DefectRegion& region) {
  const Vector3d slack = Vector3d::Constant(kSlack_mm);
  if (region.kind == Kind::kBox) {
    return {.min_mm = vector_of(region.min_mm) - slack, .max_mm = vector_of(region.max_mm) + slack};
  }
  const Vector3d reach = Vector3d::Constant(region.radius_mm) + slack;
  const Vector3d centre = vector_of(region.centre_mm);
  return {.min_mm = centre - reach, .max_mm = centre + reach};
}

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// False when none of the triangle's smooth normals can look that way: between its corners they
/// lie within the largest angle of a corner to the facet.
bool may_face(const Part& part, std::size_t triangle, double facing_rad) {
  if (facing_rad >= kPi) {
    return true;
  }
  const Vector3d facet = face_normal(part.mesh, triangle);
  double spread_rad = 0.0;
  if (!part.mesh.corner_normals.empty()) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      spread_rad = std::max(spread_rad, angle_between(facet, part.mesh.normal(triangle, corner)));
    }
  }
  const Vector3d up = part.scene_from_part.rotation.col(2);
  return angle_between(facet, up) <= facing_rad + spread_rad + 1e-9;
}

std::vector<std::int32_t> facing_triangles(const Part& part, double facing_rad) {
  std::vector<std::int32_t> triangles;
  for (std::size_t i = 0; i < part.mesh.num_triangles(); ++i) {
    if (may_face(part, i, facing_rad)) {
      triangles.push_back(static_cast<std::int32_t>(i));
    }
  }
  return triangles;
}

std::vector<std::array<std::uint8_t, 3>> painted_colours(const std::string& table,
                                                         const std::filesystem::path& file) {
  try {
    return read_face_colours(file);
  } catch (const ConfigError& error) {
    throw ConfigError(table + ".region_file", error.what());
  }
}

void keep_painted(const std::string& table,
                  const DefectRegion& region,
                  std::size_t num_triangles,
                  std::vector<std::int32_t>& triangles) {
  const auto colours = painted_colours(table, region.file);
  if (colours.size() != num_triangles) {
    throw ConfigError(table + ".region_file",
                      fmt::format("{} has {} triangles and the part has {}; allowed: the part's "
                                  "own triangles",
                                  region.file.string(),
                                  colours.size(),
                                  num_triangles));
  }
  std::erase_if(triangles, [&](std::int32_t i) {
    const auto& [red, green, blue] = colours[static_cast<std::size_t>(i)];
    return red == 0 && green == 0 && blue == 0;
  });
  if (triangles.empty()) {
    throw ConfigError(
        table + ".region_file",
        fmt::format("{} allows no face: all are black, or look another way than facing_deg",
                    region.file.string()));
  }
}

/// A half-space normal . p <= offset.
struct HalfSpace {
  Vector3d normal;
  double offset_mm = 0.0;

  double outside_mm(const Vector3d& p) const { return normal.dot(p) - offset_mm; }
};

/// The sides of a box of the part frame, in the scene frame.
std::vector<HalfSpace> sides_of(const BoundingBox& box, const RigidTransform& scene_from_part) {
  std::vector<HalfSpace> sides;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Vector3d normal = scene_from_part.rotation.col(axis);
    const double origin_mm = normal.dot(scene_from_part.translation_mm);
    sides.push_back({.normal = normal, .offset_mm = box.max_mm[axis] + origin_mm});
    sides.push_back({.normal = -normal, .offset_mm = -box.min_mm[axis] - origin_mm});
  }
  return sides;
}

/// Cuts a convex polygon with a half-space.
/// Source: I. Sutherland and G. Hodgman, "Reentrant polygon clipping", Communications of the ACM
/// 17(1), 1974.
std::vector<Vector3d> cut(const std::vector<Vector3d>& polygon, const HalfSpace& side) {
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d& a = polygon[i];
    const Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double out_a = side.outside_mm(a);
    const double out_b = side.outside_mm(b);
    if (out_a <= 0.0) {
      kept.push_back(a);
    }
    if ((out_a < 0.0 && out_b > 0.0) || (out_a > 0.0 && out_b < 0.0)) {
      kept.emplace_back(a + out_a / (out_a - out_b) * (b - a));
    }
  }
  return kept;
}

/// What of some triangles lies between the sides of a box.
struct CutTriangles {
  std::vector<SurfacePiece> pieces;
  std::vector<std::int32_t> triangles;  ///< that the pieces are of, each once
  bool is_any_cut = false;              ///< else the pieces are the triangles
};

CutTriangles cut_triangles(const TriangleMesh& mesh,
                           const std::vector<std::int32_t>& triangles,
                           const std::vector<HalfSpace>& sides) {
  CutTriangles result;
  for (const std::int32_t triangle : triangles) {
    const auto i = static_cast<std::size_t>(triangle);
    std::vector<Vector3d> polygon = {mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2)};
    for (const HalfSpace& side : sides) {
      if (std::ranges::any_of(polygon,
                              [&](const Vector3d& p) { return side.outside_mm(p) > 0.0; })) {
        polygon = cut(polygon, side);
        result.is_any_cut = result.is_any_cut || !polygon.empty();
      }
    }
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
      result.pieces.push_back(
          {.triangle = triangle, .corners_mm = {polygon[0], polygon[k], polygon[k + 1]}});
    }
    if (polygon.size() >= 3) {
      result.triangles.push_back(triangle);
    }
  }
  return result;
}

bool intersects_sphere(const Part& part,
                       const std::vector<std::int32_t>& triangles,
                       const DefectRegion& region) {
  const Vector3d centre = part.scene_from_part * vector_of(region.centre_mm);
  return std::ranges::any_of(triangles, [&](std::int32_t i) {
    const Vector3d p = nearest_on_triangle(part.mesh, static_cast<std::size_t>(i), centre);
    return (p - centre).norm() <= region.radius_mm;
  });
}

AreaSampler sampler_in_box(const Part& part,
                           const std::string& table,
                           const DefectRegion& region,
                           const std::vector<std::int32_t>& triangles) {
  CutTriangles inside =
      cut_triangles(part.mesh, triangles, sides_of(box_of(region), part.scene_from_part));
  const bool is_sphere = region.kind == Kind::kSphere;
  AreaSampler sampler = inside.is_any_cut ? AreaSampler(std::move(inside.pieces))
                                          : AreaSampler(part.mesh, inside.triangles);
  if (!(sampler.area_mm2() > 0.0) ||
      (is_sphere && !intersects_sphere(part, inside.triangles, region))) {
    throw ConfigError(
        table + (is_sphere ? ".region_centre_mm" : ".region_min_mm"),
        fmt::format("no face of the part lies in the {}", is_sphere ? "sphere" : "box"));
  }
  return sampler;
}

}  // namespace

PlaceRegion::PlaceRegion(const Part& part,
                         const std::string& table,
                         const DefectRegion& region,
                         std::shared_ptr<const AreaSampler> whole)
    : region_(region), sampler_(std::move(whole)) {
  if (region.kind == Kind::kAll && region.facing_rad >= kPi) {
    return;
  }
  std::vector<std::int32_t> triangles = facing_triangles(part, region.facing_rad);
  if (triangles.empty()) {
    throw ConfigError(table + ".facing_deg", "no face of the part looks that way");
  }
  if (region.kind == Kind::kFaces) {
    keep_painted(table, region, part.mesh.num_triangles(), triangles);
  }
  const bool is_cut = region.kind == Kind::kBox || region.kind == Kind::kSphere;
  sampler_ =
      std::make_shared<const AreaSampler>(is_cut ? sampler_in_box(part, table, region, triangles)
                                                 : AreaSampler(part.mesh, std::move(triangles)));
}

bool PlaceRegion::contains(const Part& part, const SurfacePoint& point) const {
  const Vector3d p = inverse(part.scene_from_part) * point.point_mm;
  if (region_.kind == Kind::kBox) {
    const BoundingBox box = box_of(region_);
    if ((p.array() < box.min_mm.array()).any() || (p.array() > box.max_mm.array()).any()) {
      return false;
    }
  }
  if (region_.kind == Kind::kSphere &&
      (p - vector_of(region_.centre_mm)).norm() > region_.radius_mm) {
    return false;
  }
  const Vector3d up = part.scene_from_part.rotation.col(2);
  return region_.facing_rad >= kPi || angle_between(point.normal, up) <= region_.facing_rad;
}

std::optional<SurfacePoint> PlaceRegion::draw(const Part& part, Rng& rng) const {
  constexpr int kMaxTries = 1000;
  if (!(sampler_->area_mm2() > 0.0)) {
    return std::nullopt;
  }
  for (int i = 0; i < kMaxTries; ++i) {
    const AreaSampler::Sample sample = sampler_->draw(part.mesh, rng);
    const SurfacePoint point = smooth_point(part, sample.triangle, sample.point_mm);
    if (contains(part, point)) {
      return point;
    }
  }
  return std::nullopt;
}

}  // namespace glint
