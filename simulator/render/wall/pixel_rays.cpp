// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera's rays, recovered from what its pixels see, so that pixels beside the part have a ray
// too. On a plane across them the rays of a camera without distortion are a projective map of the
// picture. Its eight numbers come from linear least squares over up to 9 x 9 pixels (a direct
// linear transform); if one of these is off its ray by more than a pixel, there is no such map.
// Cost: one system of eight equations per picture.
#include "simulator/render/wall/pixel_rays.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Pixels looked at along each side of the picture.
constexpr int kSamples = 9;

using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Vector8d = Eigen::Matrix<double, 8, 1>;

/// A pixel that sees the part: its place in [-1, 1]^2 and, from the camera, where it looks.
struct Sample {
  Vector2d at;
  Vector3d to_mm;
};

std::vector<Sample> samples_of(const VisibilityBuffer& seen,
                               const Vector3d& camera_mm,
                               const Vector2d& per_px) {
  std::vector<Sample> samples;
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) {
      const int x = i * (seen.width_px - 1) / (kSamples - 1);
      const int y = j * (seen.height_px - 1) / (kSamples - 1);
      if (seen.coverage(x, y) > 0.0F) {
        const Vector3d point = vector_of(seen.seen_x(x, y), seen.seen_y(x, y), seen.seen_z(x, y));
        samples.push_back({.at = Vector2d(x * per_px.x() - 1.0, y * per_px.y() - 1.0),
                           .to_mm = point - camera_mm});
      }
    }
  }
  return samples;
}

/// A map of (x, y) that gives (a, b) = (m0 . p, m1 . p) / m2 . p with p = (x, y, 1), by least
/// squares of the equations times their denominators.
class ProjectiveFit {
 public:
  void add(const Vector2d& at, const Vector2d& value) {
    for (int k = 0; k < 2; ++k) {
      Vector8d row = Vector8d::Zero();
      row.segment<3>(3 * k) = Vector3d(at.x(), at.y(), 1.0);
      row.tail<2>() = -value[k] * at;
      matrix_ += row * row.transpose();
      right_ += row * value[k];
    }
  }

  Matrix3d map() const {
    const Vector8d solution = matrix_.ldlt().solve(right_);
    Matrix3d map;
    map << solution.segment<3>(0).transpose(), solution.segment<3>(3).transpose(), solution[6],
        solution[7], 1.0;
    return map;
  }

 private:
  Matrix8d matrix_ = Matrix8d::Zero();
  Vector8d right_ = Vector8d::Zero();
};

Vector2d mapped(const Matrix3d& map, const Vector2d& at) {
  return (map * at.homogeneous()).hnormalized();
}

}  // namespace

std::optional<PixelRays> PixelRays::through(const VisibilityBuffer& seen,
                                            const Vector3d& camera_mm) {
  PixelRays rays;
  rays.camera_mm_ = camera_mm;
  rays.per_px_ = Vector2d(2.0 / (seen.width_px - 1), 2.0 / (seen.height_px - 1));
  const std::vector<Sample> samples = samples_of(seen, camera_mm, rays.per_px_);
  if (samples.size() < kMinSamples) {
    return std::nullopt;
  }
  Vector3d sum = Vector3d::Zero();
  for (const Sample& sample : samples) {
    sum += sample.to_mm;
  }
  rays.distance_mm_ = sum.norm() / static_cast<double>(samples.size());
  const Vector3d along = sum.normalized();
  const Vector3d across = along.unitOrthogonal();
  rays.axes_ << across, along.cross(across), along;
  ProjectiveFit fit;
  const auto value_of = [&](const Sample& sample) {
    return Vector2d((rays.axes_.transpose() * sample.to_mm).hnormalized());
  };
  for (const Sample& sample : samples) {
    fit.add(sample.at, value_of(sample));
  }
  rays.map_ = fit.map();
  const auto is_off = [&](const Sample& sample) {
    const Vector2d found = mapped(rays.map_, sample.at);
    const Vector2d step = mapped(rays.map_, sample.at + rays.per_px_) - found;
    // Not a number is off, too.
    return !((found - value_of(sample)).squaredNorm() <= step.squaredNorm());
  };
  return std::ranges::any_of(samples, is_off) ? std::nullopt : std::optional(rays);
}

Vector3d PixelRays::point(int x, int y) const {
  const Vector2d at(x * per_px_.x() - 1.0, y * per_px_.y() - 1.0);
  return camera_mm_ + distance_mm_ * (axes_ * mapped(map_, at).homogeneous());
}

}  // namespace glint
