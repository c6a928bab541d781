// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/planar.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "hardware/calibration/rotation.h"
#include "simulator/camera/distortion.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Moves points to a mean of zero and a mean distance of sqrt(2).
struct Normaliser {
  explicit Normaliser(std::span<const Vector2d> points) {
    for (const Vector2d& point : points) {
      mean += point / static_cast<double>(points.size());
    }
    double distance = 0.0;
    for (const Vector2d& point : points) {
      distance += (point - mean).norm() / static_cast<double>(points.size());
    }
    scale = distance > 0.0 ? std::numbers::sqrt2 / distance : 1.0;
  }

  Matrix3d matrix() const {
    Matrix3d result;
    result << scale, 0.0, -scale * mean.x(), 0.0, scale, -scale * mean.y(), 0.0, 0.0, 1.0;
    return result;
  }

  Vector2d mean = Vector2d::Zero();
  double scale = 1.0;
};

std::optional<Matrix3d> homography_of(std::span<const Vector2d> from,
                                      std::span<const Vector2d> to) {
  if (from.size() < 4 || from.size() != to.size()) {
    return std::nullopt;
  }
  const Normaliser source(from);
  const Normaliser target(to);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vector2d p = source.scale * (from[i] - source.mean);
    const Vector2d q = target.scale * (to[i] - target.mean);
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.x(), p.y(), 1, 0, 0, 0, -q.x() * p.x(), -q.x() * p.y(), -q.x(),  //
        0, 0, 0, p.x(), p.y(), 1, -q.y() * p.x(), -q.y() * p.y(), -q.y();
    normal += rows.transpose() * rows;
  }
  const Eigen::JacobiSVD<Eigen::Matrix<double, 9, 9>> svd(normal, Eigen::ComputeFullV);
  // A second solution as good as the first one: the points lie on a line.
  if (svd.singularValues()[7] < 1e-9 * svd.singularValues()[0]) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 9, 1> h = svd.matrixV().col(8);
  const Matrix3d normalised =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  return target.matrix().inverse() * normalised * source.matrix();
}

std::vector<Vector2d> on_board(const BoardCorners& corners) {
  std::vector<Vector2d> points;
  for (const Vector3d& point : corners.board_mm) {
    points.emplace_back(point.head<2>());
  }
  return points;
}

/// x/z, y/z of a pixel by Newton's method.
std::optional<Vector2d> undistorted(const LensVector& lens, const Vector2d& pixel_px) {
  const Distortion distortion{.radial = {lens[4], lens[5], lens[6]},
                              .tangential = {lens[7], lens[8]}};
  const Vector2d wanted = (pixel_px - lens.segment<2>(2)).cwiseQuotient(lens.head<2>());
  Vector2d at = wanted;
  for (int i = 0; i < 30; ++i) {
    Eigen::Matrix2d jacobian;
    const Vector2d miss = distort(distortion, at, &jacobian) - wanted;
    if (!(jacobian.determinant() > 0.0)) {
      return std::nullopt;
    }
    at -= jacobian.inverse() * miss;
    if (miss.norm() < 1e-12) {
      return at;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Matrix3d> homography(const BoardCorners& corners) {
  const std::vector<Vector2d> from = on_board(corners);
  return homography_of(from, corners.picture_px);
}

std::optional<Vector2d> focal_px(std::span<const Matrix3d> homographies,
                                 const Vector2d& center_px) {
  Matrix3d shift = Matrix3d::Identity();
  shift.col(2).head<2>() = -center_px;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Vector2d right = Vector2d::Zero();
  for (const Matrix3d& one : homographies) {
    Matrix3d h = shift * one;
    // Columns of one size, pixels against a unit of the picture's size.
    h /= h.leftCols<2>().norm();
    const Vector3d a = h.col(0);
    const Vector3d b = h.col(1);
    Eigen::Matrix2d rows;
    rows << a.x() * b.x(), a.y() * b.y(),  //
        a.x() * a.x() - b.x() * b.x(), a.y() * a.y() - b.y() * b.y();
    const Vector2d values(-a.z() * b.z(), b.z() * b.z() - a.z() * a.z());
    normal += rows.transpose() * rows;
    right += rows.transpose() * values;
  }
  const Vector2d inverse_squares = normal.ldlt().solve(right);
  if (!inverse_squares.allFinite() || !(inverse_squares.minCoeff() > 0.0)) {
    return std::nullopt;
  }
  return inverse_squares.cwiseInverse().cwiseSqrt();
}

std::optional<Isometry3d> board_pose(const BoardCorners& corners, const LensVector& lens) {
  std::vector<Vector2d> rays;
  for (const Vector2d& pixel : corners.picture_px) {
    const auto ray = undistorted(lens, pixel);
    if (!ray.has_value()) {
      return std::nullopt;
    }
    rays.push_back(*ray);
  }
  const auto h = homography_of(on_board(corners), rays);
  if (!h.has_value()) {
    return std::nullopt;
  }
  const double scale = 2.0 / (h->col(0).norm() + h->col(1).norm());
  Matrix3d columns = scale * *h;
  if (columns(2, 2) < 0.0) {  // the board stands in front of the camera
    columns = -columns;
  }
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = columns.col(2);
  columns.col(2) = columns.col(0).cross(columns.col(1));
  pose.linear() = nearest_rotation(columns);
  return pose;
}

}  // namespace glint
