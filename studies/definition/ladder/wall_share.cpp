// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/wall_share.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/pose.h"
#include "core/units.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/geometry/part/part.h"
#include "simulator/light/tunnel/tunnel.h"

namespace glint {
namespace {

/// Places spread evenly over the face of the part.
struct FacePlaces {
  std::vector<Eigen::Vector3d> points_mm;
  Eigen::Vector3d middle_mm;
  Eigen::Vector3d normal;
  double area_mm2 = 0.0;
};

FacePlaces face_places(const SceneSettings& scene, const Eigen::Vector3d& size_mm) {
  constexpr int kSteps = 3;  // along both sides
  const RigidTransform scene_from_part =
      pose_from_angles(vector_of(scene.part.position_mm), vector_of(scene.part.rotation_rad));
  const Eigen::Vector3d camera_mm = inverse(camera_from_world(scene.viewpoint())).translation_mm;
  FacePlaces face;
  face.middle_mm = scene_from_part.translation_mm;
  face.normal = (camera_mm - face.middle_mm).normalized();
  face.area_mm2 = size_mm.x() * size_mm.y();
  // The part's x axis in the face, its y axis where the camera looks along x.
  const Eigen::Vector3d along_x = scene_from_part.rotation.col(0);
  const bool is_end_on = face.normal.cross(along_x).norm() < 1e-6;
  const Eigen::Vector3d across =
      face.normal.cross(is_end_on ? Eigen::Vector3d(scene_from_part.rotation.col(1)) : along_x)
          .normalized();
  const Eigen::Vector3d along = across.cross(face.normal);
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      face.points_mm.emplace_back(face.middle_mm +
                                  ((i + 0.5) / kSteps - 0.5) * size_mm.x() * along +
                                  ((j + 0.5) / kSteps - 0.5) * size_mm.y() * across);
    }
  }
  return face;
}

/// Of a piece of wall and a place of the face, 1 / mm2: form factors are this times the area that
/// is seen. The mean over the places.
double mean_kernel(const FacePlaces& face,
                   const Eigen::Vector3d& piece_mm,
                   const Eigen::Vector3d& piece_normal) {
  double sum = 0.0;
  for (const Eigen::Vector3d& point_mm : face.points_mm) {
    const Eigen::Vector3d way = piece_mm - point_mm;
    const double square = way.squaredNorm();
    const double leaving = std::max(0.0, face.normal.dot(way));
    const double arriving = std::max(0.0, -piece_normal.dot(way));
    sum += square > 0.0 ? leaving * arriving / (kPi * square * square) : 0.0;
  }
  return sum / static_cast<double>(face.points_mm.size());
}

/// What a strip of wall along the tunnel returns.
/// @param middle_yz_mm  of the strip, as wide as width_mm
/// @param normal        towards the inside
double returned_by_strip(const FacePlaces& face,
                         const Eigen::Vector2d& middle_yz_mm,
                         const Eigen::Vector3d& normal,
                         double width_mm,
                         double half_length_mm) {
  constexpr int kSteps = 64;  // evenly in the angle that the face's middle sees them at
  const double away_mm = std::max(1e-9, (middle_yz_mm - face.middle_mm.tail<2>()).norm());
  const double from_rad = std::atan((-half_length_mm - face.middle_mm.x()) / away_mm);
  const double step_rad =
      (std::atan((half_length_mm - face.middle_mm.x()) / away_mm) - from_rad) / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double tangent = std::tan(from_rad + (i + 0.5) * step_rad);
    const double area_mm2 = width_mm * away_mm * (1.0 + tangent * tangent) * step_rad;
    const Eigen::Vector3d piece_mm(
        face.middle_mm.x() + away_mm * tangent, middle_yz_mm.x(), middle_yz_mm.y());
    const double kernel = mean_kernel(face, piece_mm, normal);
    sum += area_mm2 * kernel * std::min(1.0, face.area_mm2 * kernel);
  }
  return sum;
}

/// What the wall between two points of the cross-section returns, in strips of at most so wide.
double returned_by_segment(const FacePlaces& face,
                           const Eigen::Vector2d& from_yz_mm,
                           const Eigen::Vector2d& to_yz_mm,
                           double max_width_mm,
                           double half_length_mm) {
  const Eigen::Vector2d way = to_yz_mm - from_yz_mm;
  const int strips = static_cast<int>(std::ceil(way.norm() / max_width_mm));
  Eigen::Vector3d normal = Eigen::Vector3d(0.0, -way.y(), way.x()).normalized();
  if (normal.tail<2>().dot(face.middle_mm.tail<2>() - from_yz_mm) < 0.0) {
    normal = -normal;
  }
  double sum = 0.0;
  for (int k = 0; k < strips; ++k) {
    const Eigen::Vector2d middle_yz_mm = from_yz_mm + (k + 0.5) / strips * way;
    sum += returned_by_strip(face, middle_yz_mm, normal, way.norm() / strips, half_length_mm);
  }
  return sum;
}

double length_of(const std::vector<std::vector<Eigen::Vector2d>>& lines) {
  double length_mm = 0.0;
  for (const auto& line : lines) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      length_mm += (line[i] - line[i - 1]).norm();
    }
  }
  return length_mm;
}

}  // namespace

WallShare wall_share(const SceneSettings& scene, const Eigen::Vector3d& size_mm) {
  constexpr double kOutlineStep_mm = 1.0;
  constexpr double kStrips = 256.0;
  const FacePlaces face = face_places(scene, size_mm);
  const Tunnel tunnel(scene.tunnel);
  const double length_mm = length_of(tunnel.outline(kOutlineStep_mm));
  WallShare share = {.wall_mm2 = length_mm * scene.tunnel.length_mm};
  for (const auto& line : tunnel.outline(std::max(kOutlineStep_mm, length_mm / kStrips))) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      share.returned += returned_by_segment(
          face, line[i - 1], line[i], length_mm / kStrips, 0.5 * scene.tunnel.length_mm);
    }
  }
  return share;
}

}  // namespace glint
