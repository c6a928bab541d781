// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rows are drawn by their share of the light (radiance times solid angle), then a pixel of the row,
// by bisection in running sums; within the pixel directions are uniform in solid angle (in z and
// azimuth). So density is exactly proportional to grey radiance. Source: M. Pharr, W. Jakob, G.
// Humphreys, "Physically based rendering", 12.5 (infinite area lights). Cost: two bisections a
// sample; the sums are built once. docs/theory/lights.md
#include "simulator/light/area/environment.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;

double grey(const std::array<float, 3>& c) {
  return (static_cast<double>(c[0]) + static_cast<double>(c[1]) + static_cast<double>(c[2])) / 3.0;
}

/// Divides running sums by the last one; all zero stays all zero.
void normalise(double* sums, std::size_t count) {
  const double total = sums[count - 1];
  for (std::size_t i = 0; i < count && total > 0.0; ++i) {
    sums[i] /= total;
  }
}

double share_of(const double* sums, std::size_t index) {
  return sums[index] - (index > 0 ? sums[index - 1] : 0.0);
}

/// The entry that u falls into, and where in it.
struct Drawn {
  std::size_t index = 0;
  double rest = 0.0;
};

Drawn draw(const double* sums, std::size_t count, double u) {
  const auto index = static_cast<std::size_t>(std::upper_bound(sums, sums + count - 1, u) - sums);
  const double share = share_of(sums, index);
  const double rest = (u - (sums[index] - share)) / share;
  return {.index = index, .rest = share > 0.0 ? std::clamp(rest, 0.0, 1.0) : 0.5};
}

}  // namespace

Environment::Environment(const Array3f& radiance)
    : Environment(1, 1, {{radiance[0], radiance[1], radiance[2]}}) {}

Environment::Environment(int width, int height, std::vector<std::array<float, 3>> radiance)
    : width_(static_cast<std::size_t>(width)),
      height_(static_cast<std::size_t>(height)),
      radiance_(std::move(radiance)),
      sums_(radiance_.size()),
      row_sums_(height_) {
  GLINT_CHECK(width > 0 && height > 0 && radiance_.size() == width_ * height_, "a whole picture");
  double total = 0.0;
  for (std::size_t y = 0; y < height_; ++y) {
    double sum = 0.0;
    for (std::size_t x = 0; x < width_; ++x) {
      sum += grey(radiance_[y * width_ + x]) * pixel_solid_angle_sr(y * width_ + x);
      sums_[y * width_ + x] = sum;
    }
    normalise(&sums_[y * width_], width_);
    total += sum;
    row_sums_[y] = total;
  }
  mean_radiance_ = total / (4.0 * kPi);
  normalise(row_sums_.data(), height_);
}

double Environment::pixel_solid_angle_sr(std::size_t index) const {
  const double row = kPi / static_cast<double>(height_);
  const std::size_t above = index / width_;
  const double top = static_cast<double>(above) * row;
  return 2.0 * kPi / static_cast<double>(width_) * (std::cos(top) - std::cos(top + row));
}

Array3f Environment::pixel(std::size_t index) const {
  return {radiance_[index][0], radiance_[index][1], radiance_[index][2]};
}

double Environment::pixel_share(std::size_t index) const {
  const std::size_t row = index / width_;
  return share_of(row_sums_.data(), row) * share_of(&sums_[row * width_], index % width_);
}

std::size_t Environment::pixel_of(const Vector3d& d) const {
  const double polar = std::acos(std::clamp(d.z(), -1.0, 1.0)) / kPi;
  const double turns = std::atan2(d.y(), d.x()) / (2.0 * kPi);
  const double x = (turns - std::floor(turns)) * static_cast<double>(width_);
  const double y = polar * static_cast<double>(height_);
  return std::min(static_cast<std::size_t>(y), height_ - 1) * width_ +
         std::min(static_cast<std::size_t>(x), width_ - 1);
}

Array3f Environment::radiance(const Vector3d& direction) const {
  return pixel(pixel_of(direction));
}

double Environment::density(const Vector3d& direction) const {
  const std::size_t index = pixel_of(direction);
  return pixel_share(index) / pixel_solid_angle_sr(index);
}

Environment::Sample Environment::sample(double u, double v) const {
  if (!(mean_radiance_ > 0.0)) {
    return {};
  }
  const Drawn row = draw(row_sums_.data(), height_, u);
  const Drawn column = draw(&sums_[row.index * width_], width_, v);
  const double step = kPi / static_cast<double>(height_);
  const double top = std::cos(static_cast<double>(row.index) * step);
  const double bottom = std::cos(static_cast<double>(row.index + 1) * step);
  const double z = top + row.rest * (bottom - top);
  const double radius = std::sqrt(std::max(0.0, (1.0 - z) * (1.0 + z)));
  const double phi =
      2.0 * kPi * (static_cast<double>(column.index) + column.rest) / static_cast<double>(width_);
  const std::size_t index = row.index * width_ + column.index;
  return {.direction = {radius * std::cos(phi), radius * std::sin(phi), z},
          .radiance = pixel(index),
          .density = pixel_share(index) / pixel_solid_angle_sr(index)};
}

}  // namespace glint
