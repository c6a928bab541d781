// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/photon_transfer/level_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/error.h"

namespace glint {
namespace {

double mean_of(const ImageF& picture) {
  double sum = 0.0;
  for (const float value : picture.values()) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(picture.size());
}

/// Shares of the pixels at code 0 and at full scale.
void take_shares_cut_off(std::span<const ImageF> pictures,
                         double full_scale_dn,
                         LevelStatistics& level) {
  std::size_t zero = 0;
  std::size_t clipped = 0;
  for (const ImageF& picture : pictures) {
    for (const float value : picture.values()) {
      zero += value <= 0.0F ? 1 : 0;
      clipped += static_cast<double>(value) >= full_scale_dn ? 1 : 0;
    }
  }
  const auto all = static_cast<double>(pictures.size() * pictures.front().size());
  level.zero_share = static_cast<double>(zero) / all;
  level.clipped_share = static_cast<double>(clipped) / all;
}

}  // namespace

Image<double> mean_picture(std::span<const ImageF> pictures) {
  GLINT_CHECK(!pictures.empty(), "a mean needs pictures");
  Image<double> mean(pictures.front().width(), pictures.front().height());
  for (const ImageF& picture : pictures) {
    GLINT_CHECK(picture.size() == mean.size(), "pictures of one level have one size");
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean.values()[i] +=
          static_cast<double>(picture.values()[i]) / static_cast<double>(pictures.size());
    }
  }
  return mean;
}

LevelStatistics level_statistics(std::span<const ImageF> pictures, double full_scale_dn) {
  GLINT_CHECK(pictures.size() >= 2, "a variance needs two pictures");
  const Image<double> mean = mean_picture(pictures);
  std::vector<double> means;
  for (const ImageF& picture : pictures) {
    means.push_back(mean_of(picture));
  }
  const auto count = static_cast<double>(pictures.size());
  const auto pixels = static_cast<double>(mean.size());
  const double total = std::accumulate(means.begin(), means.end(), 0.0) / count;
  double between = 0.0;
  double across = 0.0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const double off = mean.values()[i] - total;
    across += off * off;
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      const double step = static_cast<double>(pictures[k].values()[i]) - means[k] - off;
      between += step * step;
    }
  }
  LevelStatistics level{.pictures = static_cast<int>(pictures.size()), .mean_dn = total};
  level.temporal_variance_dn2 = between / (count - 1.0) / pixels;
  level.spatial_variance_dn2 = across / (pixels - 1.0) - level.temporal_variance_dn2 / count;
  take_shares_cut_off(pictures, full_scale_dn, level);
  level.variance_error_dn2 = std::max(level.temporal_variance_dn2, kRoundingVariance) *
                             std::sqrt(2.0 / (pixels * (count - 1.0)));
  return level;
}

}  // namespace glint
