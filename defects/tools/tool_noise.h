// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// Fractal gradient noise in space, from a seed: octaves of twice the frequency and `gain` times
/// the amplitude each. Smooth (twice differentiable), features of about the unit length.
///
/// Source: K. Perlin, "Improving noise", SIGGRAPH 2002, with gradients drawn from the sphere.
class ToolNoise {
 public:
  /// @param channel  noises of one seed and different channels are independent
  ToolNoise(std::uint64_t seed, std::uint64_t channel, int octaves, double gain);

  double operator()(const Eigen::Vector3d& p) const;

 private:
  double octave(const Eigen::Vector3d& p) const;
  double corner(const std::array<int, 3>& cell, const Eigen::Vector3d& offset) const;

  std::array<std::uint8_t, 256> order_ = {};
  std::array<Eigen::Vector3d, 256> gradients_ = {};
  int octaves_ = 1;
  double gain_ = 0.5;
};

/// Shifts and scales the values to mean 0 and root mean square 1; all 0 when they do not differ.
void standardise(std::vector<double>& values);

}  // namespace glint
