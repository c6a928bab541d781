// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the corner rays change with the camera's pose. Each packet is traced once to learn what it
// hits; the reflected ray then follows for a camera moved a little to both sides, from the same
// triangles and exact surfaces and without another search, as a central difference in double. The
// step moves the point on the part by 1e-4 mm. docs/theory/derivatives.md. Cost: about two
// tracings, and a tenth of one for each motion. Memory: 24 bytes per ray and motion.
#include "simulator/render/derivative/ray_derivative.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// How far a difference moves the point on the part: the error grows with its square, the rounding
/// (1e-12 mm) with its inverse.
constexpr double kStep_mm = 1e-4;
/// ... in units of the narrowest feature's sigma, at most.
constexpr double kStepOfSigma = 2e-3;

/// Rays are cut into chunks of this many packets.
constexpr std::int64_t kPacketsPerChunk = 64;

double step_mm(const SurfaceDetail& detail) {
  double step = kStep_mm;
  for (const HeightFeature& feature : detail.features()) {
    step = std::min(step, kStepOfSigma * feature.cross_sigma_mm());
  }
  return step;
}

/// By how many units of a motion to step to both sides; 0 for no motion.
double step_of(const CameraTwist& twist, double distance_mm, double step) {
  const double speed_mm = twist.translation_mm.norm() + twist.rotation_rad.norm() * distance_mm;
  return speed_mm > 0.0 ? step / speed_mm : 0.0;
}

/// The same rays for a camera that has moved by `unit` times a motion.
CameraPacket moved_rays(const CameraPacket& rays, const CameraTwist& twist, double unit) {
  CameraPacket moved = rays;
  moved.origin_mm += unit * twist.translation_mm;
  const double angle_rad = unit * twist.rotation_rad.norm();
  if (angle_rad == 0.0) {
    return moved;
  }
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle_rad, twist.rotation_rad.normalized()).toRotationMatrix();
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const Vector3d direction =
        (turn * Vector3d(rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]))
            .normalized();
    moved.direction_x[lane] = direction.x();
    moved.direction_y[lane] = direction.y();
    moved.direction_z[lane] = direction.z();
  }
  return moved;
}

/// Traces rays again, finds out which are reflected once, and differentiates those.
class Differentiator {
 public:
  Differentiator(const CameraScene& scene,
                 const std::vector<CameraTwist>& twists,
                 std::vector<RayDerivative>& result)
      : traced_(scene.part, scene.bvh, scene.detail, scene.settings),
        camera_(scene.camera, scene.camera_from_world),
        twists_(twists),
        result_(result) {
    const Vector3d centre_mm = bounding_box(scene.part.mesh).centre_mm();
    const double distance_mm = (scene.camera_from_world * centre_mm).norm();
    const double step = step_mm(scene.detail);
    for (const CameraTwist& twist : twists) {
      units_.push_back(step_of(twist, distance_mm, step));
    }
  }

  /// Rays [first, first + count) of at most a packet, through given points of the image.
  void run(PacketTracer& tracer,
           const std::array<Vector2d, kPacketSize>& pixels,
           std::size_t first,
           int count) const {
    Lanes x_px = {};
    Lanes y_px = {};
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
      x_px[lane] = pixels[lane].x();
      y_px[lane] = pixels[lane].y();
    }
    CameraPacket rays;
    EscapePacket escapes;
    camera_.through(x_px.data(), y_px.data(), count, rays);
    tracer.trace(rays, escapes);
    for (std::size_t i = 0; i < twists_.size(); ++i) {
      if (units_[i] > 0.0) {
        difference(rays, tracer.hits(), escapes, i, first);
      }
    }
  }

  const TraceScene& traced() const { return traced_; }

 private:
  void difference(const CameraPacket& rays,
                  const HitPacket& hits,
                  const EscapePacket& escapes,
                  std::size_t motion,
                  std::size_t first) const {
    IntersectionLanes before = {};
    IntersectionLanes after = {};
    const double unit = units_[motion];
    intersect_part(traced_, moved_rays(rays, twists_[motion], -unit), hits, true, before);
    intersect_part(traced_, moved_rays(rays, twists_[motion], unit), hits, true, after);
    RayDerivative& to = result_[motion];
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(rays.count); ++lane) {
      if (escapes.path[lane] != RayPath::kOnce) {
        continue;
      }
      const auto derivative = [&](const double* a, const double* b) {
        return static_cast<float>((b[lane] - a[lane]) / (2.0 * unit));
      };
      to.origin_x[first + lane] = derivative(before.point_x, after.point_x);
      to.origin_y[first + lane] = derivative(before.point_y, after.point_y);
      to.origin_z[first + lane] = derivative(before.point_z, after.point_z);
      to.direction_x[first + lane] = derivative(before.leaving_x, after.leaving_x);
      to.direction_y[first + lane] = derivative(before.leaving_y, after.leaving_y);
      to.direction_z[first + lane] = derivative(before.leaving_z, after.leaving_z);
    }
  }

  TraceScene traced_;
  CameraRays camera_;
  const std::vector<CameraTwist>& twists_;
  std::vector<RayDerivative>& result_;
  std::vector<double> units_;
};

/// Derivatives of rays 0 ... count - 1, where pixel_of(i) is ray i's place on the image.
template <class PixelOf>
std::vector<RayDerivative> differentiate(const CameraScene& scene,
                                         const std::vector<CameraTwist>& twists,
                                         std::size_t count,
                                         ThreadPool& pool,
                                         const PixelOf& pixel_of) {
  std::vector<RayDerivative> result(twists.size());
  for (RayDerivative& d : result) {
    for (auto* component :
         {&d.origin_x, &d.origin_y, &d.origin_z, &d.direction_x, &d.direction_y, &d.direction_z}) {
      component->resize(count);
    }
  }
  const Differentiator differentiator(scene, twists, result);
  constexpr std::int64_t kRays = kPacketsPerChunk * kPacketSize;
  const auto num_rays = static_cast<std::int64_t>(count);
  pool.for_each((num_rays + kRays - 1) / kRays, [&](std::int64_t chunk) {
    PacketTracer tracer(differentiator.traced());
    const std::int64_t end = std::min(num_rays, (chunk + 1) * kRays);
    for (std::int64_t first = chunk * kRays; first < end; first += kPacketSize) {
      const auto lanes = static_cast<int>(std::min<std::int64_t>(kPacketSize, end - first));
      std::array<Vector2d, kPacketSize> pixels;
      for (int lane = 0; lane < lanes; ++lane) {
        pixels[static_cast<std::size_t>(lane)] = pixel_of(first + lane);
      }
      differentiator.run(tracer, pixels, static_cast<std::size_t>(first), lanes);
    }
  });
  return result;
}

}  // namespace

std::vector<RayDerivative> corner_derivatives(const CameraScene& scene,
                                              const std::vector<CameraTwist>& twists,
                                              ThreadPool& pool) {
  const PinholeIntrinsics& in = scene.camera.intrinsics();
  const std::int64_t columns = in.width_px + 1;
  const auto count = static_cast<std::size_t>(columns * (in.height_px + 1));
  return differentiate(scene, twists, count, pool, [&](std::int64_t i) {
    const std::int64_t row = i / columns;
    return Vector2d(static_cast<double>(i % columns), static_cast<double>(row));
  });
}

std::vector<RayDerivative> refined_derivatives(const CameraScene& scene,
                                               const RefinedGroup& group,
                                               const std::vector<CameraTwist>& twists,
                                               ThreadPool& pool) {
  const int n = group.cells_per_axis;
  const std::int64_t corners = (n + 1) * (n + 1);
  const int width_px = scene.camera.intrinsics().width_px;
  return differentiate(
      scene, twists, group.rays.weight.size(), pool, [&](std::int64_t i) -> Vector2d {
        const std::int32_t pixel = group.pixels[static_cast<std::size_t>(i / corners)];
        const auto corner = static_cast<int>(i % corners);
        const std::int32_t row = pixel / width_px;
        const int row_in_pixel = corner / (n + 1);
        return {pixel % width_px + static_cast<double>(corner % (n + 1)) / n,
                static_cast<double>(row) + static_cast<double>(row_in_pixel) / n};
      });
}

}  // namespace glint
