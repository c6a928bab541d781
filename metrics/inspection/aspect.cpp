// SPDX-License-Identifier: GPL-3.0-or-later
//
// Codes are summed as integers in 32 bits, which 65,536 frames of 16 bits fill, and divided once:
// the correctly rounded mean, the same bytes for any number of threads and on any machine. Floats
// are summed in double in the order of the frames. Bands of rows go to the threads. Cost: one pass
// over the frames, bound by memory. docs/theory/inspection.md, "Mean image".
#include "metrics/inspection/aspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/inspection/filter_kernels.h"
#include "metrics/inspection/inspection_settings.h"
#include "metrics/inspection/inspector.h"

namespace glint {
namespace {

constexpr std::size_t kMaxFrames = 65536;  // sums of 16-bit codes fit into 32 bits

template <class T>
void check_frames(std::span<const Image<T>> frames) {
  if (frames.empty()) {
    throw ConfigError("images", "the sequence has no image, at least one is needed");
  }
  if (frames.size() > kMaxFrames) {
    throw ConfigError(
        "images",
        fmt::format("{} images are too many, at most {} are allowed", frames.size(), kMaxFrames));
  }
  const Image<T>& first = frames[0];
  if (first.empty()) {
    throw ConfigError("images", "image 1 holds no pixel");
  }
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].width() != first.width() || frames[i].height() != first.height()) {
      throw ConfigError(
          "images",
          fmt::format("image {} has {} x {} px and image 1 has {} x {} px, all must have one size",
                      i + 1,
                      frames[i].width(),
                      frames[i].height(),
                      first.width(),
                      first.height()));
    }
  }
}

/// Names the frame that made a sum infinite or NaN.
[[noreturn]] void throw_not_finite(std::span<const ImageF> frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& values = frames[i].values();
    const auto bad = std::ranges::find_if(values, [](float v) { return !std::isfinite(v); });
    if (bad != values.end()) {
      const auto at = static_cast<int>(bad - values.begin());
      throw ConfigError(
          "images",
          fmt::format("pixel ({}, {}) of image {} is NaN or infinite, must be a number",
                      at % frames[i].width(),
                      at / frames[i].width(),
                      i + 1));
    }
  }
  throw ConfigError("images", "values too large to be added");
}

void divide_codes(const std::vector<std::uint32_t>& sum, double divisor, int count, float* mean) {
  constexpr double kExactInFloat = 16777216.0;
  if (divisor <= kExactInFloat) {
    inspection_kernels::divide_small(sum.data(), count, static_cast<float>(divisor), mean);
  } else {
    inspection_kernels::divide(sum.data(), count, divisor, mean);
  }
}

/// @param mask  null: all pixels
template <class T>
void mean_of_codes(std::span<const Image<T>> frames,
                   const Mask* mask,
                   ThreadPool& pool,
                   ImageF& mean) {
  const int width = frames[0].width();
  const int height = frames[0].height();
  const double divisor =
      static_cast<double>(frames.size()) * static_cast<double>(std::numeric_limits<T>::max());
  const int bands = (height + kRowsPerBand - 1) / kRowsPerBand;
  pool.for_each(bands, [&](std::int64_t band) {
    std::vector<std::uint32_t> sum(static_cast<std::size_t>(width));
    std::vector<const T*> rows(frames.size());
    const int first = static_cast<int>(band) * kRowsPerBand;
    for (int y = first; y < std::min(first + kRowsPerBand, height); ++y) {
      std::ranges::transform(frames, rows.begin(), [&](const auto& image) { return image.row(y); });
      inspection_kernels::sum_rows(rows.data(), static_cast<int>(frames.size()), width, sum.data());
      divide_codes(sum, divisor, width, mean.row(y));
      if (mask != nullptr) {
        inspection_kernels::keep_inside(
            mean.row(y), mask->row(y), width, kLargestGrey, mean.row(y));
      }
    }
  });
}

}  // namespace

ImageF aspect_of(std::span<const Image<std::uint8_t>> frames, ThreadPool& pool) {
  check_frames(frames);
  ImageF mean(frames[0].width(), frames[0].height());
  mean_of_codes(frames, nullptr, pool, mean);
  return mean;
}

ImageF aspect_of(std::span<const Image<std::uint16_t>> frames, ThreadPool& pool) {
  check_frames(frames);
  ImageF mean(frames[0].width(), frames[0].height());
  mean_of_codes(frames, nullptr, pool, mean);
  return mean;
}

ImageF aspect_of(std::span<const ImageF> frames, ThreadPool& pool) {
  check_frames(frames);
  const int width = frames[0].width();
  const int height = frames[0].height();
  ImageF mean(width, height);
  const int bands = (height + kRowsPerBand - 1) / kRowsPerBand;
  const auto is_finite = pool.map<int>(bands, [&](std::int64_t band) {
    std::vector<double> sum(static_cast<std::size_t>(width));
    std::vector<const float*> rows(frames.size());
    const int first = static_cast<int>(band) * kRowsPerBand;
    bool all_finite = true;
    for (int y = first; y < std::min(first + kRowsPerBand, height); ++y) {
      std::ranges::transform(frames, rows.begin(), [&](const auto& image) { return image.row(y); });
      inspection_kernels::sum_rows(rows.data(), static_cast<int>(frames.size()), width, sum.data());
      all_finite &= std::ranges::all_of(sum, [](double value) { return std::isfinite(value); });
      inspection_kernels::divide(
          sum.data(), width, static_cast<double>(frames.size()), mean.row(y));
    }
    return all_finite ? 1 : 0;
  });
  if (std::ranges::find(is_finite, 0) != is_finite.end()) {
    throw_not_finite(frames);
  }
  return mean;
}

void masked_aspect(std::span<const Image<std::uint8_t>> frames,
                   const Mask& mask,
                   ThreadPool& pool,
                   ImageF& aspect) {
  check_frames(frames);
  if (frames[0].width() != mask.width() || frames[0].height() != mask.height()) {
    throw ConfigError("images",
                      fmt::format("images of {} x {} px do not fit the mask of {} x {} px",
                                  frames[0].width(),
                                  frames[0].height(),
                                  mask.width(),
                                  mask.height()));
  }
  mean_of_codes(frames, &mask, pool, aspect);
}

}  // namespace glint
