// SPDX-License-Identifier: GPL-3.0-or-later
//
// Improved Perlin noise: gradients at the corners of a lattice of period 256, blended by a quintic;
// coordinates are folded to the period before they become integers. Octaves are shifted, since each
// vanishes at its lattice points. Cost: eight gradients an octave and point.
// docs/theory/imprint.md, "Tools".
#include "defects/tools/tool_noise.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

/// Draws of a defect's seed that belong to its tool's noise: 256 channels from here on.
constexpr std::uint64_t kNoiseIndex = 0x746f6f6c00;

double fade(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double mix(double a, double b, double share) {
  return a + (b - a) * share;
}

}  // namespace

ToolNoise::ToolNoise(std::uint64_t seed, std::uint64_t channel, int octaves, double gain)
    : octaves_(octaves), gain_(gain) {
  Rng rng(seed, Stream::kDefects, kNoiseIndex + channel);
  std::iota(order_.begin(), order_.end(), std::uint8_t{0});
  for (std::size_t i = order_.size() - 1; i > 0; --i) {
    std::swap(order_[i], order_[rng.next_u32() % (i + 1)]);
  }
  for (Eigen::Vector3d& gradient : gradients_) {
    const double z = rng.uniform(-1.0, 1.0);
    const double turn = rng.uniform(0.0, 2.0 * kPi);
    const double r = std::sqrt(1.0 - z * z);
    gradient = {r * std::cos(turn), r * std::sin(turn), z};
  }
}

double ToolNoise::corner(const std::array<int, 3>& cell, const Eigen::Vector3d& offset) const {
  std::size_t hash = 0;
  for (const int c : cell) {
    hash = order_[(hash + static_cast<std::size_t>(c & 255)) & 255U];
  }
  return gradients_[hash].dot(offset);
}

double ToolNoise::octave(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d base = p.array().floor();
  const Eigen::Vector3d at = p - base;
  std::array<double, 8> corners = {};
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3d step(c & 1, (c >> 1) & 1, (c >> 2) & 1);
    std::array<int, 3> cell = {};
    for (int axis = 0; axis < 3; ++axis) {
      // Folded to the period of the table first, so that far coordinates fit an int.
      const double folded = std::fmod(base[axis] + step[axis], 256.0);
      cell[static_cast<std::size_t>(axis)] = static_cast<int>(folded) + 256;
    }
    corners[static_cast<std::size_t>(c)] = corner(cell, at - step);
  }
  const double x = fade(at.x());
  const double y = fade(at.y());
  return mix(mix(mix(corners[0], corners[1], x), mix(corners[2], corners[3], x), y),
             mix(mix(corners[4], corners[5], x), mix(corners[6], corners[7], x), y),
             fade(at.z()));
}

double ToolNoise::operator()(const Eigen::Vector3d& p) const {
  double sum = 0.0;
  double amplitude = 1.0;
  double frequency = 1.0;
  for (int i = 0; i < octaves_; ++i) {
    // Shifted, because every octave is zero at the corners of its lattice.
    sum += amplitude * octave(frequency * p + Eigen::Vector3d::Constant(0.37 + 17.31 * i));
    amplitude *= gain_;
    frequency *= 2.0;
  }
  return sum;
}

void standardise(std::vector<double>& values) {
  if (values.empty()) {
    return;
  }
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0.0;
  for (double& value : values) {
    value -= mean;
    squares += value * value;
  }
  const double rms = std::sqrt(squares / count);
  for (double& value : values) {
    value = rms > 0.0 ? value / rms : 0.0;
  }
}

}  // namespace glint
