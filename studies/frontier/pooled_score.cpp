// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/pooled_score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "metrics/statistics/estimate.h"

namespace glint {
namespace {

/// What a score does with a deviation d over pixels.
enum class Counts { kItself, kDeviation, kOneLessDeviation };

Counts counts_of(std::string_view name) {
  constexpr std::array<std::string_view, 5> kOneLess = {"homogeneity.h_rms",
                                                        "homogeneity.h_abs",
                                                        "homogeneity.robust",
                                                        "homogeneity.residual",
                                                        "homogeneity.worst_region"};
  if (std::ranges::find(kOneLess, name) != kOneLess.end()) {
    return Counts::kOneLessDeviation;
  }
  return name == "homogeneity.ripple" || name.ends_with("rms_contrast") ? Counts::kDeviation
                                                                        : Counts::kItself;
}

/// A deviation from its square, which may come out below 0. Near 0 the root turns the square's
/// standard error s into one of about sqrt(s) / 2.
ReferenceScore deviation_of(const ReferenceScore& square) {
  const double seen = std::max(square.value, square.standard_error);
  return {.value = std::sqrt(std::max(0.0, square.value)),
          .standard_error = seen > 0.0 ? 0.5 * square.standard_error / std::sqrt(seen) : 0.0};
}

ReferenceScore jackknife(double whole, std::span<const double> without_one) {
  const auto count = static_cast<double>(without_one.size());
  double mean = 0.0;
  for (const double value : without_one) {
    mean += value / count;
  }
  return {.value = count * whole - (count - 1.0) * mean,
          .standard_error = jackknife_error(without_one)};
}

}  // namespace

ReferenceScore pooled_score(const std::string& name,
                            double whole,
                            std::span<const double> without_one) {
  GLINT_CHECK(without_one.size() > 1, "one batch has no scatter");
  const Counts counts = counts_of(name);
  if (counts == Counts::kItself) {
    return jackknife(whole, without_one);
  }
  const double offset = counts == Counts::kOneLessDeviation ? 1.0 : 0.0;
  const auto square = [&](double value) { return (value - offset) * (value - offset); };
  std::vector<double> squares;
  std::ranges::transform(without_one, std::back_inserter(squares), square);
  ReferenceScore score = deviation_of(jackknife(square(whole), squares));
  score.value = counts == Counts::kOneLessDeviation ? 1.0 - score.value : score.value;
  return score;
}

std::vector<ImageF> frames_of_batch(const std::vector<ImageF>& whole,
                                    const std::vector<ImageF>& without,
                                    std::size_t batches) {
  GLINT_CHECK(whole.size() == without.size(), "all pictures have the same frames");
  const auto count = static_cast<float>(batches);
  std::vector<ImageF> frames = whole;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (std::size_t i = 0; i < frames[k].size(); ++i) {
      frames[k].values()[i] =
          count * whole[k].values()[i] - (count - 1.0F) * without[k].values()[i];
    }
  }
  return frames;
}

}  // namespace glint
