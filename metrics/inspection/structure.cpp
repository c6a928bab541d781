// SPDX-License-Identifier: GPL-3.0-or-later
//
// The smaller eigenvalue of the structure tensor (W. Foerstner and E. Guelch 1987; J. Shi and C.
// Tomasi, "Good features to track", CVPR 1994) of the logarithm of a picture, by normalised
// convolution inside a mask. Of the logarithm, for light of half the strength halves all grey
// values of a reflecting surface and leaves this as it is. Cost: seven separable convolutions,
// one of them three windows wide. Memory: some ten pictures.
#include "metrics/inspection/structure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "metrics/inspection/masked_filter.h"

namespace glint {
namespace {

constexpr double kDarkest = 0.03;      ///< added to grey values: below, noise is all that varies
constexpr double kSmoothing_px = 1.0;  ///< sigma before the derivatives, against pixel noise
constexpr double kSurroundings = 3.0;  ///< sigma of what a window is compared with, in windows

HalfKernel kernel_of(double sigma_px) {
  return gaussian_kernel(sigma_px, static_cast<int>(std::ceil(3.0 * sigma_px)));
}

/// 1 inside the mask.
ImageF inside_of(const Mask& mask) {
  ImageF inside(mask.width(), mask.height());
  std::ranges::transform(mask.values(), inside.values().begin(), [](unsigned char value) {
    return value != 0 ? 1.0F : 0.0F;
  });
  return inside;
}

/// 0 outside the mask.
ImageF logarithm_of(const ImageF& picture, const Mask& mask) {
  ImageF logarithm(mask.width(), mask.height());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] != 0) {
      const double grey = std::max(0.0, static_cast<double>(picture.values()[i]));
      logarithm.values()[i] = static_cast<float>(std::log(grey + kDarkest));
    }
  }
  return logarithm;
}

/// The mean under a Gaussian of what is inside. @param values  0 outside
ImageF mean_inside(const ImageF& values, const ImageF& inside, double sigma_px) {
  const HalfKernel kernel = kernel_of(sigma_px);
  ImageF mean = MaskedFilter::convolved(values, kernel);
  const ImageF weights = MaskedFilter::convolved(inside, kernel);
  for (std::size_t i = 0; i < mean.size(); ++i) {
    mean.values()[i] = inside.values()[i] > 0.0F ? mean.values()[i] / weights.values()[i] : 0.0F;
  }
  return mean;
}

/// Products of the derivatives xx, xy, yy, and 1 where there are such: 0 beside what is outside.
using Tensor = std::array<ImageF, 4>;

Tensor tensor_of(const ImageF& smooth, const Mask& mask) {
  Tensor tensor;
  tensor.fill(ImageF(mask.width(), mask.height()));
  auto& [xx, xy, yy, weight] = tensor;
  for (int y = 1; y + 1 < mask.height(); ++y) {
    for (int x = 1; x + 1 < mask.width(); ++x) {
      if (mask(x - 1, y) != 0 && mask(x + 1, y) != 0 && mask(x, y - 1) != 0 &&
          mask(x, y + 1) != 0) {
        const float along_x = 0.5F * (smooth(x + 1, y) - smooth(x - 1, y));
        const float along_y = 0.5F * (smooth(x, y + 1) - smooth(x, y - 1));
        xx(x, y) = along_x * along_x;
        xy(x, y) = along_x * along_y;
        yy(x, y) = along_y * along_y;
        weight(x, y) = 1.0F;
      }
    }
  }
  return tensor;
}

double smaller_eigenvalue(double xx, double xy, double yy) {
  return 0.5 * (xx + yy) - std::hypot(0.5 * (xx - yy), xy);
}

}  // namespace

ImageF structure_of(const ImageF& picture, const Mask& mask, double width_px, ThreadPool& pool) {
  const double window_px = 0.25 * width_px;
  const ImageF inside = inside_of(mask);
  const ImageF logarithm = logarithm_of(picture, mask);
  Tensor tensor = tensor_of(mean_inside(logarithm, inside, kSmoothing_px), mask);
  std::array<ImageF, 2> means;
  pool.for_each(6, [&](std::int64_t i) {
    const auto field = static_cast<std::size_t>(i);
    if (field < tensor.size()) {
      tensor[field] = MaskedFilter::convolved(tensor[field], kernel_of(window_px));
    } else {
      const double sigma_px = field == tensor.size() ? window_px : kSurroundings * window_px;
      means[field - tensor.size()] = mean_inside(logarithm, inside, sigma_px);
    }
  });
  const auto& [xx, xy, yy, weight] = tensor;
  ImageF structure(mask.width(), mask.height());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const auto seen = static_cast<double>(weight.values()[i]);
    if (mask.values()[i] != 0 && seen > 0.0) {
      const double eigenvalue = smaller_eigenvalue(static_cast<double>(xx.values()[i]),
                                                   static_cast<double>(xy.values()[i]),
                                                   static_cast<double>(yy.values()[i]));
      const auto size = static_cast<float>(std::sqrt(std::max(0.0, eigenvalue / seen)));
      structure.values()[i] = means[0].values()[i] < means[1].values()[i] ? -size : size;
    }
  }
  return structure;
}

}  // namespace glint
