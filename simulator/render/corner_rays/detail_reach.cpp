// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels four corner rays are not enough for, without tracing any: the box in which a feature
// changes the surface is projected, widened for distortion and a pixel, and each pixel inside is
// cut into so many cells that no feature lies between two of their corners (1.5 sigma of its
// cross-section). Too many cells cost time; too few would miss a defect. Cost: eight projections a
// feature and its pixels, one projection a vertex. docs/theory/footprints.md, "When four corners
// are not enough".
#include "simulator/render/corner_rays/detail_reach.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMinCells = 2;
constexpr int kMaxCells = 16;
/// Corners of cells stand no further apart than this many sigma: none of them can miss a feature.
constexpr double kSigmasPerCell = 1.5;
/// The edge of a stain is as wide as this many sigma (2 sigma = 1 radius); two cells see its
/// course.
constexpr double kSigmasPerRim = 4.0 * SurfaceDetail::kStainRim;
constexpr double kCellsPerRim = 2.0;
/// Interpolated directions may err by this share of what a feature's steepest slope turns them by.
constexpr double kShareOfSlope = 0.01;
constexpr double kMinError_rad = 1e-5;
/// The outline of a projected box bulges under distortion; this and a pixel more are allowed for.
constexpr double kBulge = 0.05;

/// Pixels [min, max] of a rectangle on the image.
struct PixelBox {
  int min_x = 0, min_y = 0, max_x = -1, max_y = -1;
};

PixelBox whole(const PinholeIntrinsics& in) {
  return {.min_x = 0, .min_y = 0, .max_x = in.width_px - 1, .max_y = in.height_px - 1};
}

/// The eight corners of the region in which SurfaceDetail::sample() makes something of a feature.
std::array<Vector3d, 8> reach_corners(const HeightFeature& feature) {
  const double radii =
      feature.height_mm != 0.0 ? SurfaceDetail::kReachRadii : 1.0 + SurfaceDetail::kStainRim;
  const double reach_mm = radii * 2.0 * feature.cross_sigma_mm();
  const double along_mm = feature.half_line_mm() + reach_mm;
  std::array<Vector3d, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = feature.centre_mm + ((i & 1U) != 0U ? along_mm : -along_mm) * feature.u_axis +
                 ((i & 2U) != 0U ? reach_mm : -reach_mm) * feature.v_axis +
                 ((i & 4U) != 0U ? along_mm : -along_mm) * feature.normal;
  }
  return corners;
}

PixelBox reach_on_image(const PinholeCamera& camera,
                        const RigidTransform& camera_from_world,
                        const HeightFeature& feature) {
  const PinholeIntrinsics& in = camera.intrinsics();
  Vector2d min_px = Vector2d::Constant(1e9);
  Vector2d max_px = Vector2d::Constant(-1e9);
  for (const Vector3d& corner_mm : reach_corners(feature)) {
    const auto pixel = camera.project(camera_from_world * corner_mm);
    if (!pixel) {
      return whole(in);
    }
    min_px = min_px.cwiseMin(*pixel);
    max_px = max_px.cwiseMax(*pixel);
  }
  const Vector2d margin_px = kBulge * (max_px - min_px) + Vector2d::Ones();
  const auto clamped = [](double value, int size) {
    return static_cast<int>(std::floor(std::clamp(value, -1.0, static_cast<double>(size))));
  };
  return {.min_x = std::max(0, clamped(min_px.x() - margin_px.x(), in.width_px)),
          .min_y = std::max(0, clamped(min_px.y() - margin_px.y(), in.height_px)),
          .max_x = std::min(in.width_px - 1, clamped(max_px.x() + margin_px.x(), in.width_px)),
          .max_y = std::min(in.height_px - 1, clamped(max_px.y() + margin_px.y(), in.height_px))};
}

/// The smallest number of cells that are no wider than a length on the image.
int cells_for(double length_px) {
  int cells = kMinCells;
  while (cells < kMaxCells && cells * length_px < 1.0) {
    cells *= 2;
  }
  return cells;
}

/// Cells for what a feature is: its slopes, its edge, its micro relief, of which as many places as
/// can be are wanted.
int cells_for(const HeightFeature& feature, double sigma_px) {
  if (feature.roughness_rad > 0.0) {
    return kMaxCells;
  }
  int cells = feature.height_mm != 0.0 ? cells_for(kSigmasPerCell * sigma_px) : 0;
  if (feature.reflectance != 1.0) {
    cells = std::max(cells, cells_for(kSigmasPerRim / kCellsPerRim * sigma_px));
  }
  return cells;
}

/// Sigma [px] of a feature's cross-section as the camera sees it, at its shortest.
double sigma_on_image(const PinholeCamera& camera,
                      const RigidTransform& camera_from_world,
                      const HeightFeature& feature) {
  const Vector3d centre = camera_from_world * feature.centre_mm;
  const double distance_mm = std::max(1e-6, centre.norm());
  const Vector3d normal = camera_from_world.rotation * feature.normal;
  const double cosine = std::max(0.05, std::abs(normal.dot(centre)) / distance_mm);
  return cosine * feature.cross_sigma_mm() * camera.intrinsics().focal_px.minCoeff() / distance_mm;
}

}  // namespace

RefinementNeed::RefinementNeed(const PinholeCamera& camera,
                               const RigidTransform& camera_from_world,
                               const Part& part,
                               const SurfaceDetail& detail) {
  const PinholeIntrinsics& in = camera.intrinsics();
  has_vertex_ = Mask(in.width_px, in.height_px);
  for (const Vector3d& vertex_mm : part.mesh.vertices_mm) {
    const auto pixel = camera.project(camera_from_world * vertex_mm);
    if (pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() < in.width_px &&
        pixel->y() < in.height_px) {
      has_vertex_(static_cast<int>(pixel->x()), static_cast<int>(pixel->y())) = 1;
    }
  }
  if (detail.empty()) {
    return;
  }
  cells_ = Image<std::uint8_t>(in.width_px, in.height_px);
  max_error_ = ImageF(in.width_px, in.height_px, std::numeric_limits<float>::max());
  for (const HeightFeature& feature : detail.features()) {
    add_feature(camera, camera_from_world, feature);
  }
}

RefinementNeed RefinementNeed::vertices_in(int first, int count) const {
  const int width = has_vertex_.width();
  RefinementNeed result;
  result.has_vertex_ = Mask(width, count);
  for (int y = 0; y < count; ++y) {
    std::copy_n(has_vertex_.row(first + y), width, result.has_vertex_.row(y));
  }
  return result;
}

void RefinementNeed::add_feature(const PinholeCamera& camera,
                                 const RigidTransform& camera_from_world,
                                 const HeightFeature& feature) {
  const PixelBox box = reach_on_image(camera, camera_from_world, feature);
  const auto cells = static_cast<std::uint8_t>(
      cells_for(feature, sigma_on_image(camera, camera_from_world, feature)));
  const double turn_rad = 2.0 * feature.max_slope_rad();
  const auto error_rad = feature.height_mm != 0.0
                             ? static_cast<float>(std::max(kMinError_rad, kShareOfSlope * turn_rad))
                             : std::numeric_limits<float>::max();
  for (int y = box.min_y; y <= box.max_y; ++y) {
    for (int x = box.min_x; x <= box.max_x; ++x) {
      cells_(x, y) = std::max(cells_(x, y), cells);
      max_error_(x, y) = std::min(max_error_(x, y), error_rad);
    }
  }
}

}  // namespace glint
