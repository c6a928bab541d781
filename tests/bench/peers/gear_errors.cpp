// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/gear_errors.h"
#include "core/median.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"

namespace glint::peers {
namespace {

constexpr double kTrimmedShare = 0.001;
constexpr int kBlock_px = 8;

void check_size(const ImageF& picture, const ImageF& reference) {
  if (picture.width() != reference.width() || picture.height() != reference.height()) {
    throw Error("a renderer's picture does not have the size of its reference");
  }
}

double mean_on(const ImageF& image, const Mask& mask) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask.values()[i] != 0) {
      sum += static_cast<double>(image.values()[i]);
      count += 1.0;
    }
  }
  return sum / count;
}

/// Means over the blocks that lie in the mask as a whole.
std::vector<double> block_means(const ImageF& image, const Mask& mask) {
  std::vector<double> means;
  for (int y0 = 0; y0 + kBlock_px <= image.height(); y0 += kBlock_px) {
    for (int x0 = 0; x0 + kBlock_px <= image.width(); x0 += kBlock_px) {
      double sum = 0.0;
      int inside = 0;
      for (int y = y0; y < y0 + kBlock_px; ++y) {
        for (int x = x0; x < x0 + kBlock_px; ++x) {
          sum += static_cast<double>(image(x, y));
          inside += mask(x, y) != 0 ? 1 : 0;
        }
      }
      if (inside == kBlock_px * kBlock_px) {
        means.push_back(sum / inside);
      }
    }
  }
  return means;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

}  // namespace

RelativeError relative_error(const ImageF& picture, const ImageF& reference, const Mask& mask) {
  check_size(picture, reference);
  std::vector<double> squares;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (mask.values()[i] != 0) {
      const double difference =
          static_cast<double>(picture.values()[i]) - static_cast<double>(reference.values()[i]);
      squares.push_back(difference * difference);
    }
  }
  const double mean = mean_on(reference, mask);
  RelativeError error = {.all = std::sqrt(mean_of(squares)) / mean};
  std::ranges::sort(squares);
  squares.resize(squares.size() -
                 static_cast<std::size_t>(kTrimmedShare * static_cast<double>(squares.size())));
  error.trimmed = std::sqrt(mean_of(squares)) / mean;
  return error;
}

std::vector<GearPoint> points_of(const std::vector<GearPicture>& pictures,
                                 const ImageF& reference,
                                 const Mask& mask) {
  std::map<int, std::vector<double>> times_s;
  std::map<int, GearPoint> points;
  for (const GearPicture& picture : pictures) {
    const int samples = picture.order.samples;
    const RelativeError error = relative_error(picture.luminance, reference, mask);
    GearPoint& point = points[samples];
    point.samples = samples;
    ++point.pictures;
    point.error.all += error.all * error.all;
    point.error.trimmed += error.trimmed * error.trimmed;
    times_s[samples].push_back(picture.cpu_s);
  }
  std::vector<GearPoint> result;
  for (const auto& entry : points) {
    GearPoint point = entry.second;
    point.cpu_s = median(times_s[entry.first]);
    point.error = {.all = std::sqrt(point.error.all / point.pictures),
                   .trimmed = std::sqrt(point.error.trimmed / point.pictures)};
    result.push_back(point);
  }
  return result;
}

double seconds_at_error(const std::vector<GearPoint>& points, double trimmed_error) {
  GLINT_CHECK(points.size() >= 2, "a line needs two points");
  std::size_t i = 1;
  while (i + 1 < points.size() && points[i].error.trimmed > trimmed_error) {
    ++i;
  }
  const GearPoint& a = points[i - 1];
  const GearPoint& b = points[i];
  const double along =
      std::log(trimmed_error / a.error.trimmed) / std::log(b.error.trimmed / a.error.trimmed);
  return a.cpu_s * std::pow(b.cpu_s / a.cpu_s, along);
}

double slope_of(const std::vector<GearPoint>& points) {
  const GearPoint& a = points.front();
  const GearPoint& b = points.back();
  return std::log(b.error.trimmed / a.error.trimmed) /
         std::log(static_cast<double>(b.samples) / a.samples);
}

Likeness likeness(const ImageF& first, const ImageF& second, const Mask& mask) {
  check_size(first, second);
  Likeness result = {.mean_ratio = mean_on(second, mask) / mean_on(first, mask)};
  ImageF scaled = second;
  for (float& value : scaled.values()) {
    value = static_cast<float>(static_cast<double>(value) / result.mean_ratio);
  }
  result.pixel_error = relative_error(scaled, first, mask).all;
  const std::vector<double> blocks = block_means(first, mask);
  const std::vector<double> others = block_means(scaled, mask);
  std::vector<double> squares;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    squares.push_back((others[i] - blocks[i]) * (others[i] - blocks[i]));
  }
  result.block_error = std::sqrt(mean_of(squares)) / mean_of(blocks);
  return result;
}

}  // namespace glint::peers
