// SPDX-License-Identifier: GPL-3.0-or-later
//
// Renderings as two independent pictures of half the samples, and what is interpolated between
// renderings at several roughnesses. Private to the room.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Dense>

#include "core/image/image.h"

namespace glint::compare_detail {

/// Two independent pictures of one scene.
using Halves = std::array<ImageF, 2>;

struct Rendering {
  double roughness = 0.0;
  Halves grey;
};

inline ImageF mean_of(const Halves& halves) {
  ImageF mean = halves[0];
  std::ranges::transform(
      mean.values(), halves[1].values(), mean.values().begin(), [](float one, float other) {
        return 0.5F * (one + other);
      });
  return mean;
}

inline void subtract_mean(ImageF& picture, std::span<const std::size_t> pixels) {
  double sum = 0.0;
  for (const std::size_t pixel : pixels) {
    sum += static_cast<double>(picture.values()[pixel]);
  }
  const auto mean = static_cast<float>(sum / static_cast<double>(pixels.size()));
  for (float& value : picture.values()) {
    value -= mean;
  }
}

/// By the roughness, from one rendering to another.
inline Halves derivative_between(const Rendering& from, const Rendering& to) {
  const double step = to.roughness - from.roughness;
  Halves derivative = to.grey;
  for (std::size_t half = 0; half < 2; ++half) {
    std::ranges::transform(to.grey[half].values(),
                           from.grey[half].values(),
                           derivative[half].values().begin(),
                           [&](float after, float before) {
                             return static_cast<float>(static_cast<double>(after - before) / step);
                           });
  }
  return derivative;
}

/// Sum of the renderings' grey values times one weight each.
inline Halves weighted(std::span<const Rendering> renderings, std::span<const double> weights) {
  Halves sum = renderings.front().grey;
  for (std::size_t half = 0; half < 2; ++half) {
    for (std::size_t pixel = 0; pixel < sum[half].size(); ++pixel) {
      double value = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) {
        value += weights[i] * static_cast<double>(renderings[i].grey[half].values()[pixel]);
      }
      sum[half].values()[pixel] = static_cast<float>(value);
    }
  }
  return sum;
}

/// Grey values, and their derivative by the roughness, of the polynomial through all renderings.
struct Interpolated {
  Halves grey;
  Halves derivative;
};

/// Lagrange's polynomial. @param renderings  at different roughnesses
inline Interpolated interpolated(std::span<const Rendering> renderings, double roughness) {
  std::vector<double> weights(renderings.size(), 1.0);
  std::vector<double> slopes(renderings.size(), 0.0);
  for (std::size_t i = 0; i < renderings.size(); ++i) {
    for (std::size_t j = 0; j < renderings.size(); ++j) {
      if (j != i) {
        const double apart = renderings[i].roughness - renderings[j].roughness;
        const double factor = (roughness - renderings[j].roughness) / apart;
        slopes[i] = slopes[i] * factor + weights[i] / apart;
        weights[i] *= factor;
      }
    }
  }
  return {.grey = weighted(renderings, weights), .derivative = weighted(renderings, slopes)};
}

/// real = gain base + product derivative, product = gain times the change.
struct GreyFit {
  Eigen::Vector2d values = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d bound = Eigen::Matrix2d::Zero();  ///< of it, by the photograph's noise alone
  double rest = 0.0;                                ///< sum of squares

  double gain() const { return values[0]; }

  double change() const { return values[1] / values[0]; }

  double change_sigma() const { return change_sigma(covariance); }

  double change_bound() const { return change_sigma(bound); }

 private:
  double change_sigma(const Eigen::Matrix2d& of_values) const {
    const Eigen::Vector2d derivative(-change() / values[0], 1.0 / values[0]);
    return std::sqrt(derivative.dot(of_values * derivative));
  }
};

}  // namespace glint::compare_detail
