// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/facet_fans.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <Eigen/Dense>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kEqualAngles_rad = 1.0 * kRadPerDeg;
constexpr double kRestAngle_rad = 2.0 * kRadPerDeg;  ///< rms; pixels at its rim mix other normals
constexpr double kMinStep_rad = 2.0 * kRadPerDeg;
constexpr double kMinAcross = 0.1;  ///< of a normal square to the axis: a flatter cone is a plane
constexpr double kRadiusShare = 0.02;
constexpr double kWidest = 2.0;  ///< of a facet's share; a cone is wider at its foot
constexpr std::size_t kMinFacets = 4;

Vector3d across(const RoundShape& shape, const Vector3d& normal) {
  return normal - shape.axis.dot(normal) * shape.axis;
}

/// About the axis, from one normal to another.
double turn_rad(const RoundShape& shape, const Vector3d& from, const Vector3d& to) {
  const Vector3d a = across(shape, from);
  const Vector3d b = across(shape, to);
  return std::atan2(shape.axis.dot(a.cross(b)), a.dot(b));
}

/// @returns nothing where they are not turned by equal angles about an axis
std::optional<RoundShape> shape_of(const FlatPiece& first,
                                   const FlatPiece& second,
                                   const FlatPiece& third) {
  const Vector3d axis = (second.normal - first.normal).cross(third.normal - second.normal);
  if (axis.norm() < 1e-6) {
    return std::nullopt;
  }
  RoundShape shape = {.axis = axis.normalized()};
  shape.along = shape.axis.dot(second.normal);
  shape.step_rad = turn_rad(shape, first.normal, second.normal);
  const double next_rad = turn_rad(shape, second.normal, third.normal);
  if (across(shape, second.normal).norm() < kMinAcross || shape.step_rad < kMinStep_rad ||
      shape.step_rad > kMaxFacetStep_rad ||
      std::abs(next_rad - shape.step_rad) > kEqualAngles_rad) {
    return std::nullopt;
  }
  const Vector3d& origin = second.middle_mm;
  const Vector3d u = shape.axis.unitOrthogonal();
  const Vector3d v = shape.axis.cross(u);
  Matrix3d rows;
  Vector3d right;
  int row = 0;
  for (const FlatPiece* piece : {&first, &second, &third}) {
    rows.row(row) << piece->normal.dot(u), piece->normal.dot(v), 1.0;
    right[row++] = piece->normal.dot(piece->middle_mm - origin);
  }
  const Vector3d values = rows.fullPivLu().solve(right);
  shape.centre_mm = origin + values[0] * u + values[1] * v;
  shape.distance_mm = values[2];
  return shape;
}

/// Facets of one shape, by how many steps they are from the first.
class Fan {
 public:
  Fan(std::span<const FlatPiece> pieces, const RoundShape& shape, double pixel_mm)
      : pieces_(pieces), shape_(shape), pixel_mm_(pixel_mm) {}

  /// Whether a piece is a facet of the shape, wherever on it.
  bool is_facet(std::size_t index) const {
    const FlatPiece& piece = pieces_[index];
    const Vector3d outward = across(shape_, piece.normal);
    if (std::abs(shape_.axis.dot(piece.normal) - shape_.along) > kEqualAngles_rad ||
        outward.norm() < kMinAcross) {
      return false;
    }
    const double distance_mm = piece.normal.dot(piece.middle_mm - shape_.centre_mm);
    const double limit_mm = pixel_mm_ + kRadiusShare * shape_.radius_mm();
    return std::abs(distance_mm - shape_.distance_mm) < limit_mm &&
           width_mm(piece, outward.normalized()) <
               kWidest * 2.0 * shape_.radius_mm() * std::tan(0.5 * shape_.step_rad);
  }

  /// Adds a facet and those that follow by neighbours.
  void grow(std::size_t from, const std::vector<std::vector<std::size_t>>& beside) {
    steps_[from] = 0;
    std::vector<std::size_t> open = {from};
    while (!open.empty()) {
      const std::size_t index = open.back();
      open.pop_back();
      for (const std::size_t next : beside[index]) {
        const double turned_rad = turn_rad(shape_, pieces_[index].normal, pieces_[next].normal);
        const bool is_step = std::abs(std::abs(turned_rad) - shape_.step_rad) < kEqualAngles_rad;
        if (is_step && !steps_.contains(next) && is_facet(next)) {
          steps_[next] = steps_[index] + (turned_rad > 0.0 ? 1 : -1);
          open.push_back(next);
        }
      }
    }
  }

  std::size_t facets() const {
    std::set<int> places;
    for (const auto& [index, step] : steps_) {
      places.insert(step);
    }
    return places.size();
  }

  FacetFan found() const {
    FacetFan fan = {.pieces = {}, .shape = shape_};
    for (const auto& [index, step] : steps_) {
      fan.pieces.push_back(index);
    }
    return fan;
  }

 private:
  /// Extent around the axis.
  double width_mm(const FlatPiece& piece, const Vector3d& outward) const {
    const Vector3d around = shape_.axis.cross(outward);
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const Vector3d& point : piece.points_mm) {
      least = std::min(least, around.dot(point));
      most = std::max(most, around.dot(point));
    }
    return most - least;
  }

  std::span<const FlatPiece> pieces_;
  RoundShape shape_;
  double pixel_mm_;
  std::map<std::size_t, int> steps_;
};

class FanFinder {
 public:
  FanFinder(std::span<const FlatPiece> pieces,
            std::span<const std::pair<std::size_t, std::size_t>> neighbours,
            double pixel_mm)
      : pieces_(pieces), pixel_mm_(pixel_mm), beside_(pieces.size()) {
    for (const auto& [one, other] : neighbours) {
      if (pieces[one].normal.dot(pieces[other].normal) > std::cos(kMaxFacetStep_rad)) {
        beside_[one].push_back(other);
        beside_[other].push_back(one);
      }
    }
  }

  std::vector<FacetFan> find() {
    std::vector<FacetFan> fans;
    for (std::size_t middle = 0; middle < pieces_.size(); ++middle) {
      if (auto fan = fan_around(middle)) {
        for (const std::size_t index : fan->pieces) {
          take(index);
        }
        fans.push_back(std::move(*fan));
      }
    }
    return fans;
  }

 private:
  std::optional<FacetFan> fan_around(std::size_t middle) const {
    for (const std::size_t first : beside_[middle]) {
      for (const std::size_t third : beside_[middle]) {
        const auto shape = shape_of(pieces_[first], pieces_[middle], pieces_[third]);
        if (!shape) {
          continue;
        }
        Fan fan(pieces_, *shape, pixel_mm_);
        if (fan.is_facet(middle)) {
          fan.grow(middle, beside_);
        }
        if (fan.facets() >= kMinFacets) {
          return fan.found();
        }
      }
    }
    return std::nullopt;
  }

  /// It is nobody's neighbour any more.
  void take(std::size_t index) {
    for (const std::size_t other : beside_[index]) {
      std::erase(beside_[other], index);
    }
    beside_[index].clear();
  }

  std::span<const FlatPiece> pieces_;
  double pixel_mm_;
  std::vector<std::vector<std::size_t>> beside_;
};

}  // namespace

double RoundShape::radius_mm() const {
  return std::abs(distance_mm) / std::sqrt(std::max(1.0 - along * along, kMinAcross * kMinAcross));
}

bool RoundShape::holds(std::span<const PointWithNormal> points, double pixel_mm) const {
  double missed = 0.0;
  double turned = 0.0;
  for (const PointWithNormal& point : points) {
    const double off_mm = point.normal.dot(point.at_mm - centre_mm) - distance_mm;
    const double off = axis.dot(point.normal) - along;
    missed += off_mm * off_mm;
    turned += off * off;
  }
  const auto count = static_cast<double>(points.size());
  return std::sqrt(missed / count) < pixel_mm + kRadiusShare * radius_mm() &&
         std::sqrt(turned / count) < kRestAngle_rad;
}

std::vector<FacetFan> facet_fans(std::span<const FlatPiece> pieces,
                                 std::span<const std::pair<std::size_t, std::size_t>> neighbours,
                                 double pixel_mm) {
  return FanFinder(pieces, neighbours, pixel_mm).find();
}

}  // namespace glint
