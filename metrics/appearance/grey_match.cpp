// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/appearance/grey_match.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/appearance/grey_sums.h"

namespace glint {
namespace {

template <class A, class B>
void check_same_size(const Image<A>& first, const Image<B>& second) {
  if (first.width() != second.width() || first.height() != second.height()) {
    throw ConfigError(fmt::format("appearance: pictures of {} x {} and {} x {} pixels",
                                  first.width(),
                                  first.height(),
                                  second.width(),
                                  second.height()));
  }
}

void check_region(const ImageF& picture, const Mask& region) {
  if (!region.empty()) {
    check_same_size(picture, region);
  }
}

/// @param full_scale  pixels clipped there or at 0 are left out; infinity: none is
GreySums sums_of(const ImageF& first, const ImageF& second, const Mask& region, double full_scale) {
  check_same_size(first, second);
  check_region(first, region);
  const bool leaves_out = std::isfinite(full_scale);
  GreySums sums;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto x = static_cast<double>(first.values()[i]);
    const auto y = static_cast<double>(second.values()[i]);
    const bool is_in = region.empty() || region.values()[i] != 0;
    const bool is_clipped =
        leaves_out && (std::min(x, y) <= 0.0 || std::max(x, y) >= full_scale * (1.0 - 1e-6));
    if (is_in && !is_clipped) {
      sums.add(x, y);
    }
  }
  return sums;
}

std::vector<float> sorted_greys(const ImageF& picture, const Mask& region) {
  check_region(picture, region);
  std::vector<float> greys;
  greys.reserve(picture.size());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (region.empty() || region.values()[i] != 0) {
      greys.push_back(picture.values()[i]);
    }
  }
  if (greys.empty()) {
    throw ConfigError("appearance: a region without a pixel has no histogram");
  }
  std::ranges::sort(greys);
  return greys;
}

}  // namespace

ExposureMatch match_exposure(const ImageF& simulated,
                             const ImageF& real,
                             const Mask& region,
                             ExposureModel model,
                             double full_scale) {
  const GreySums sums = sums_of(simulated, real, region, full_scale);
  ExposureMatch match;
  match.pixels = static_cast<std::size_t>(sums.pixels);
  if (sums.pixels < 1.0 || sums.simulated_squares <= 0.0) {
    return match;
  }
  const GreySums centred = sums.centred();
  if (model == ExposureModel::kGainAndOffset &&
      centred.simulated_squares > 1e-12 * sums.simulated_squares) {
    match.gain = centred.products / centred.simulated_squares;
    match.offset = (sums.real - match.gain * sums.simulated) / sums.pixels;
  } else {
    match.gain = sums.products / sums.simulated_squares;
  }
  const double g = match.gain;
  const double o = match.offset;
  const double squares = sums.real_squares + g * g * sums.simulated_squares + o * o * sums.pixels -
                         2.0 * g * sums.products - 2.0 * o * sums.real +
                         2.0 * g * o * sums.simulated;
  match.rms = std::sqrt(std::max(squares, 0.0) / sums.pixels);
  return match;
}

ImageF exposed(const ImageF& picture, const ExposureMatch& match) {
  ImageF result = picture;
  for (float& grey : result.values()) {
    grey = static_cast<float>(match.gain * static_cast<double>(grey) + match.offset);
  }
  return result;
}

ImageF residual_picture(const ImageF& simulated, const ImageF& real, const Mask& region) {
  check_same_size(simulated, real);
  check_region(simulated, region);
  ImageF rest(simulated.width(), simulated.height());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const bool is_in = region.empty() || region.values()[i] != 0;
    rest.values()[i] = is_in ? real.values()[i] - simulated.values()[i] : 0.0F;
  }
  return rest;
}

double correlation_of(const ImageF& first, const ImageF& second, const Mask& region) {
  const GreySums sums = sums_of(first, second, region, HUGE_VAL);
  if (sums.pixels < 2.0) {
    return 0.0;
  }
  const GreySums centred = sums.centred();
  const bool is_constant = centred.simulated_squares <= 1e-12 * sums.simulated_squares ||
                           centred.real_squares <= 1e-12 * sums.real_squares;
  return is_constant ? 0.0
                     : std::clamp(centred.products /
                                      std::sqrt(centred.simulated_squares * centred.real_squares),
                                  -1.0,
                                  1.0);
}

double histogram_distance(const ImageF& first,
                          const ImageF& second,
                          const Mask& first_region,
                          const Mask& second_region) {
  const std::vector<float> a = sorted_greys(first, first_region);
  const std::vector<float> b = sorted_greys(second, second_region);
  // Both quantile functions are steps; the area between them is summed from step to step.
  const auto na = static_cast<double>(a.size());
  const auto nb = static_cast<double>(b.size());
  std::size_t i = 0;
  std::size_t j = 0;
  double at = 0.0;
  double area = 0.0;
  while (i < a.size() && j < b.size()) {
    const double next_a = static_cast<double>(i + 1) / na;
    const double next_b = static_cast<double>(j + 1) / nb;
    const double next = std::min(next_a, next_b);
    area += (next - at) * std::abs(static_cast<double>(a[i]) - static_cast<double>(b[j]));
    i += next_a <= next ? 1U : 0U;
    j += next_b <= next ? 1U : 0U;
    at = next;
  }
  return area;
}

}  // namespace glint
