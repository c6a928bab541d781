// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/surface_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kOneDirection = 0.035;  ///< rms of the normals of a plane about their mean, 2 deg
constexpr double kAlongAxis = 0.9994;    ///< cosine: 2 deg
constexpr double kOneAngle = 0.03;       ///< rms of the normals' cosines with an axis
constexpr double kSquare = 0.1;          ///< their mean, of a cylinder
constexpr double kMinShare = 0.02;       ///< of the radius, left as an rms

/// "+z" or "-x", or nothing for directions between the axes.
std::optional<std::string> axis_name(const Vector3d& direction) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  Index axis = 0;
  if (direction.cwiseAbs().maxCoeff(&axis) < kAlongAxis) {
    return std::nullopt;
  }
  return (direction[axis] > 0.0 ? "+" : "-") + std::string(kNames[static_cast<std::size_t>(axis)]);
}

Vector3d mean_normal(std::span<const PointWithNormal> points) {
  Vector3d sum = Vector3d::Zero();
  for (const PointWithNormal& point : points) {
    sum += point.normal;
  }
  return sum / static_cast<double>(points.size());
}

Matrix3d spread_of_normals(std::span<const PointWithNormal> points, const Vector3d& mean) {
  Matrix3d spread = Matrix3d::Zero();
  for (const PointWithNormal& point : points) {
    const Vector3d off = point.normal - mean;
    spread += off * off.transpose() / static_cast<double>(points.size());
  }
  return spread;
}

std::string plane_name(std::span<const PointWithNormal> points, const Vector3d& mean) {
  const Vector3d facing = mean.normalized();
  const auto axis = axis_name(facing);
  if (!axis) {
    const Vector3d shown = (facing.array() * 100.0).round() / 100.0 + 0.0;  // no -0.00
    return fmt::format("plane facing ({:.2f}, {:.2f}, {:.2f})", shown.x(), shown.y(), shown.z());
  }
  Index along = 0;
  facing.cwiseAbs().maxCoeff(&along);
  double height_mm = 0.0;
  for (const PointWithNormal& point : points) {
    height_mm += point.at_mm[along] / static_cast<double>(points.size());
  }
  return fmt::format("plane facing {} at {} = {:.1f} mm",
                     *axis,
                     axis->back(),
                     std::round(10.0 * height_mm) / 10.0 + 0.0);
}

/// Radius of at = centre + radius normal, all led through `across` first, and what it leaves.
struct RadiusFit {
  double radius_mm = 0.0;
  double rms_mm = 0.0;
};

/// @param across  rows that span where the shape is round: 3 x 3 of a sphere, 2 x 3 of a cylinder
RadiusFit fit_radius(std::span<const PointWithNormal> points, const MatrixXd& across) {
  const Index size = across.rows();
  MatrixXd normal = MatrixXd::Zero(size + 1, size + 1);
  VectorXd right = VectorXd::Zero(size + 1);
  double squares = 0.0;
  for (const PointWithNormal& point : points) {
    const VectorXd at = across * (point.at_mm - points.front().at_mm);
    MatrixXd rows = MatrixXd::Identity(size, size + 1);
    rows.col(size) = across * point.normal;
    normal += rows.transpose() * rows;
    right += rows.transpose() * at;
    squares += at.squaredNorm();
  }
  const VectorXd values = normal.ldlt().solve(right);
  const double rest = std::max(squares - right.dot(values), 0.0);
  return {.radius_mm = values[size],
          .rms_mm = std::sqrt(rest / static_cast<double>(points.size()))};
}

/// The same by the planes of facets, across an axis: their points lie beside where a normal of the
/// round surface leads, but each plane is one radius from the centre.
/// @param across  2 x 3
RadiusFit fit_facets(std::span<const PointWithNormal> points, const MatrixXd& across) {
  MatrixXd rows(static_cast<Index>(points.size()), 3);
  VectorXd right(rows.rows());
  for (Index i = 0; i < rows.rows(); ++i) {
    const PointWithNormal& point = points[static_cast<std::size_t>(i)];
    rows.row(i) << (across * point.normal).transpose(), 1.0;
    right[i] = (across * point.normal).dot(across * (point.at_mm - points.front().at_mm));
  }
  const VectorXd values = rows.colPivHouseholderQr().solve(right);
  return {.radius_mm = values[2],
          .rms_mm = (rows * values - right).norm() / std::sqrt(static_cast<double>(points.size()))};
}

bool is_good(const RadiusFit& fit, double pixel_mm) {
  return fit.rms_mm < pixel_mm + kMinShare * std::abs(fit.radius_mm);
}

std::string about(const Vector3d& axis, const char* word) {
  const auto name = axis_name(axis);
  return name ? fmt::format(" {} {}", word, name->back()) : std::string();
}

/// With two rows that are square to the axis.
MatrixXd across_of(const Vector3d& axis) {
  MatrixXd across(2, 3);
  const Vector3d first = axis.unitOrthogonal();
  across.row(0) = first.transpose();
  across.row(1) = axis.cross(first).transpose();
  return across;
}

/// All normals have one angle to the axis. Cosines alone do not tell: beside the axis all are
/// near 1.
bool is_cone(std::span<const PointWithNormal> points, const Vector3d& axis) {
  double sum = 0.0;
  double squares = 0.0;
  for (const PointWithNormal& point : points) {
    const double angle_rad = std::acos(std::clamp(point.normal.dot(axis), -1.0, 1.0));
    sum += angle_rad;
    squares += angle_rad * angle_rad;
  }
  const double mean_rad = sum / static_cast<double>(points.size());
  const double variance = squares / static_cast<double>(points.size()) - mean_rad * mean_rad;
  return variance < kOneAngle * kOneAngle;
}

/// Of normals that are all square to an axis.
std::string cylinder_name(std::span<const PointWithNormal> points,
                          const Vector3d& axis,
                          double pixel_mm,
                          double facet_rad) {
  const MatrixXd across = across_of(axis);
  const RadiusFit round = facet_rad > 0.0 ? fit_facets(points, across) : fit_radius(points, across);
  if (!is_good(round, pixel_mm)) {
    return "curved surface" + about(axis, "along");
  }
  return fmt::format("{} of radius {:.1f} mm{}",
                     round.radius_mm > 0.0 ? "cylinder" : "bore",
                     std::abs(round.radius_mm) / std::cos(0.5 * facet_rad),
                     about(axis, "along"));
}

std::string of_facets(double facet_rad) {
  return facet_rad > 0.0 ? fmt::format(" in facets of {:.0f} deg", facet_rad * kDegPerRad)
                         : std::string();
}

}  // namespace

std::string shape_name(std::span<const PointWithNormal> points, double pixel_mm, double facet_rad) {
  const Vector3d mean = mean_normal(points);
  const Matrix3d spread = spread_of_normals(points, mean);
  if (spread.trace() < kOneDirection * kOneDirection) {
    return plane_name(points, mean);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> directions(spread);
  const Vector3d axis = directions.eigenvectors().col(0);
  const bool is_turned = directions.eigenvalues()[0] < kOneAngle * kOneAngle;
  if (is_turned && std::abs(axis.dot(mean)) < kSquare) {
    return cylinder_name(points, axis, pixel_mm, facet_rad) + of_facets(facet_rad);
  }
  const RadiusFit ball = fit_radius(points, Matrix3d::Identity());
  if (is_good(ball, pixel_mm)) {
    return fmt::format("{} of radius {:.1f} mm",
                       ball.radius_mm > 0.0 ? "sphere" : "hollow sphere",
                       std::abs(ball.radius_mm));
  }
  return is_turned && is_cone(points, axis) ? "cone" + about(axis, "about") + of_facets(facet_rad)
                                            : "curved surface";
}

}  // namespace glint
