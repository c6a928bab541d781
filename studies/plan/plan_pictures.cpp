// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hardware/planning/clearance.h"
#include "simulator/render/preview/preview.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Kind = SolidBody::Kind;

constexpr int kRound = 24;
constexpr double kCreaseRad = 0.6;

/// Rings of a surface of revolution about a segment, from one pole to the other.
TriangleMesh capsule_mesh(const Vector3d& from_mm, const Vector3d& to_mm, double radius_mm) {
  const Vector3d way_mm = to_mm - from_mm;
  const Vector3d axis = way_mm.norm() > 0.0 ? Vector3d(way_mm.normalized()) : Vector3d::UnitZ();
  const Vector3d x = axis.unitOrthogonal();
  const Vector3d y = axis.cross(x);
  constexpr int kHalf = kRound / 4;
  TriangleMesh mesh;
  for (int row = 0; row <= 2 * kHalf + 1; ++row) {
    const bool is_first = row <= kHalf;
    const double angle = 0.5 * kPi * (is_first ? row - kHalf : row - kHalf - 1) / kHalf;
    const Vector3d centre = (is_first ? from_mm : to_mm) + radius_mm * std::sin(angle) * axis;
    for (int k = 0; k < kRound; ++k) {
      const double turn = 2.0 * kPi * k / kRound;
      mesh.vertices_mm.emplace_back(centre + radius_mm * std::cos(angle) *
                                                 (std::cos(turn) * x + std::sin(turn) * y));
    }
  }
  for (int row = 0; row <= 2 * kHalf; ++row) {
    for (int k = 0; k < kRound; ++k) {
      const int a = row * kRound + k;
      const int b = row * kRound + (k + 1) % kRound;
      mesh.triangles.push_back({a, b, a + kRound});
      mesh.triangles.push_back({b, b + kRound, a + kRound});
    }
  }
  return mesh;
}

/// Everything in one mesh, and what each triangle is of.
struct CellMesh {
  TriangleMesh mesh;
  std::vector<Kind> kinds;
};

void add(const TriangleMesh& part, const Eigen::Isometry3d& pose, Kind kind, CellMesh& whole) {
  const auto first = static_cast<std::int32_t>(whole.mesh.vertices_mm.size());
  for (const Vector3d& vertex_mm : part.vertices_mm) {
    whole.mesh.vertices_mm.push_back(pose * vertex_mm);
  }
  for (const Triangle& t : part.triangles) {
    whole.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    whole.kinds.push_back(kind);
  }
}

CellMesh mesh_of(const PlanningCell& cell, const JointVector& joints_rad) {
  const LinkFrames frames = cell.arm.arm.frames(joints_rad);
  CellMesh whole;
  std::vector<SolidBody> bodies = arm_bodies(cell.arm);
  std::erase_if(bodies, [](const SolidBody& body) { return body.kind == Kind::kTool; });
  bodies.insert(bodies.end(), cell.carried.begin(), cell.carried.end());
  bodies.insert(bodies.end(), cell.standing.begin(), cell.standing.end());
  for (const SolidBody& body : bodies) {
    add(visible_mesh(body), frames[static_cast<std::size_t>(body.link)], body.kind, whole);
  }
  smooth_normals(whole.mesh, kCreaseRad);
  return whole;
}

/// Labels for one colour after the other: a preview tells two kinds of triangles apart.
std::vector<std::int32_t> labels_of(const CellMesh& whole, Kind kind) {
  std::vector<std::int32_t> labels;
  for (const Kind one : whole.kinds) {
    labels.push_back(one == kind ? 1 : 0);
  }
  return labels;
}

std::array<std::uint8_t, 3> coloured(float shade, float carried, float standing) {
  constexpr std::array<double, 3> kArm = {1.0, 1.0, 1.0};
  constexpr std::array<double, 3> kCarried = {0.45, 0.7, 1.0};
  constexpr std::array<double, 3> kStanding = {1.0, 0.75, 0.4};
  std::array<std::uint8_t, 3> pixel = {};
  const double blue = std::clamp(static_cast<double>(carried), 0.0, 1.0);
  const double orange = std::clamp(static_cast<double>(standing), 0.0, 1.0 - blue);
  for (std::size_t c = 0; c < 3; ++c) {
    const double tint =
        blue * kCarried[c] + orange * kStanding[c] + (1.0 - blue - orange) * kArm[c];
    pixel[c] = static_cast<std::uint8_t>(
        std::lround(255.0 * std::clamp(tint * static_cast<double>(shade), 0.0, 1.0)));
  }
  return pixel;
}

/// Share of the kind in a pixel; what is beside everything counts as none.
float share_of(float map) {
  return map == kMapBackground ? 0.0F : map;
}

}  // namespace

TriangleMesh visible_mesh(const SolidBody& body) {
  constexpr std::size_t kSegment = 3;
  return body.mesh.vertices_mm.size() == kSegment && body.radius_mm > 0.0
             ? capsule_mesh(body.mesh.vertices_mm[0], body.mesh.vertices_mm[1], body.radius_mm)
             : body.mesh;
}

ImageRgb draw_cell(const PlanningCell& cell,
                   const JointVector& joints_rad,
                   int side_px,
                   ThreadPool& pool) {
  const CellMesh whole = mesh_of(cell, joints_rad);
  const Bvh bvh(whole.mesh);
  const SurfaceDetail no_detail;
  const PreviewView view = fitted_view(whole.mesh, Vector3d(-0.75, 0.5, -0.45), side_px);
  const std::vector<std::int32_t> carried_labels = labels_of(whole, Kind::kCarried);
  const std::vector<std::int32_t> standing_labels = labels_of(whole, Kind::kStanding);
  const PreviewPictures carried = draw_preview(
      {.mesh = whole.mesh, .bvh = bvh, .labels = carried_labels, .detail = no_detail}, view, pool);
  const PreviewPictures standing = draw_preview(
      {.mesh = whole.mesh, .bvh = bvh, .labels = standing_labels, .detail = no_detail}, view, pool);
  ImageRgb image(carried.image.width(), carried.image.height(), {});
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] = coloured(carried.image.values()[i],
                                 share_of(carried.map.values()[i]),
                                 share_of(standing.map.values()[i]));
  }
  return image;
}

ImageRgb picture_sheet(const std::vector<ImageRgb>& pictures, int columns) {
  int width = 1;
  int height = 1;
  for (const ImageRgb& picture : pictures) {
    width = std::max(width, picture.width());
    height = std::max(height, picture.height());
  }
  const int count = static_cast<int>(pictures.size());
  const int rows = std::max(1, (count + columns - 1) / columns);
  ImageRgb sheet(columns * width, rows * height, {255, 255, 255});
  for (int i = 0; i < count; ++i) {
    const ImageRgb& picture = pictures[static_cast<std::size_t>(i)];
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        sheet(i % columns * width + x, i / columns * height + y) = picture(x, y);
      }
    }
  }
  return sheet;
}

}  // namespace glint
