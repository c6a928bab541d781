// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/edge_spread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace glint::acquisition_detail {
namespace {

constexpr double kFine_px = 1.0;               ///< keeps noise from making edges
constexpr double kCoarse_px = 3.0;             ///< against which slopes are compared
constexpr double kDifference_px2 = 1.0 / 3.0;  ///< variance of the box of a central difference
constexpr double kStrong = 0.3;                ///< of the steepest edges' slope
constexpr double kMinSlope = 0.5;              ///< codes a pixel: rounding alone makes less
constexpr double kNoises = 8.0;                ///< that a slope must be above the noise's
constexpr std::size_t kMin = 40;
constexpr std::size_t kMaxNoiseSamples = 100'000;

/// Weights of a Gaussian, of its middle and one side.
std::vector<float> weights_of(double sigma_px) {
  std::vector<float> weights(static_cast<std::size_t>(std::ceil(3.5 * sigma_px)) + 1);
  float sum = 0.0F;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double z = static_cast<double>(i) / sigma_px;
    weights[i] = static_cast<float>(std::exp(-0.5 * z * z));
    sum += (i == 0 ? 1.0F : 2.0F) * weights[i];
  }
  std::ranges::for_each(weights, [sum](float& weight) { weight /= sum; });
  return weights;
}

/// Blurred along rows, and written with rows and columns exchanged; the border goes on outside.
template <class Value>
ImageF blurred_across(const Image<Value>& picture, const std::vector<float>& weights) {
  ImageF blurred(picture.height(), picture.width());
  const int reach = static_cast<int>(weights.size()) - 1;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      float sum = weights[0] * static_cast<float>(picture(x, y));
      for (int k = 1; k <= reach; ++k) {
        const auto left = static_cast<float>(picture(std::max(0, x - k), y));
        const auto right = static_cast<float>(picture(std::min(picture.width() - 1, x + k), y));
        sum += weights[static_cast<std::size_t>(k)] * (left + right);
      }
      blurred(y, x) = sum;
    }
  }
  return blurred;
}

ImageF blurred(const Image<std::uint16_t>& codes, double sigma_px) {
  const std::vector<float> weights = weights_of(sigma_px);
  return blurred_across(blurred_across(codes, weights), weights);
}

struct Slope {
  double x = 0.0;
  double y = 0.0;

  double size() const { return std::hypot(x, y); }
};

Slope slope_at(const ImageF& picture, int x, int y) {
  return {.x = 0.5 * static_cast<double>(picture(x + 1, y) - picture(x - 1, y)),
          .y = 0.5 * static_cast<double>(picture(x, y + 1) - picture(x, y - 1))};
}

/// Whether the slope is the largest one along its own direction.
bool is_crest(const ImageF& picture, int x, int y, const Slope& slope) {
  const double size = slope.size();
  if (size <= 0.0) {
    return false;
  }
  const int dx = static_cast<int>(std::lround(slope.x / size));
  const int dy = static_cast<int>(std::lround(slope.y / size));
  return size >= slope_at(picture, x + dx, y + dy).size() &&
         size > slope_at(picture, x - dx, y - dy).size();
}

/// Standard deviation of what noise alone makes of a slope: the median of its two parts over the
/// picture, most of which is no edge.
double noise_slope(const ImageF& picture) {
  const std::size_t step = std::max<std::size_t>(1, picture.size() / kMaxNoiseSamples);
  const auto width = static_cast<std::size_t>(picture.width() - 2);
  const std::size_t count = width * static_cast<std::size_t>(picture.height() - 2);
  std::vector<double> parts;
  for (std::size_t i = 0; i < count; i += step) {
    const Slope slope =
        slope_at(picture, 1 + static_cast<int>(i % width), 1 + static_cast<int>(i / width));
    parts.push_back(std::abs(slope.x));
    parts.push_back(std::abs(slope.y));
  }
  const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
  std::ranges::nth_element(parts, middle);
  return *middle / 0.6745;
}

/// One pixel on an edge.
struct Crest {
  double slope = 0.0;
  double coarse_slope = 0.0;
};

std::vector<Crest> crests_in(const ImageF& fine,
                             const ImageF& coarse,
                             const Mask& band,
                             int factor) {
  constexpr int kBorder_px = 4;
  std::vector<Crest> crests;
  for (int y = kBorder_px; y + kBorder_px < fine.height(); ++y) {
    for (int x = kBorder_px; x + kBorder_px < fine.width(); ++x) {
      const bool is_inside = x / factor < band.width() && y / factor < band.height();
      if (!is_inside || band(x / factor, y / factor) == 0) {
        continue;
      }
      const Slope slope = slope_at(fine, x, y);
      if (is_crest(fine, x, y, slope)) {
        crests.push_back({.slope = slope.size(), .coarse_slope = slope_at(coarse, x, y).size()});
      }
    }
  }
  return crests;
}

/// The variance of the step that has these two slopes [px^2].
double variance_of(const Crest& crest) {
  const double ratio = crest.slope / std::max(crest.coarse_slope, 1e-9);
  const double square = std::max(1.0 + 1e-6, ratio * ratio);
  const double fine = kFine_px * kFine_px;
  const double coarse = kCoarse_px * kCoarse_px;
  return (coarse - square * fine) / (square - 1.0) - kDifference_px2;
}

}  // namespace

std::optional<double> edge_spread_px(const Image<std::uint16_t>& codes,
                                     const Mask& band,
                                     int factor) {
  constexpr int kMin_px = 16;
  if (codes.width() < kMin_px || codes.height() < kMin_px) {
    return std::nullopt;
  }
  const ImageF fine = blurred(codes, kFine_px);
  std::vector<Crest> crests = crests_in(fine, blurred(codes, kCoarse_px), band, factor);
  const double least = std::max(kMinSlope, kNoises * noise_slope(fine));
  std::erase_if(crests, [least](const Crest& crest) { return crest.slope < least; });
  if (crests.size() < kMin) {
    return std::nullopt;
  }
  constexpr double kSteepest = 0.95;
  const auto steep =
      crests.begin() + static_cast<std::ptrdiff_t>(kSteepest * static_cast<double>(crests.size()));
  std::ranges::nth_element(crests, steep, {}, &Crest::slope);
  const double strong = kStrong * steep->slope;
  std::vector<double> variances;
  for (const Crest& crest : crests) {
    if (crest.slope >= strong) {
      variances.push_back(variance_of(crest));
    }
  }
  if (variances.size() < kMin) {
    return std::nullopt;
  }
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::ranges::nth_element(variances, middle);
  return std::sqrt(std::max(0.0, *middle));
}

}  // namespace glint::acquisition_detail
