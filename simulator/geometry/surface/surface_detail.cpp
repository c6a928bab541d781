// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/surface_detail.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/error.h"
#include "core/units.h"
#include "simulator/geometry/surface/micro_relief.h"

namespace glint {
namespace {

using Eigen::Vector3d;

double reach_mm(const HeightFeature& feature) {
  return SurfaceDetail::kReachRadii * 2.0 * feature.cross_sigma_mm();
}

/// A point in a feature's frame, with u as the distance beyond the ends of its line.
struct LocalPoint {
  double u_mm = 0.0;
  double v_mm = 0.0;
  double w_mm = 0.0;
  double along_mm = 0.0;  ///< u from the centre

  double distance_mm() const { return std::hypot(u_mm, v_mm); }
};

LocalPoint to_local(const HeightFeature& feature, const Vector3d& p_mm) {
  const Vector3d d = p_mm - feature.centre_mm;
  const double along = d.dot(feature.u_axis);
  const double beyond = std::max(0.0, std::abs(along) - feature.half_line_mm());
  return {.u_mm = std::copysign(beyond, along),
          .v_mm = d.dot(feature.v_axis),
          .w_mm = d.dot(feature.normal),
          .along_mm = along};
}

void check_feature(const HeightFeature& feature) {
  const auto is_size = [](double value) { return std::isfinite(value) && value > 0.0; };
  const bool is_valid = std::isfinite(feature.height_mm) && feature.centre_mm.allFinite() &&
                        (feature.kind == HeightFeature::Kind::kGaussian
                             ? is_size(feature.sigma_mm)
                             : is_size(feature.length_mm) && is_size(feature.width_mm));
  if (!is_valid) {
    throw ConfigError(fmt::format(
        "defect \"{}\": height and place must be numbers, sizes must be > 0", feature.label));
  }
  const auto is_between = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  if (!is_between(feature.reflectance, 0.0, 1.0) ||
      !is_between(feature.roughness_rad, 0.0, 0.5 * kPi)) {
    throw ConfigError(fmt::format(
        "defect \"{}\": reflectance must be 0 to 1, roughness 0 to 90 degrees", feature.label));
  }
}

/// How much of a stain there is: 1 inside, 0 outside, a smooth edge between.
double stain_share(double radii) {
  constexpr double kRim = SurfaceDetail::kStainRim;
  const double t = std::clamp((1.0 + kRim - radii) / (2.0 * kRim), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

void add_stain(const HeightFeature& feature,
               const LocalPoint& local,
               double radii,
               SurfaceDetail::Relief relief,
               SurfaceDetail::Sample& sample) {
  const double share = stain_share(radii);
  if (share == 0.0) {
    return;
  }
  sample.reflectance *= 1.0 - share * (1.0 - feature.reflectance);
  if (feature.roughness_rad > 0.0 && relief == SurfaceDetail::Relief::kWith) {
    const Eigen::Vector2d slope = relief_slope(local.along_mm, local.v_mm, feature.id);
    sample.gradient +=
        share * feature.roughness_rad * (slope.x() * feature.u_axis + slope.y() * feature.v_axis);
  }
}

/// A box around everything a feature reaches, wide along the normal for curved surfaces.
BoundingBox box_of(const HeightFeature& feature) {
  const double reach = reach_mm(feature);
  const double along = feature.half_line_mm() + reach;
  const Vector3d half = along * feature.u_axis.cwiseAbs() + reach * feature.v_axis.cwiseAbs() +
                        along * feature.normal.cwiseAbs();
  return {.min_mm = feature.centre_mm - half, .max_mm = feature.centre_mm + half};
}

int clamped_cell(double position, int count) {
  return static_cast<int>(std::clamp(position, 0.0, static_cast<double>(count - 1)));
}

}  // namespace

double HeightFeature::half_line_mm() const {
  return kind == Kind::kGaussian ? 0.0 : std::max(0.0, 0.5 * (length_mm - width_mm));
}

double HeightFeature::max_slope_rad() const {
  return std::abs(height_mm) / (cross_sigma_mm() * std::sqrt(std::exp(1.0)));
}

SurfaceDetail::SurfaceDetail(std::vector<HeightFeature> features) : features_(std::move(features)) {
  std::ranges::for_each(features_, check_feature);
  build_grid();
}

void SurfaceDetail::build_grid() {
  for (const HeightFeature& feature : features_) {
    const BoundingBox box = box_of(feature);
    box_.min_mm = box_.min_mm.cwiseMin(box.min_mm);
    box_.max_mm = box_.max_mm.cwiseMax(box.max_mm);
  }
  if (features_.empty()) {
    return;
  }
  const double target = std::clamp(64.0 * static_cast<double>(features_.size()), 64.0, 32768.0);
  const Vector3d size_mm = box_.size_mm();
  const double edge_mm = std::cbrt(size_mm.prod() / target);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double count = std::clamp(std::round(size_mm[k] / edge_mm), 1.0, 256.0);
    num_cells_[static_cast<std::size_t>(k)] = static_cast<int>(count);
    cells_per_mm_[k] = count / size_mm[k];
  }
  const auto num_cells = static_cast<std::size_t>(num_cells_[0] * num_cells_[1] * num_cells_[2]);
  std::vector<std::vector<std::int32_t>> lists(num_cells);
  for (std::size_t i = 0; i < features_.size(); ++i) {
    for (const int cell : cells_in(box_of(features_[i]))) {
      lists[static_cast<std::size_t>(cell)].push_back(static_cast<std::int32_t>(i));
    }
  }
  cell_begin_.push_back(0);
  for (const auto& list : lists) {
    cell_features_.insert(cell_features_.end(), list.begin(), list.end());
    cell_begin_.push_back(static_cast<std::int32_t>(cell_features_.size()));
  }
}

std::vector<int> SurfaceDetail::cells_in(const BoundingBox& box) const {
  const std::array<int, 3> low = coordinates_of(box.min_mm);
  const std::array<int, 3> high = coordinates_of(box.max_mm);
  std::vector<int> cells;
  for (int z = low[2]; z <= high[2]; ++z) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int x = low[0]; x <= high[0]; ++x) {
        cells.push_back((z * num_cells_[1] + y) * num_cells_[0] + x);
      }
    }
  }
  return cells;
}

std::array<int, 3> SurfaceDetail::coordinates_of(const Vector3d& p_mm) const {
  const Vector3d q = (p_mm - box_.min_mm).cwiseProduct(cells_per_mm_);
  return {clamped_cell(q.x(), num_cells_[0]),
          clamped_cell(q.y(), num_cells_[1]),
          clamped_cell(q.z(), num_cells_[2])};
}

/// -1 outside of everything.
int SurfaceDetail::cell_of(const Vector3d& p_mm) const {
  if (!(p_mm.array() >= box_.min_mm.array()).all() ||
      !(p_mm.array() <= box_.max_mm.array()).all()) {
    return -1;
  }
  const auto [x, y, z] = coordinates_of(p_mm);
  return (z * num_cells_[1] + y) * num_cells_[0] + x;
}

SurfaceDetail::Sample SurfaceDetail::sample(const Vector3d& p_mm,
                                            const Vector3d& normal,
                                            Relief relief) const {
  Sample sample;
  const int cell = cell_of(p_mm);
  if (cell < 0) {
    return sample;
  }
  const auto begin = cell_begin_[static_cast<std::size_t>(cell)];
  const auto end = cell_begin_[static_cast<std::size_t>(cell) + 1];
  for (std::int32_t i = begin; i < end; ++i) {
    const auto number = static_cast<std::size_t>(cell_features_[static_cast<std::size_t>(i)]);
    const HeightFeature& feature = features_[number];
    const LocalPoint local = to_local(feature, p_mm);
    const double sigma_mm = feature.cross_sigma_mm();
    const double radii = local.distance_mm() / (2.0 * sigma_mm);
    if (radii > kReachRadii || normal.dot(feature.normal) <= 0.0 ||
        std::abs(local.w_mm) > feature.half_line_mm() + reach_mm(feature)) {
      continue;
    }
    const double height_mm = feature.height_mm * std::exp(-2.0 * radii * radii);
    sample.height_mm += height_mm;
    sample.moved_height_mm += feature.moves_position ? height_mm : 0.0;
    sample.gradient -= height_mm / (sigma_mm * sigma_mm) *
                       (local.u_mm * feature.u_axis + local.v_mm * feature.v_axis);
    if (feature.is_stain()) {
      add_stain(feature, local, radii, relief, sample);
    }
    if (sample.feature < 0 || radii < sample.normalised_distance) {
      sample.feature = feature.id;
      sample.normalised_distance = radii;
    }
  }
  return sample;
}

/// With the tilt a of the normal towards -e (e = direction of the gradient), A = -d.n > 0 and
/// B = d.e, the mirrored ray rises above the surface by r.n = A cos 2a + B sin 2a: positive while
/// 2a < pi/2 + atan2(B, A).
Vector3d detailed_normal(const Vector3d& normal,
                         const Vector3d& gradient,
                         const Vector3d& ray_direction) {
  const Vector3d tangential = gradient - gradient.dot(normal) * normal;
  const double slope = tangential.norm();
  const double rise = -ray_direction.dot(normal);
  if (!(slope > 0.0) || !(rise > 0.0)) {
    return normal;
  }
  const Vector3d e = tangential / slope;
  constexpr double kMargin_rad = 1e-9;
  const double largest_rad =
      0.25 * kPi + 0.5 * std::atan2(ray_direction.dot(e), rise) - kMargin_rad;
  const double tilt_rad = std::clamp(std::atan(slope), 0.0, std::max(0.0, largest_rad));
  return (std::cos(tilt_rad) * normal - std::sin(tilt_rad) * e).normalized();
}

std::optional<SurfacePlace> place_on_surface(
    const Part& part, const Bvh& bvh, double x_mm, double y_mm, double angle_rad) {
  const BoundingBox& box = part.box_in_part_mm;
  const double above_mm = 1.0 + box.size_mm().z();
  const Eigen::Matrix3d& rotation = part.scene_from_part.rotation;
  const Ray ray = {
      .origin_mm = part.scene_from_part * Vector3d(x_mm, y_mm, box.max_mm.z() + above_mm),
      .direction = -rotation.col(2)};
  const Hit hit = bvh.intersect(ray.origin_mm, ray.direction, 0.0, 3.0 * above_mm);
  if (!hit) {
    return std::nullopt;
  }
  SurfacePlace place = {.centre_mm = hit_point(part.mesh, hit),
                        .normal = shading_normal(part.mesh, hit)};
  const std::int32_t patch = part.mesh.patch_of(static_cast<std::size_t>(hit.triangle));
  if (patch >= 0) {
    constexpr double kMaxMove_mm = 0.1;
    const auto exact = polish(part.patches[static_cast<std::size_t>(patch)],
                              ray,
                              static_cast<double>(hit.t_mm),
                              kMaxMove_mm);
    if (exact) {
      place.centre_mm = exact->point_mm;
      place.normal = exact->normal;
    }
  }
  const bool is_along_x = std::abs(place.normal.dot(rotation.col(0))) > 0.999;
  const Vector3d axis = is_along_x ? rotation.col(1) : rotation.col(0);
  const Vector3d u = (axis - axis.dot(place.normal) * place.normal).normalized();
  const Vector3d v = place.normal.cross(u);
  place.u_axis = std::cos(angle_rad) * u + std::sin(angle_rad) * v;
  place.v_axis = place.normal.cross(place.u_axis);
  return place;
}

}  // namespace glint
