// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/visibility_windows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "metrics/statistics/matched_filter.h"

namespace glint {
namespace {

constexpr int kHalf = WindowShape::kSamples / 2;
constexpr int kPixels = WindowShape::kSamples * WindowShape::kSamples;

/// Four windows for each sample make a covariance that needs little shrinking.
constexpr int kWindows = 4 * kPixels;

/// Stands for detected without any doubt: pictures without noise.
constexpr double kMaxSquared = 1e12;

/// Whether nine points of the window lie in the region; good enough for one without thin holes.
bool is_whole(const Mask& region, int x, int y, WindowShape shape) {
  const int reach = kHalf * shape.step_px + shape.step_px / 2;
  if (x < reach || y < reach || x + reach >= region.width() || y + reach >= region.height()) {
    return false;
  }
  constexpr std::array kSides = {-1, 0, 1};
  return std::ranges::all_of(kSides, [&](int v) {
    return std::ranges::all_of(kSides,
                               [&](int u) { return region(x + u * reach, y + v * reach) != 0; });
  });
}

namespace {

std::vector<std::int32_t> pixels_of(const Mask& region) {
  std::vector<std::int32_t> inside;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      inside.push_back(static_cast<std::int32_t>(i));
    }
  }
  return inside;
}

}  // namespace

/// Random pixels of the region, whole windows where there are any.
std::vector<MiddlePixel> places_in(const Mask& region, WindowShape shape) {
  const std::vector<std::int32_t> inside = pixels_of(region);
  std::vector<MiddlePixel> places;
  if (inside.empty()) {
    return places;
  }
  constexpr int kTries = 20;
  for (int k = 0; k < kWindows; ++k) {
    Rng rng(1, Stream::kResampling, static_cast<std::uint64_t>(k));
    MiddlePixel place;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const auto drawn =
          static_cast<std::size_t>(rng.uniform() * static_cast<double>(inside.size()));
      const int pixel = inside[std::min(drawn, inside.size() - 1)];
      place = {pixel % region.width(), pixel / region.width()};
      if (is_whole(region, place.x, place.y, shape)) {
        break;
      }
    }
    places.push_back(place);
  }
  return places;
}

double squared(double value) {
  return std::min(value * value, kMaxSquared);
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] -= b[i];
  }
  return a;
}

}  // namespace

WindowShape WindowShape::of_area(double area_px) {
  const double radius_px = std::sqrt(std::max(0.0, area_px) / kPi);
  return {.step_px = std::max(1, static_cast<int>(std::lround(2.0 * radius_px / kHalf)))};
}

std::vector<double> window_at(const ImageF& image, int x, int y, WindowShape shape) {
  std::vector<double> samples;
  samples.reserve(kPixels);
  const int step = shape.step_px;
  const double share = 1.0 / (static_cast<double>(step) * step);
  for (int v = -kHalf; v <= kHalf; ++v) {
    for (int u = -kHalf; u <= kHalf; ++u) {
      const int left = x + u * step - step / 2;
      const int top = y + v * step - step / 2;
      double sum = 0.0;
      for (int row = std::max(0, top); row < std::min(image.height(), top + step); ++row) {
        for (int at = std::max(0, left); at < std::min(image.width(), left + step); ++at) {
          sum += static_cast<double>(image(at, row));
        }
      }
      samples.push_back(share * sum);
    }
  }
  return samples;
}

std::vector<std::vector<double>> background_windows(std::span<const ImageF> flawless,
                                                    const Mask& region,
                                                    WindowShape shape) {
  GLINT_CHECK(!flawless.empty(), "a background is needed");
  std::vector<std::vector<double>> windows;
  std::size_t next = 0;
  for (const MiddlePixel& place : places_in(region, shape)) {
    windows.push_back(window_at(flawless[next++ % flawless.size()], place.x, place.y, shape));
  }
  return windows;
}

MiddlePixel middle_of(const DefectView& view) {
  double sum_x = 0.0;
  double sum_y = 0.0;
  double count = 0.0;
  float minimum = DefectView::kFar;
  for (const float distance : view.distance.values()) {
    minimum = std::min(minimum, distance);
  }
  const float reach = std::max(1.0F, minimum);  // a defect may be smaller than a pixel
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      if (view.distance(x, y) <= reach) {
        sum_x += x;
        sum_y += y;
        count += 1.0;
      }
    }
  }
  return {view.left_px + static_cast<int>(std::lround(sum_x / std::max(1.0, count))),
          view.top_px + static_cast<int>(std::lround(sum_y / std::max(1.0, count)))};
}

std::vector<double> squared_dprimes(std::span<const DefectWindow> defects,
                                    std::span<const std::vector<double>> background,
                                    ThreadPool& pool) {
  struct Pair {
    double with = 0.0;
    double without = 0.0;
  };

  if (background.size() < 2) {
    std::vector<double> zeros(defects.size(), 0.0);
    return zeros;
  }
  const auto pairs = pool.map<Pair>(static_cast<std::int64_t>(defects.size()), [&](std::int64_t i) {
    const DefectWindow& one = defects[static_cast<std::size_t>(i)];
    return Pair{.with = squared(dprime(difference(one.with, one.mean), background)),
                .without = squared(dprime(difference(one.without, one.mean), background))};
  });
  double noise = 0.0;
  for (const Pair& pair : pairs) {
    noise += pair.without / static_cast<double>(pairs.size());
  }
  std::vector<double> result;
  for (const Pair& pair : pairs) {
    result.push_back(pair.with - noise);
  }
  return result;
}

}  // namespace glint
