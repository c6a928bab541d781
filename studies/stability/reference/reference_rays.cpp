// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/reference/reference_rays.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/units.h"
#include "studies/stability/reference/reference_surface.h"

namespace glint::stability {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNoWall = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxReflections = 4;

/// Numbers of its own for each pixel: splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
class Jitter {
 public:
  explicit Jitter(std::uint64_t seed) : state_(seed) {}

  /// In [0, 1).
  double uniform() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

struct CameraRay {
  Vector3d origin_mm;
  Vector3d direction;
};

CameraRay camera_ray(const ReferenceCamera& camera, const Vector2d& pixel, Jitter& jitter) {
  const Vector2d n = (pixel - camera.center_px).cwiseQuotient(camera.focal_px);
  const auto& [right, down, forward] = camera.axes;
  const Vector3d along = forward + n.x() * right + n.y() * down;
  if (camera.aperture_mm == 0.0) {
    return {camera.origin_mm, along.normalized()};
  }
  const double radius = 0.5 * camera.aperture_mm * std::sqrt(jitter.uniform());
  const double angle = 2.0 * kPi * jitter.uniform();
  const Vector3d from =
      camera.origin_mm + radius * (std::cos(angle) * right + std::sin(angle) * down);
  return {from, (camera.origin_mm + camera.focus_mm * along - from).normalized()};
}

/// Both places where a line meets the whole ellipse.
std::optional<std::array<double, 2>> ellipse_roots(const ReferenceWall& wall,
                                                   const Vector3d& o,
                                                   const Vector3d& d) {
  const Vector2d scale(1.0 / wall.half_width_mm, 1.0 / wall.height_mm);
  const Vector2d p = Vector2d(o.y(), o.z() - wall.base_mm).cwiseProduct(scale);
  const Vector2d v = Vector2d(d.y(), d.z()).cwiseProduct(scale);
  return quadratic_roots(v.squaredNorm(), p.dot(v), p.squaredNorm() - 1.0);
}

bool is_in_slot(const ReferenceWall& wall, double y_mm) {
  return std::abs(y_mm) < 0.5 * wall.slot_mm;
}

/// Whether the wall stands between camera and part.
bool is_hidden(const ReferenceWall& wall, const Vector3d& from, const Vector3d& to) {
  if (!wall.blocks_view) {
    return false;
  }
  const Vector3d d = to - from;
  const auto roots = ellipse_roots(wall, from, d);
  if (!roots) {
    return false;
  }
  for (const double t : *roots) {
    const Vector3d p = from + t * d;
    if (t > 0.0 && t < 1.0 && p.z() >= wall.base_mm && !is_in_slot(wall, p.y())) {
      return true;
    }
  }
  return false;
}

/// Where light comes from that leaves a place of the part towards the camera.
double source_x_mm(const ReferenceScene& scene, SurfaceHit hit, Vector3d direction) {
  for (int reflection = 0; reflection < kMaxReflections; ++reflection) {
    direction -= 2.0 * direction.dot(hit.normal) * hit.normal;
    const auto next = intersect_again(scene.part, hit, direction);
    if (!next) {
      return wall_x_mm(scene.wall, hit.point_mm, direction);
    }
    hit = *next;
  }
  return kNoWall;
}

class Tracing {
 public:
  Tracing(const ReferenceScene& scene, const RaySampling& sampling)
      : scene_(scene), sampling_(sampling), dents_(scene.part.dents) {
    if (!sampling.has_dents) {
      scene_.part.dents.clear();
    }
    const ReferenceCamera& camera = scene.camera;
    rays_.samples = sampling.samples;
    rays_.coverage = ImageF(camera.width_px, camera.height_px);
    rays_.radii.assign(dents_.size(), ImageF(camera.width_px, camera.height_px));
  }

  ReferenceRays run() {
    for (int y = 0; y < scene_.camera.height_px; ++y) {
      for (int x = 0; x < scene_.camera.width_px; ++x) {
        trace_pixel(x, y);
      }
    }
    return std::move(rays_);
  }

 private:
  void trace_pixel(int px, int py) {
    Jitter jitter(static_cast<std::uint64_t>(sampling_.seed) << 40U |
                  static_cast<std::uint64_t>(py) << 20U | static_cast<std::uint64_t>(px));
    const int per_side = kFilm * sampling_.samples;
    hits_ = 0;
    seen_.setZero();
    for (int cell = 0; cell < kFilm * kFilm; ++cell) {
      const int left = cell % kFilm * sampling_.samples;
      const int top = cell / kFilm * sampling_.samples;
      for (int s = 0; s < sampling_.samples * sampling_.samples; ++s) {
        const int row = top + s / sampling_.samples;
        const double u = left + s % sampling_.samples + jitter.uniform();
        const double v = row + jitter.uniform();
        trace(Vector2d(px + u / per_side, py + v / per_side), jitter);
      }
    }
    rays_.coverage(px, py) = static_cast<float>(hits_) / static_cast<float>(per_side * per_side);
    for (std::size_t i = 0; i < dents_.size(); ++i) {
      rays_.radii[i](px, py) =
          hits_ == 0 ? 1e9F : static_cast<float>(radii_from(scene_.part, dents_[i], seen_ / hits_));
    }
  }

  void trace(const Vector2d& pixel, Jitter& jitter) {
    const CameraRay ray = camera_ray(scene_.camera, pixel, jitter);
    const auto hit = intersect(scene_.part, ray.origin_mm, ray.direction);
    double x_mm = kNoWall;
    if (hit) {
      ++hits_;
      seen_ += hit->point_mm;
      if (!is_hidden(scene_.wall, ray.origin_mm, hit->point_mm)) {
        x_mm = source_x_mm(scene_, *hit, ray.direction);
      }
    }
    rays_.x_mm.push_back(x_mm);
  }

  ReferenceScene scene_;
  RaySampling sampling_;
  std::vector<ReferenceDent> dents_;
  ReferenceRays rays_;
  int hits_ = 0;
  Vector3d seen_ = Vector3d::Zero();
};

}  // namespace

double wall_x_mm(const ReferenceWall& wall, const Vector3d& origin_mm, const Vector3d& direction) {
  const auto roots = ellipse_roots(wall, origin_mm, direction);
  if (!roots) {
    return kNoWall;
  }
  for (const double t : *roots) {
    const Vector3d p = origin_mm + t * direction;
    if (t > 0.0 && p.z() >= wall.base_mm) {
      return is_in_slot(wall, p.y()) ? kNoWall : p.x();
    }
  }
  return kNoWall;
}

ReferenceRays trace_reference(const ReferenceScene& scene, const RaySampling& sampling) {
  return Tracing(scene, sampling).run();
}

}  // namespace glint::stability
