// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/direct/grid_light.h"

#include <algorithm>
#include <cmath>

#include "core/parabola.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr int kSquare = 32;
/// Largest distance of a normal from the interpolated one, in widths alpha of the lobe.
constexpr double kAllowedTurn = 0.005;
/// The same of a point, in distances from the camera times what normals may be off by.
constexpr double kAllowedMove = 0.1;

Vector3d vector_of_ray(const VectorLanes& lanes, std::size_t ray) {
  const std::size_t lane = ray % kPacketSize;
  return {static_cast<double>(lanes.x[lane]),
          static_cast<double>(lanes.y[lane]),
          static_cast<double>(lanes.z[lane])};
}

}  // namespace

GridLight::GridLight(const PathTask& task, const PointLight& light, const DirectSettings& settings)
    : task_(task),
      light_(light),
      allowed_(settings.interpolated),
      turn_(kAllowedTurn * static_cast<double>(std::min(task.metal->alpha_x, task.metal->alpha_y))),
      has_tangents_(task.metal->alpha_x != task.metal->alpha_y) {}

void GridLight::look_at(const PixelRays& grid, bool is_interpolated) {
  grid_ = &grid;
  const auto rays = static_cast<std::size_t>(grid.area.size());
  numbers_.assign(rays * light_.size(), 0.0F);
  is_summed_.assign(rays, 0);
  for (int y = 0; y < grid.area.height() && is_interpolated; y += kSquare) {
    for (int x = 0; x < grid.area.width(); x += kSquare) {
      fill(x, y, kSquare);
    }
  }
  for (std::size_t ray = 0; ray < rays; ++ray) {
    if (!is_interpolated && grid.ends[ray] == RayEnd::kPart) {
      sum_at(ray);
    }
    finish(ray);
  }
  counts_.rays += static_cast<std::int64_t>(rays);
}

std::span<const float> GridLight::of(std::size_t ray) const {
  return std::span(numbers_).subspan(ray * light_.size(), light_.size());
}

std::span<float> GridLight::numbers(std::size_t ray) {
  return std::span(numbers_).subspan(ray * light_.size(), light_.size());
}

GridLight::Shares GridLight::shares_at(const Square& square, int x, int y) const {
  const auto along = parabola_shares(square.x, x);
  const auto across = parabola_shares(square.y, y);
  Shares shares;
  for (std::size_t i = 0; i < kNodes; ++i) {
    shares[i] = along[i % 3] * across[i / 3];
  }
  return shares;
}

std::size_t GridLight::node(const Square& square, std::size_t index) const {
  return grid_->ray(square.x[index % 3], square.y[index / 3]);
}

void GridLight::sum_at(std::size_t ray) {
  if (is_summed_[ray] != 0) {
    return;
  }
  is_summed_[ray] = 1;
  counts_.places += light_.at(grid_->surface_of(ray), ray % kPacketSize, scratch_, numbers(ray));
  ++counts_.points;
}

void GridLight::fill(int x, int y, int size) {
  const int right = std::min(x + size, grid_->area.width()) - 1;
  const int bottom = std::min(y + size, grid_->area.height()) - 1;
  if (right < x || bottom < y) {
    return;
  }
  const Square square = {
      .x = {x, (x + right) / 2, right}, .y = {y, (y + bottom) / 2, bottom}, .size = size};
  if (size == 1) {
    if (grid_->ends[grid_->ray(x, y)] == RayEnd::kPart) {
      sum_at(grid_->ray(x, y));
    }
    return;
  }
  const int half_x = (square.x[0] + square.x[1]) / 2;
  const int half_y = (square.y[0] + square.y[1]) / 2;
  const int after_x = (square.x[1] + square.x[2] + 1) / 2;
  if (size > 2 && is_even(square) && is_summed_light(square, half_x, half_y) &&
      is_summed_light(square, after_x, half_y)) {
    interpolate_all(square);
    return;
  }
  for (int i = 0; i < 4; ++i) {
    fill(x + (i % 2) * size / 2, y + (i / 2) * size / 2, size / 2);
  }
}

bool GridLight::is_even(const Square& square) const {
  for (int y = square.y[0]; y <= square.y[2]; ++y) {
    for (int x = square.x[0]; x <= square.x[2]; ++x) {
      if (grid_->ends[grid_->ray(x, y)] != RayEnd::kPart) {
        return false;
      }
    }
  }
  for (int y = square.y[0]; y <= square.y[2]; ++y) {
    for (int x = square.x[0]; x <= square.x[2]; ++x) {
      if (!is_near(square, x, y)) {
        return false;
      }
    }
  }
  return true;
}

/// Whether the surface at a ray is the interpolated one.
bool GridLight::is_near(const Square& square, int x, int y) const {
  const std::size_t ray = grid_->ray(x, y);
  const SurfaceLanes& here = grid_->surface_of(ray);
  const Shares shares = shares_at(square, x, y);
  Vector3d normal = vector_of_ray(here.normal, ray);
  Vector3d tangent = vector_of_ray(here.tangent, ray);
  Vector3d point = vector_of_ray(here.point, ray);
  const double reach_mm = (point - task_.scene_from_camera.translation_mm).norm();
  const bool is_open = vector_of_ray(here.open, ray).squaredNorm() > 0.0;
  for (std::size_t i = 0; i < kNodes; ++i) {
    const std::size_t other = node(square, i);
    const SurfaceLanes& there = grid_->surface_of(other);
    normal -= shares[i] * vector_of_ray(there.normal, other);
    tangent -= shares[i] * vector_of_ray(there.tangent, other);
    point -= shares[i] * vector_of_ray(there.point, other);
    if (is_open != (vector_of_ray(there.open, other).squaredNorm() > 0.0)) {
      return false;
    }
  }
  return normal.norm() < turn_ && (!has_tangents_ || tangent.norm() < turn_) &&
         point.norm() < kAllowedMove * turn_ * reach_mm;
}

void GridLight::interpolate(const Square& square, int x, int y, std::span<float> to) {
  const Shares shares = shares_at(square, x, y);
  std::ranges::fill(to, 0.0F);
  for (std::size_t i = 0; i < kNodes; ++i) {
    if (shares[i] == 0.0) {
      continue;
    }
    const std::size_t ray = node(square, i);
    sum_at(ray);
    const std::span<const float> at_node = of(ray);
    for (std::size_t k = 0; k < to.size(); ++k) {
      to[k] += static_cast<float>(shares[i]) * at_node[k];
    }
  }
}

/// Whether the light that is summed at a ray is the interpolated one.
bool GridLight::is_summed_light(const Square& square, int x, int y) {
  const std::size_t ray = grid_->ray(x, y);
  std::vector<float> expected(light_.size());
  interpolate(square, x, y, expected);
  sum_at(ray);
  const std::span<const float> summed = of(ray);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    if (static_cast<double>(std::abs(expected[k] - summed[k])) > allowed_) {
      return false;
    }
  }
  return true;
}

void GridLight::interpolate_all(const Square& square) {
  for (std::size_t i = 0; i < kNodes; ++i) {
    sum_at(node(square, i));
  }
  for (int y = square.y[0]; y <= square.y[2]; ++y) {
    for (int x = square.x[0]; x <= square.x[2]; ++x) {
      const std::size_t ray = grid_->ray(x, y);
      if (is_summed_[ray] == 0) {
        interpolate(square, x, y, numbers(ray));
      }
    }
  }
}

/// Colours and stains, which change from ray to ray; lights that are seen themselves.
void GridLight::finish(std::size_t ray) {
  const std::size_t lane = ray % kPacketSize;
  const auto channels = static_cast<std::size_t>(task_.settings.channels);
  const std::span<float> to = numbers(ray);
  if (grid_->ends[ray] == RayEnd::kLight) {
    const LightHitLanes& light = grid_->light_of(ray);
    const auto group = static_cast<std::size_t>(light.group[lane]);
    for (std::size_t c = 0; c < channels && light.cosine[lane] > 0.0F; ++c) {
      to[group * channels + c] = light.radiance.c[c][lane];
    }
  }
  if (grid_->ends[ray] != RayEnd::kPart) {
    return;
  }
  const SurfaceLanes& surface = grid_->surface_of(ray);
  const RigidTransform& pose = task_.scene.part.scene_from_part;
  const Vector3d point_mm =
      pose.rotation.transpose() * (vector_of_ray(surface.point, ray) - pose.translation_mm);
  const bool has_pattern = task_.scene.material.has_pattern();
  const Colour colour =
      has_pattern ? task_.scene.material.texel_at(point_mm).colour : Colour::Ones();
  for (std::size_t k = 0; k < to.size(); ++k) {
    to[k] *= surface.reflectance[lane] *
             static_cast<float>(colour[static_cast<Eigen::Index>(k % channels)]);
  }
}

}  // namespace glint
