// SPDX-License-Identifier: GPL-3.0-or-later
//
// Homogeneity by scale, place and kind: what remains after the shading is divided out, the
// variance's share at large and small scales, the worst tile, and the ripple that the stripes
// leave. The Gaussian is four running means with fractional ends, so its cost does not depend on
// its width (P. Gwosdek et al., "Theoretical foundations of Gaussian convolution by extended box
// filtering", SSVM 2011); the ripple is measured under Hann windows at the stripes' harmonics.
// docs/theory/homogeneity.md, "The family". Cost: about 0.1 s for 1300 x 300 pixels. Memory: some
// images of doubles.
#include "metrics/aspect_image/homogeneity_family.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/image/spans.h"
#include "metrics/aspect_image/homogeneity.h"

namespace glint {
namespace {

/// Part of an image, [left, right) x [top, bottom).
struct Box {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;

  int width() const { return right - left; }

  int height() const { return bottom - top; }
};

Box box_of(const Spans& spans) {
  GLINT_CHECK(!spans.empty(), "the region has no pixel");
  Box box = {.left = spans.front().begin,
             .top = spans.front().y,
             .right = spans.front().end,
             .bottom = spans.back().y + 1};
  for (const RowSpan& span : spans) {
    box.left = std::min(box.left, span.begin);
    box.right = std::max(box.right, span.end);
  }
  return box;
}

/// A matrix in rows; double, because running sums cancel.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<double> values;

  Plane(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        values(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  double* row(int y) {
    return values.data() + static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(width);
  }

  const double* row(int y) const {
    return values.data() + static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(width);
  }
};

/// A running mean of 2 radius + 1 pixels with its two outer neighbours counted in part.
struct RunningMean {
  int radius = 0;
  double part = 0.0;  ///< in [0, 1)
};

/// So many of them in a row look like a Gaussian.
constexpr int kPasses = 4;

/// The one with a variance of sigma^2 / kPasses. With L = 2 r + 1 that of the whole pixels is
/// (L^2 - 1) / 12; Gwosdek et al., "Theoretical foundations of Gaussian convolution by extended
/// box filtering", SSVM 2011, have the part that makes up the rest.
RunningMean running_mean(double sigma_px) {
  const double variance = sigma_px * sigma_px / kPasses;
  const int radius = static_cast<int>(0.5 * std::sqrt(12.0 * variance + 1.0) - 0.5);
  const double r = radius;
  const double whole = 2.0 * r + 1.0;
  const double missing = variance * whole - whole * r * (r + 1.0) / 3.0;
  const double part = missing / (2.0 * ((r + 1.0) * (r + 1.0) - variance));
  return {.radius = radius, .part = std::clamp(part, 0.0, 1.0)};
}

/// Beyond the ends are zeros. @param sums  scratch, width + 2 radius + 3
void smooth_row(double* row, int width, const RunningMean& mean, std::vector<double>& sums) {
  const int beyond = mean.radius + 1;
  double* to = sums.data();
  to = std::fill_n(to, beyond + 1, 0.0);
  double sum = 0.0;
  for (int x = 0; x < width; ++x) {
    sum += row[x];
    *to++ = sum;
  }
  std::fill_n(to, beyond, sum);
  const double scale = 1.0 / (2.0 * mean.radius + 1.0 + 2.0 * mean.part);
  const double* outer = sums.data();
  const double* inner = sums.data() + 1;
  const int outer_size = 2 * mean.radius + 3;
  for (int x = 0; x < width; ++x) {
    const double whole = inner[x + outer_size - 2] - inner[x];
    const double with_ends = outer[x + outer_size] - outer[x];
    row[x] = scale * (whole + mean.part * (with_ends - whole));
  }
}

void smooth_rows(Plane& plane, const RunningMean& mean) {
  std::vector<double> sums(static_cast<std::size_t>(plane.width + 2 * mean.radius + 3));
  for (int y = 0; y < plane.height; ++y) {
    for (int pass = 0; pass < kPasses; ++pass) {
      smooth_row(plane.row(y), plane.width, mean, sums);
    }
  }
}

Plane transposed(const Plane& plane) {
  Plane result(plane.height, plane.width);
  constexpr int kTile = 16;
  for (int top = 0; top < plane.height; top += kTile) {
    for (int left = 0; left < plane.width; left += kTile) {
      for (int y = top; y < std::min(top + kTile, plane.height); ++y) {
        for (int x = left; x < std::min(left + kTile, plane.width); ++x) {
          result.row(x)[y] = plane.row(y)[x];
        }
      }
    }
  }
  return result;
}

Plane smoothed(Plane plane, double sigma_px) {
  const RunningMean mean = running_mean(sigma_px);
  smooth_rows(plane, mean);
  Plane across = transposed(plane);
  smooth_rows(across, mean);
  return transposed(across);
}

/// Of an image over the region, and with another one.
struct PairMoments {
  double mean = 0.0;
  double variance = 0.0;
  double covariance = 0.0;
};

PairMoments moments_of(const ImageF& image, const ImageF& other, const Spans& spans) {
  double count = 0.0;
  double sum = 0.0;
  double sum_other = 0.0;
  for (const RowSpan& span : spans) {
    for (int x = span.begin; x < span.end; ++x) {
      sum += static_cast<double>(image(x, span.y));
      sum_other += static_cast<double>(other(x, span.y));
    }
    count += span.size();
  }
  PairMoments moments = {.mean = sum / count};
  const double mean_other = sum_other / count;
  for (const RowSpan& span : spans) {
    for (int x = span.begin; x < span.end; ++x) {
      const double deviation = static_cast<double>(image(x, span.y)) - moments.mean;
      moments.variance += deviation * deviation / count;
      moments.covariance +=
          deviation * (static_cast<double>(other(x, span.y)) - mean_other) / count;
    }
  }
  return moments;
}

/// 1 - standard deviation / mean; -sqrt(n) for a black one.
double uniformity(const ImageF& image, const Spans& spans) {
  double count = 0.0;
  for (const RowSpan& span : spans) {
    count += span.size();
  }
  const PairMoments moments = moments_of(image, image, spans);
  return moments.mean > 0.0 ? 1.0 - std::sqrt(moments.variance) / moments.mean : -std::sqrt(count);
}

double residual_uniformity(const ImageF& aspect,
                           const Mask& region,
                           const Spans& spans,
                           double sigma_px) {
  ImageF ratio = shading_of(aspect, region, sigma_px);
  for (const RowSpan& span : spans) {
    for (int x = span.begin; x < span.end; ++x) {
      float& value = ratio(x, span.y);
      value = value > 0.0F ? aspect(x, span.y) / value : 0.0F;
    }
  }
  return uniformity(ratio, spans);
}

/// Of the variance, by a Gaussian whose response is one half at 1 / (4 diameters):
/// exp(-2 pi^2 sigma^2 f^2) = 1/2.
double low_share(const ImageF& aspect, const Mask& region, const Spans& spans, double diameter_px) {
  const double cut = 1.0 / (4.0 * diameter_px);
  const double sigma_px = std::sqrt(0.5 * std::numbers::ln2) / (std::numbers::pi * cut);
  const PairMoments moments = moments_of(aspect, shading_of(aspect, region, sigma_px), spans);
  constexpr double kRounding = 1e-12;  // relative to the mean, of an image of floats
  if (moments.variance <= kRounding * moments.mean * moments.mean) {
    return 1.0;
  }
  return std::clamp(moments.covariance / moments.variance, 0.0, 1.0);
}

/// Runs of the region cut to one tile.
Spans cut_to(const Spans& spans, const Box& box) {
  Spans result;
  for (const RowSpan& span : spans) {
    const RowSpan cut = {
        .y = span.y, .begin = std::max(span.begin, box.left), .end = std::min(span.end, box.right)};
    if (cut.y >= box.top && cut.y < box.bottom && cut.size() > 0) {
      result.push_back(cut);
    }
  }
  return result;
}

/// An angle that grows by equal steps.
struct Turning {
  double cosine;
  double sine;
  double step_cosine;
  double step_sine;

  Turning(double start, double by)
      : cosine(std::cos(start)),
        sine(std::sin(start)),
        step_cosine(std::cos(by)),
        step_sine(std::sin(by)) {}

  void step() {
    const double next = cosine * step_cosine - sine * step_sine;
    sine = sine * step_cosine + cosine * step_sine;
    cosine = next;
  }
};

/// Squared amplitude of a sine of that frequency in a run, by a Hann window; the mean is taken off.
double power_at(const float* run, int size, double mean, double cycles_per_px) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  Turning wave(0.0, kTwoPi * cycles_per_px);
  Turning window(0.5 * kTwoPi / size, kTwoPi / size);
  double real = 0.0;
  double imaginary = 0.0;
  for (int x = 0; x < size; ++x) {
    const double value = (0.5 - 0.5 * window.cosine) * (static_cast<double>(run[x]) - mean);
    real += value * wave.cosine;
    imaginary += value * wave.sine;
    wave.step();
    window.step();
  }
  return 16.0 * (real * real + imaginary * imaginary) / (static_cast<double>(size) * size);
}

double mean_of_run(const float* run, int size) {
  double sum = 0.0;
  for (int x = 0; x < size; ++x) {
    sum += static_cast<double>(run[x]);
  }
  return sum / size;
}

/// Power at the harmonics, less what lies midway between them.
double ripple_power(const float* run, int size, double period_px) {
  constexpr int kHarmonics = 8;
  constexpr double kHighest = 0.5;  // cycles per pixel
  const double mean = mean_of_run(run, size);
  double power = 0.0;
  for (int harmonic = 1; harmonic <= kHarmonics; ++harmonic) {
    const double frequency = harmonic / period_px;
    const double half = 0.5 / period_px;
    if (frequency + half > kHighest) {
      break;
    }
    power +=
        power_at(run, size, mean, frequency) - 0.5 * (power_at(run, size, mean, frequency - half) +
                                                      power_at(run, size, mean, frequency + half));
  }
  return power;
}

}  // namespace

ImageF shading_of(const ImageF& aspect, const Mask& region, double sigma_px) {
  GLINT_CHECK(sigma_px > 0.0, "a width of zero smooths nothing");
  const Spans spans = spans_of(region);
  const Box box = box_of(spans);
  Plane values(box.width(), box.height());
  Plane weights(box.width(), box.height());
  for (const RowSpan& span : spans) {
    for (int x = span.begin; x < span.end; ++x) {
      values.row(span.y - box.top)[x - box.left] = static_cast<double>(aspect(x, span.y));
      weights.row(span.y - box.top)[x - box.left] = 1.0;
    }
  }
  values = smoothed(std::move(values), sigma_px);
  weights = smoothed(std::move(weights), sigma_px);
  ImageF shading(aspect.width(), aspect.height());
  for (const RowSpan& span : spans) {
    const double* sum = values.row(span.y - box.top);
    const double* weight = weights.row(span.y - box.top);
    for (int x = span.begin; x < span.end; ++x) {
      shading(x, span.y) = static_cast<float>(sum[x - box.left] / weight[x - box.left]);
    }
  }
  return shading;
}

double worst_region(const ImageF& aspect, const Mask& region, int tiles) {
  GLINT_CHECK(tiles >= 1, "at least one tile");
  const Spans spans = spans_of(region);
  const Box box = box_of(spans);
  std::optional<double> worst;
  for (int row = 0; row < tiles; ++row) {
    for (int column = 0; column < tiles; ++column) {
      const Box tile = {.left = box.left + box.width() * column / tiles,
                        .top = box.top + box.height() * row / tiles,
                        .right = box.left + box.width() * (column + 1) / tiles,
                        .bottom = box.top + box.height() * (row + 1) / tiles};
      const Spans inside = cut_to(spans, tile);
      std::int64_t pixels = 0;
      for (const RowSpan& span : inside) {
        pixels += span.size();
      }
      if (pixels > 0 && 4 * pixels >= std::int64_t{tile.width()} * tile.height()) {
        const double of_tile = uniformity(aspect, inside);
        worst = std::min(worst.value_or(of_tile), of_tile);
      }
    }
  }
  return worst ? *worst : uniformity(aspect, spans);
}

std::optional<double> fringe_ripple(const ImageF& aspect, const Mask& region, double period_px) {
  GLINT_CHECK(period_px >= 4.0, "stripes of four pixels and more can be measured");
  constexpr double kPeriods = 4.0;  // the window tells harmonics from what lies midway
  double power = 0.0;
  double sum = 0.0;
  double pixels = 0.0;
  for (const RowSpan& span : spans_of(region)) {
    if (span.size() < kPeriods * period_px) {
      continue;
    }
    const float* run = aspect.row(span.y) + span.begin;
    power += span.size() * ripple_power(run, span.size(), period_px);
    sum += span.size() * mean_of_run(run, span.size());
    pixels += span.size();
  }
  if (!(sum > 0.0)) {
    return std::nullopt;
  }
  return std::sqrt(std::max(power / pixels, 0.0)) / (sum / pixels);
}

HomogeneityFamily homogeneity_family(const ImageF& aspect,
                                     const Mask& region,
                                     const FamilyScales& scales,
                                     const MetricsSettings& settings) {
  GLINT_CHECK(scales.defect_diameter_px > 0.0, "a defect has a diameter");
  GLINT_CHECK(aspect.width() == region.width() && aspect.height() == region.height(),
              "image and region differ in size");
  const Spans spans = spans_of(region);
  HomogeneityFamily family;
  family.u0 = smallest_over_mean(aspect, region);
  family.residual = residual_uniformity(
      aspect, region, spans, settings.shading_diameters * scales.defect_diameter_px);
  family.low_share = low_share(aspect, region, spans, scales.defect_diameter_px);
  family.high_share = 1.0 - family.low_share;
  family.worst_region = worst_region(aspect, region, settings.regions);
  constexpr double kSmallestPeriod = 4.0;
  if (scales.period_px >= kSmallestPeriod) {
    family.ripple = fringe_ripple(aspect, region, scales.period_px);
  }
  return family;
}

}  // namespace glint
