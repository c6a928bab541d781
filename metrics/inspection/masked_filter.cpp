// SPDX-License-Identifier: GPL-3.0-or-later
//
// Linear filters that see the pixels of a mask only. A blur of the masked picture is divided by the
// same blur of the mask (normalised convolution, H. Knutsson and C.-F. Westin, CVPR 1993), so that
// a constant picture has no response up to the rim; the division is a weight per pixel, computed
// once for a mask. A filter is a sum of such weighted separable convolutions.
// docs/theory/inspection.md, "Response". Cost: per pixel 2 (2 r + 1) products for each kernel of
// radius r. Memory: one image of weights per kernel.
#include "metrics/inspection/masked_filter.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "metrics/inspection/filter_kernels.h"

namespace glint {
namespace {

constexpr double kWiderBy = 1.6;  // Marr and Hildreth 1980: nearest to the Laplacian

int radius_of(const HalfKernel& kernel) {
  return static_cast<int>(kernel.size()) - 1;
}

/// Pointers to the rows of a picture, `radius` rows of zeros before and after it.
std::vector<const float*> padded_rows(const ImageF& image,
                                      int radius,
                                      const std::vector<float>& zeros) {
  std::vector<const float*> rows(static_cast<std::size_t>(image.height() + 2 * radius),
                                 zeros.data());
  for (int y = 0; y < image.height(); ++y) {
    rows[static_cast<std::size_t>(y + radius)] = image.row(y);
  }
  return rows;
}

/// 1 / value inside the region, 0 elsewhere.
ImageF inverse_inside(const ImageF& values, const Mask& region) {
  ImageF inverse(values.width(), values.height());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float value = values.values()[i];
    inverse.values()[i] = region.values()[i] != 0 && value > 0.0F ? 1.0F / value : 0.0F;
  }
  return inverse;
}

void scale(ImageF& image, double factor) {
  for (float& value : image.values()) {
    value = static_cast<float>(factor * static_cast<double>(value));
  }
}

double tap_at(const HalfKernel& kernel, int k) {
  const auto at = static_cast<std::size_t>(std::abs(k));
  return at < kernel.size() ? static_cast<double>(kernel[at]) : 0.0;
}

/// Standard deviation that white noise of 1 has after a difference of two kernels.
double noise_gain(const HalfKernel& narrow, const HalfKernel& wide) {
  const int radius = std::max(radius_of(narrow), radius_of(wide));
  double squares = 0.0;
  for (int v = -radius; v <= radius; ++v) {
    for (int u = -radius; u <= radius; ++u) {
      const double tap = tap_at(narrow, u) * tap_at(narrow, v) - tap_at(wide, u) * tap_at(wide, v);
      squares += tap * tap;
    }
  }
  return std::sqrt(squares);
}

}  // namespace

HalfKernel gaussian_kernel(double sigma_px, int radius) {
  std::vector<double> taps;
  double sum = 0.0;
  for (int k = 0; k <= radius; ++k) {
    taps.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
    sum += (k == 0 ? 1.0 : 2.0) * taps.back();
  }
  HalfKernel kernel;
  for (const double tap : taps) {
    kernel.push_back(static_cast<float>(tap / sum));
  }
  return kernel;
}

double gaussian_sigma(const InspectionSettings& settings) {
  return settings.sigma_px > 0.0 ? settings.sigma_px
                                 : 0.3 * (0.5 * (settings.kernel_px - 1) - 1.0) + 0.8;
}

/// What a thread needs to filter rows.
struct MaskedFilter::Rows {
  const ImageF& masked;
  int radius = 0;  ///< of the largest kernel
  const std::vector<const float*>& pointers;
  std::vector<float> columns;  ///< of one row, with `radius` zeros on both sides
  std::vector<float> smooth;
  std::vector<float> channel;
  std::vector<const float*> shifted;

  Rows(const ImageF& image, int largest_radius, const std::vector<const float*>& rows)
      : masked(image),
        radius(largest_radius),
        pointers(rows),
        columns(static_cast<std::size_t>(image.width() + 2 * largest_radius)),
        smooth(static_cast<std::size_t>(image.width())),
        channel(static_cast<std::size_t>(image.width())) {}

  /// The convolution at columns [begin, end) of row y.
  const float* convolve(const HalfKernel& kernel, int y, int begin, int end) {
    const int reach = radius_of(kernel);
    const int first = std::max(0, begin - reach);
    const int last = std::min(masked.width(), end + reach);
    float* padded = columns.data() + radius;
    shifted.clear();
    for (int k = -reach; k <= reach; ++k) {
      shifted.push_back(pointers[static_cast<std::size_t>(y + radius + k)] + first);
    }
    inspection_kernels::fold(shifted.data(), kernel.data(), reach, last - first, padded + first);
    std::fill(padded + begin - reach, padded + first, 0.0F);
    std::fill(padded + last, padded + end + reach, 0.0F);
    shifted.clear();
    for (int k = -reach; k <= reach; ++k) {
      shifted.push_back(padded + begin + k);
    }
    inspection_kernels::fold(
        shifted.data(), kernel.data(), reach, end - begin, smooth.data() + begin);
    return smooth.data() + begin;
  }
};

ImageF MaskedFilter::convolved(const ImageF& image, const HalfKernel& kernel) {
  const std::vector<float> zeros(static_cast<std::size_t>(image.width()));
  const std::vector<const float*> pointers = padded_rows(image, radius_of(kernel), zeros);
  Rows rows(image, radius_of(kernel), pointers);
  ImageF result(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    std::copy_n(rows.convolve(kernel, y, 0, image.width()), image.width(), result.row(y));
  }
  return result;
}

MaskedFilter::MaskedFilter(const InspectionSettings& settings, const Mask& mask, const Mask& region)
    : region_(region) {
  for (int y = 0; y < region.height(); ++y) {
    const unsigned char* row = region.row(y);
    const auto is_inside = [](unsigned char value) { return value != 0; };
    const auto begin = std::find_if(row, row + region.width(), is_inside) - row;
    auto end = static_cast<std::ptrdiff_t>(region.width());
    while (end > begin && row[end - 1] == 0) {
      --end;
    }
    bounds_.push_back({static_cast<int>(begin), static_cast<int>(end)});
  }
  ImageF inside(mask.width(), mask.height());
  std::transform(
      mask.values().begin(), mask.values().end(), inside.values().begin(), [](unsigned char value) {
        return value != 0 ? 1.0F : 0.0F;
      });
  switch (settings.filter) {
    case InspectionSettings::Filter::kGaussian:
      add_gaussian(inside, settings);
      break;
    case InspectionSettings::Filter::kDifferenceOfGaussians:
      for (const double sigma_px : settings.scales_px) {
        add_difference(inside, sigma_px);
      }
      break;
    case InspectionSettings::Filter::kMatched:
      add_matched(inside, settings.template_px);
      break;
    case InspectionSettings::Filter::kPhase:
    case InspectionSettings::Filter::kStructure:
      break;
  }
}

void MaskedFilter::add_gaussian(const ImageF& inside, const InspectionSettings& settings) {
  const HalfKernel kernel = gaussian_kernel(gaussian_sigma(settings), settings.kernel_px / 2);
  ImageF weights = inverse_inside(convolved(inside, kernel), region_);
  scale(weights, -1.0);
  channels_.push_back({.own = 1.0F, .terms = {{kernel, std::move(weights)}}});
}

void MaskedFilter::add_difference(const ImageF& inside, double sigma_px) {
  const double wide_px = kWiderBy * sigma_px;
  const auto reach = [](double sigma) { return static_cast<int>(std::ceil(3.0 * sigma)); };
  const HalfKernel narrow = gaussian_kernel(sigma_px, reach(sigma_px));
  const HalfKernel wide = gaussian_kernel(wide_px, reach(wide_px));
  const double gain = noise_gain(narrow, wide);
  ImageF plus = inverse_inside(convolved(inside, narrow), region_);
  ImageF minus = inverse_inside(convolved(inside, wide), region_);
  amplification_ = std::max(amplification_, 1.0 / gain);
  scale(plus, 1.0 / gain);
  scale(minus, -1.0 / gain);
  channels_.push_back({.terms = {{narrow, std::move(plus)}, {wide, std::move(minus)}}});
}

namespace {

/// One side of a Gaussian spot, and of its square.
std::pair<HalfKernel, HalfKernel> spot_and_square(double sigma_px, int radius) {
  std::pair<HalfKernel, HalfKernel> kernels;
  for (int k = 0; k <= radius; ++k) {
    const double tap = std::exp(-0.5 * k * k / (sigma_px * sigma_px));
    kernels.first.push_back(static_cast<float>(tap));
    kernels.second.push_back(static_cast<float>(tap * tap));
  }
  return kernels;
}

}  // namespace

/// Least squares of spot * height + background over the window's pixels inside the mask, sums S:
/// height = (S(spot f) - S(spot) S(f) / S(1)) / (S(spot^2) - S(spot)^2 / S(1)).
void MaskedFilter::add_matched(const ImageF& inside, double diameter_px) {
  const double sigma_px = diameter_px / 4.0;
  const int radius = std::max(2, static_cast<int>(std::ceil(diameter_px)));
  const auto [spot, squared] = spot_and_square(sigma_px, radius);
  const HalfKernel ones(spot.size(), 1.0F);
  const ImageF spots = convolved(inside, spot);
  const ImageF squares = convolved(inside, squared);
  const ImageF counts = convolved(inside, ones);
  constexpr double kMinShare = 1e-3;  // of the variance: less is a sliver that shows no spot
  ImageF of_spot(inside.width(), inside.height());
  ImageF of_ones(inside.width(), inside.height());
  for (std::size_t i = 0; i < inside.size(); ++i) {
    const auto spot_sum = static_cast<double>(spots.values()[i]);
    const auto square_sum = static_cast<double>(squares.values()[i]);
    const double mean = spot_sum / std::max(1.0, static_cast<double>(counts.values()[i]));
    const double variance = square_sum - spot_sum * mean;
    if (region_.values()[i] != 0 && variance > kMinShare * square_sum) {
      of_spot.values()[i] = static_cast<float>(1.0 / variance);
      of_ones.values()[i] = static_cast<float>(-mean / variance);
    }
  }
  channels_.push_back({.terms = {{spot, std::move(of_spot)}, {ones, std::move(of_ones)}}});
}

void MaskedFilter::filter_row(Rows& rows, int y, float* out) const {
  const auto [begin, end] = bounds_[static_cast<std::size_t>(y)];
  const int count = end - begin;
  std::fill(out, out + begin, 0.0F);
  std::fill(out + end, out + region_.width(), 0.0F);
  for (const Channel& channel : channels_) {
    const bool is_first = &channel == &channels_.front();
    float* sum = is_first ? out + begin : rows.channel.data();
    inspection_kernels::scale_inside(
        channel.own, rows.masked.row(y) + begin, region_.row(y) + begin, count, sum);
    for (const Term& term : channel.terms) {
      const float* smooth = rows.convolve(term.kernel, y, begin, end);
      inspection_kernels::add_weighted(term.weights.row(y) + begin, smooth, count, sum);
    }
    if (!is_first) {
      inspection_kernels::keep_larger(sum, count, out + begin);
    }
  }
}

void MaskedFilter::respond(const ImageF& masked, ThreadPool& pool, ImageF& result) const {
  GLINT_CHECK(masked.width() == region_.width() && masked.height() == region_.height(),
              "picture and mask differ in size");
  int radius = 0;
  for (const Channel& channel : channels_) {
    for (const Term& term : channel.terms) {
      radius = std::max(radius, radius_of(term.kernel));
    }
  }
  const std::vector<float> zeros(static_cast<std::size_t>(masked.width()));
  const std::vector<const float*> pointers = padded_rows(masked, radius, zeros);
  const int bands = (masked.height() + kRowsPerBand - 1) / kRowsPerBand;
  pool.for_each(bands, [&](std::int64_t band) {
    Rows rows(masked, radius, pointers);
    const int first = static_cast<int>(band) * kRowsPerBand;
    for (int y = first; y < std::min(first + kRowsPerBand, masked.height()); ++y) {
      filter_row(rows, y, result.row(y));
    }
  });
}

}  // namespace glint
