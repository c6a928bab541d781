// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of all rays of a grid: summed at 3 x 3 nodes of squares of 32 x 32 rays and
// interpolated to second order between, where surface and light allow it; else squares are cut in
// four, down to single rays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulator/render/direct/pixel_rays.h"
#include "simulator/render/direct/point_light.h"

namespace glint {

/// Works on one grid at a time; one a thread.
class GridLight {
 public:
  GridLight(const PathTask& task, const PointLight& light, const DirectSettings& settings);

  /// @param is_interpolated  false: light is summed for each ray
  void look_at(const PixelRays& grid, bool is_interpolated);

  /// Radiance of a ray by light group at factor 1, and channel.
  std::span<const float> of(std::size_t ray) const;

  const DirectCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kNodes = 9;

  /// Three rays in a line: ends and middle.
  using Line = std::array<int, 3>;

  struct Square {
    Line x, y;
    int size = 1;
  };

  using Shares = std::array<double, kNodes>;

  Shares shares_at(const Square& square, int x, int y) const;
  std::size_t node(const Square& square, std::size_t index) const;
  std::span<float> numbers(std::size_t ray);
  void sum_at(std::size_t ray);
  void fill(int x, int y, int size);
  bool is_even(const Square& square) const;
  bool is_near(const Square& square, int x, int y) const;
  bool is_summed_light(const Square& square, int x, int y);
  void interpolate(const Square& square, int x, int y, std::span<float> to);
  void interpolate_all(const Square& square);
  void finish(std::size_t ray);

  const PathTask& task_;
  const PointLight& light_;
  double allowed_;
  double turn_;  ///< allowed of normals
  bool has_tangents_;
  const PixelRays* grid_ = nullptr;
  std::vector<float> numbers_;
  std::vector<std::uint8_t> is_summed_;
  DirectLight::Scratch scratch_;
  DirectCounts counts_;
};

}  // namespace glint
