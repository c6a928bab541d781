// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/coverage/view_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kChunk = 1024;  ///< cells

/// How far off the surface rays start, as a share of the largest coordinate: above the rounding of
/// coordinates to float.
constexpr double kStartOffset = 2e-6;

double start_offset_mm(const TriangleMesh& mesh) {
  const BoundingBox box = bounding_box(mesh);
  return kStartOffset *
         std::max(box.min_mm.cwiseAbs().maxCoeff(), box.max_mm.cwiseAbs().maxCoeff());
}

class ViewTracer {
 public:
  ViewTracer(const SurfaceCells& cells,
             const Bvh& bvh,
             const CoverageView& view,
             const CoverageSettings& settings)
      : cells_(cells),
        bvh_(bvh),
        view_(view),
        settings_(settings),
        camera_mm_(inverse(view.camera_from_world).translation_mm),
        offset_mm_(start_offset_mm(cells.mesh)),
        min_cosine_(std::cos(settings.max_incidence_rad)) {}

  /// @return rays traced
  std::int64_t trace(std::size_t begin, std::size_t end, std::vector<ViewCell>& result) const {
    Lanes lanes;
    std::int64_t rays = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (add(i, lanes, result[i])) {
        ++rays;
      }
      if (lanes.count == kPacketSize || (i + 1 == end && lanes.count > 0)) {
        finish(lanes, result);
      }
    }
    return rays;
  }

 private:
  struct Lanes {
    RayPacket rays;
    std::array<std::size_t, kPacketSize> cell = {};
    std::array<Vector3d, kPacketSize> in_camera_mm;
    int count = 0;
  };

  bool is_in_picture(const Vector2d& pixel_px) const {
    const PinholeIntrinsics& in = view_.camera.intrinsics();
    return pixel_px.x() >= 0.0 && pixel_px.y() >= 0.0 && pixel_px.x() < in.width_px &&
           pixel_px.y() < in.height_px;
  }

  /// A ray from the cell to the camera, if nothing but the part can be in the way.
  bool add(std::size_t cell, Lanes& lanes, ViewCell& result) const {
    const Vector3d& point_mm = cells_.points_mm[cell];
    const Vector3d to_camera = camera_mm_ - point_mm;
    if (cells_.normals[cell].dot(to_camera) <= 0.0) {
      return false;
    }
    const Vector3d side = area_vector(cells_.mesh, cell);
    if (side.dot(to_camera) <= 0.0) {
      return false;
    }
    const Vector3d in_camera_mm = view_.camera_from_world * point_mm;
    const auto pixel = view_.camera.project(in_camera_mm);
    if (!pixel || !is_in_picture(*pixel)) {
      return false;
    }
    result.pixel_px = pixel->cast<float>();
    const Vector3d start_mm = point_mm + offset_mm_ / cells_.areas_mm2[cell] * side;
    const auto lane = static_cast<std::size_t>(lanes.count++);
    lanes.cell[lane] = cell;
    lanes.in_camera_mm[lane] = in_camera_mm;
    lanes.rays.origin_x[lane] = static_cast<float>(start_mm.x());
    lanes.rays.origin_y[lane] = static_cast<float>(start_mm.y());
    lanes.rays.origin_z[lane] = static_cast<float>(start_mm.z());
    lanes.rays.direction_x[lane] = static_cast<float>(to_camera.x());
    lanes.rays.direction_y[lane] = static_cast<float>(to_camera.y());
    lanes.rays.direction_z[lane] = static_cast<float>(to_camera.z());
    lanes.rays.t_max[lane] = 1.0F;
    lanes.rays.valid[lane] = -1;
    return true;
  }

  void finish(Lanes& lanes, std::vector<ViewCell>& result) const {
    bvh_.occluded16(lanes.rays, Coherence::kCoherent);
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(lanes.count); ++lane) {
      if (lanes.rays.valid[lane] != 0) {
        judge(lanes.cell[lane], lanes.in_camera_mm[lane], result[lanes.cell[lane]]);
      }
    }
    lanes.rays.valid = {};
    lanes.count = 0;
  }

  /// Width of the circle of confusion at a depth.
  double blur_px(double depth_mm) const {
    return view_.lens.aperture_mm > 0.0
               ? view_.lens.aperture_mm * view_.camera.intrinsics().focal_px.maxCoeff() *
                     std::abs(1.0 / view_.lens.focus_mm - 1.0 / depth_mm)
               : 0.0;
  }

  /// Of a cell that is seen. @param point_mm  the cell in the camera's frame
  void judge(std::size_t cell, const Vector3d& point_mm, ViewCell& result) const {
    const Vector3d normal = view_.camera_from_world.rotation * cells_.normals[cell];
    const PinholeIntrinsics& in = view_.camera.intrinsics();
    const double cosine = -normal.dot(point_mm) / point_mm.norm();
    result.pixel_mm = static_cast<float>(pixel_on_plane_mm(in, point_mm, normal));
    if (cosine < min_cosine_) {
      result.state = CellState::kOblique;
    } else if (settings_.max_pixel_mm > 0.0 &&
               static_cast<double>(result.pixel_mm) > settings_.max_pixel_mm) {
      result.state = CellState::kCoarse;
    } else if (blur_px(point_mm.z()) > settings_.max_blur_px) {
      result.state = CellState::kBlurred;
    } else {
      result.state = CellState::kInspected;
    }
  }

  const SurfaceCells& cells_;
  const Bvh& bvh_;
  const CoverageView& view_;
  const CoverageSettings& settings_;
  Vector3d camera_mm_;
  double offset_mm_;
  double min_cosine_;
};

}  // namespace

std::string_view state_name(CellState state) {
  constexpr std::array<std::string_view, kCellStates> kNames = {
      "unseen", "oblique", "coarse", "blurred", "hidden", "unlit", "dark", "clipped", "inspected"};
  return kNames[static_cast<std::size_t>(state)];
}

CoverageView coverage_view(const CameraSettings& camera,
                           const LensSettings& lens,
                           const Viewpoint& viewpoint) {
  return {.camera = PinholeCamera(intrinsics_of(camera, lens)),
          .lens = lens_geometry(camera, lens),
          .camera_from_world = camera_from_world(viewpoint)};
}

// On the plane n . p = n . z r with r = (u, v, 1), dp/du = z (e_u - r n_u / (n . r)), and u counts
// pixels / focal length. The longest vector that one pixel becomes is the larger singular value of
// the two columns.
double pixel_on_plane_mm(const PinholeIntrinsics& intrinsics,
                         const Vector3d& point_mm,
                         const Vector3d& normal) {
  const Vector3d r = point_mm / point_mm.z();
  const double along = normal.dot(r);
  const Vector3d across_x =
      point_mm.z() / intrinsics.focal_px.x() * (Vector3d::UnitX() - r * (normal.x() / along));
  const Vector3d across_y =
      point_mm.z() / intrinsics.focal_px.y() * (Vector3d::UnitY() - r * (normal.y() / along));
  const double a = across_x.squaredNorm();
  const double b = across_y.squaredNorm();
  const double c = across_x.dot(across_y);
  return std::sqrt(0.5 * (a + b + std::sqrt((a - b) * (a - b) + 4.0 * c * c)));
}

std::vector<ViewCell> view_cells(const SurfaceCells& cells,
                                 const Bvh& bvh,
                                 const CoverageView& view,
                                 const CoverageSettings& settings,
                                 ThreadPool& pool,
                                 std::int64_t& rays) {
  std::vector<ViewCell> result(cells.size());
  const ViewTracer tracer(cells, bvh, view, settings);
  const auto chunks = static_cast<std::int64_t>((cells.size() + kChunk - 1) / kChunk);
  const auto counts = pool.map<std::int64_t>(chunks, [&](std::int64_t chunk) {
    const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk;
    return tracer.trace(begin, std::min(cells.size(), begin + kChunk), result);
  });
  rays += std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  return result;
}

}  // namespace glint
