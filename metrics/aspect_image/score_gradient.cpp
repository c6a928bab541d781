// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of scores by each pixel of the mean image, the start of the reverse mode. For h_rms
// and h_abs they are linear in the pixel's deviation from the mean, and in its sign; with noise the
// sign becomes the error function of the pixel. Contrasts of defects weigh the pixels of the defect
// and of its background. Two sweeps over the region with 32 partial sums, the same bits on any
// machine. docs/theory/derivatives.md. Cost: linear in the region. Memory: one image for a score.
#include "metrics/aspect_image/score_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/image/spans.h"
#include "core/simd.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 6> kWholeScores = {"homogeneity.h_rms",
                                                          "homogeneity.h_abs",
                                                          "homogeneity.mean",
                                                          "defects.min_cnr",
                                                          "defects.min_weber",
                                                          "defects.mean_weber"};

/// Differences below this share of the mean are the rounding of the image: it is taken as even, and
/// what it would change with is not known. Nought is a derivative of a uniformity at its largest.
constexpr double kRounding = 1e-6;

struct Moments {
  double count = 0.0;
  double mean = 0.0;
  double deviation = 0.0;  ///< root mean square
  double absolute = 0.0;   ///< mean size of what is left after the mean; add_absolute() sets it ...
  double sign = 0.0;       ///< ... and its mean sign
  double noise_variance = 0.0;  ///< mean variance of the pixels' scatter

  /// Root mean square with the scatter.
  double spread() const { return std::sqrt(deviation * deviation + noise_variance); }
};

double sign_of(double value) {
  return value > 0.0 ? 1.0 : (value < 0.0 ? -1.0 : 0.0);
}

/// Sums go over lanes: independent additions, and the same bits on any machine.
constexpr std::size_t kLanes = 32;

using Lanes = std::array<double, kLanes>;

/// In halves.
double total_of(Lanes lanes) {
  for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::size_t lane = 0; lane < half; ++lane) {
      lanes[lane] += lanes[lane + half];
    }
  }
  return lanes[0];
}

/// Sums lane by lane of what values leave after a number.
template <class LaneSums>
GLINT_INLINE LaneSums in_lanes(double number, const float* values, std::size_t count) {
  LaneSums sums;
  const std::size_t whole = count - count % kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sums.add(static_cast<double>(values[i + lane]) - number, lane);
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    sums.add(static_cast<double>(values[i]) - number, i - whole);
  }
  return sums;
}

struct Sums {
  double plain = 0.0;
  double squares = 0.0;
};

struct LanesOfSums {
  Lanes plain = {};
  Lanes squares = {};

  GLINT_INLINE void add(double rest, std::size_t lane) {
    plain[lane] += rest;
    squares[lane] += rest * rest;
  }
};

/// Of what values leave after a number, one of them or nought: one sweep. The square of how far
/// that one is from the mean is at most as many times their variance as there are values, which
/// double holds.
GLINT_WIDE Sums sums_beside(double near, const float* values, std::size_t count) {
  const auto lanes = in_lanes<LanesOfSums>(near, values, count);
  return {.plain = total_of(lanes.plain), .squares = total_of(lanes.squares)};
}

struct AbsoluteSums {
  double absolute = 0.0;
  double signs = 0.0;
};

struct LanesOfAbsolute {
  Lanes absolute = {};
  Lanes signs = {};

  GLINT_INLINE void add(double rest, std::size_t lane) {
    absolute[lane] += rest < 0.0 ? -rest : rest;
    signs[lane] += (rest > 0.0 ? 1.0 : 0.0) - (rest < 0.0 ? 1.0 : 0.0);
  }
};

/// Of what values leave after a mean.
GLINT_WIDE AbsoluteSums absolute_beside(double mean, const float* values, std::size_t count) {
  const auto lanes = in_lanes<LanesOfAbsolute>(mean, values, count);
  return {.absolute = total_of(lanes.absolute), .signs = total_of(lanes.signs)};
}

/// A derivative that is linear in what a value leaves after the mean, and in the sign of that.
struct LinearDerivative {
  double mean = 0.0;
  double constant = 0.0;
  double by_rest = 0.0;
  double by_sign = 0.0;
};

GLINT_WIDE void gradient_at(const float* __restrict values,
                            int count,
                            const LinearDerivative& derivative,
                            float* __restrict gradient) {
  const LinearDerivative s = derivative;
  for (int i = 0; i < count; ++i) {
    const double rest = static_cast<double>(values[i]) - s.mean;
    const double sign = (rest > 0.0 ? s.by_sign : 0.0) - (rest < 0.0 ? s.by_sign : 0.0);
    gradient[i] = static_cast<float>(s.constant + s.by_rest * rest + sign);
  }
}

const float* start_of(const ImageF& image, const RowSpan& span) {
  return image.row(span.y) + span.begin;
}

std::size_t size_of(const RowSpan& span) {
  return static_cast<std::size_t>(span.size());
}

Moments moments_of(const ScoredImage& scored, const Spans& region) {
  Moments m;
  Sums all;
  double variances = 0.0;
  const double near =
      region.empty() ? 0.0 : static_cast<double>(*start_of(scored.aspect, region.front()));
  for (const RowSpan& span : region) {
    const Sums sums = sums_beside(near, start_of(scored.aspect, span), size_of(span));
    m.count += static_cast<double>(span.size());
    all.plain += sums.plain;
    all.squares += sums.squares;
    if (scored.deviation != nullptr) {
      variances += sums_beside(0.0, start_of(*scored.deviation, span), size_of(span)).squares;
    }
  }
  const double count = std::max(1.0, m.count);
  const double beside = all.plain / count;
  m.mean = near + beside;
  m.deviation = std::sqrt(std::max(0.0, all.squares / count - beside * beside));
  m.noise_variance = variances / count;
  return m;
}

/// Adds what h_abs is made of; the mean must be known.
void add_absolute(const ImageF& image, const Spans& region, Moments& m) {
  AbsoluteSums all;
  for (const RowSpan& span : region) {
    const AbsoluteSums absolute = absolute_beside(m.mean, start_of(image, span), size_of(span));
    all.absolute += absolute.absolute;
    all.signs += absolute.signs;
  }
  m.absolute = all.absolute / std::max(1.0, m.count);
  m.sign = all.signs / std::max(1.0, m.count);
}

/// Of a normal number of a mean and a deviation: the mean of its size, and that of its sign.
struct FoldedNormal {
  double size = 0.0;
  double sign = 0.0;
};

FoldedNormal folded_normal(double mean, double deviation) {
  if (deviation <= 0.0) {
    return {.size = std::abs(mean), .sign = sign_of(mean)};
  }
  const double z = mean / deviation;
  const double sign = std::erf(z * std::sqrt(0.5));
  const double at_zero = std::sqrt(2.0 / std::numbers::pi) * std::exp(-0.5 * z * z);
  return {.size = deviation * at_zero + mean * sign, .sign = sign};
}

/// h_abs with scatter: the sign of what is left of a pixel after the mean is that of a normal
/// number.
ImageF noisy_absolute_gradient(const ScoredImage& image, const Spans& region, Moments m) {
  const auto folded = [&](int x, int y) {
    return folded_normal(static_cast<double>(image.aspect(x, y)) - m.mean,
                         static_cast<double>((*image.deviation)(x, y)));
  };
  const auto for_each_pixel = [&](const auto& use) {
    for (const RowSpan& span : region) {
      for (int x = span.begin; x < span.end; ++x) {
        use(x, span.y);
      }
    }
  };
  m.absolute = 0.0;
  m.sign = 0.0;
  for_each_pixel([&](int x, int y) {
    const FoldedNormal pixel = folded(x, y);
    m.absolute += pixel.size / m.count;
    m.sign += pixel.sign / m.count;
  });
  ImageF gradient(image.aspect.width(), image.aspect.height());
  for_each_pixel([&](int x, int y) {
    const double by_rest = m.sign - folded(x, y).sign;
    gradient(x, y) = static_cast<float>((m.absolute / m.mean + by_rest) / (m.mean * m.count));
  });
  return gradient;
}

/// h_rms = 1 - sigma / mu and h_abs = 1 - a / mu: the derivative by a pixel is linear in what is
/// left of it after the mean, and in the sign of that. Scatter is in sigma and a.
ImageF homogeneity_gradient(std::string_view score, const ScoredImage& image) {
  const Spans region = spans_of(image.region);
  Moments m = moments_of(image, region);
  LinearDerivative derivative = {.mean = m.mean, .constant = 1.0 / m.count};
  const bool is_even = m.spread() <= kRounding * m.mean;
  if (score == "homogeneity.h_abs" && m.noise_variance > 0.0 && !is_even) {
    return noisy_absolute_gradient(image, region, m);
  }
  if (score != "homogeneity.mean" && is_even) {
    derivative.constant = 0.0;
  } else if (score == "homogeneity.h_rms") {
    derivative.constant = m.spread() / (m.mean * m.mean * m.count);
    derivative.by_rest = -1.0 / (m.spread() * m.mean * m.count);
  } else if (score == "homogeneity.h_abs") {
    add_absolute(image.aspect, region, m);
    derivative.constant = (m.absolute / (m.mean * m.mean) + m.sign / m.mean) / m.count;
    derivative.by_sign = -1.0 / (m.mean * m.count);
  }
  ImageF gradient = zero_beside(region, image.aspect.width(), image.aspect.height());
  for (const RowSpan& span : region) {
    gradient_at(
        start_of(image.aspect, span), span.size(), derivative, gradient.row(span.y) + span.begin);
  }
  return gradient;
}

/// Adds derivative(pixel) to pixels. What rounding takes from one pixel the next one gets: pixels
/// of a defect weigh the same, would all err by the same, and their sum cancels against the ring's.
template <class Derivative>
void add_each(ImageF& gradient,
              const std::vector<std::size_t>& pixels,
              const Derivative& derivative) {
  double rest = 0.0;
  for (const std::size_t pixel : pixels) {
    float& to = gradient.values()[pixel];
    const double wanted = static_cast<double>(to) + derivative(pixel) + rest;
    to = static_cast<float>(wanted);
    rest = wanted - static_cast<double>(to);
  }
}

void add(ImageF& gradient, const std::vector<std::size_t>& pixels, double derivative) {
  const double share = derivative / static_cast<double>(pixels.size());
  add_each(gradient, pixels, [share](std::size_t) { return share; });
}

double sigma_of(const ImageF& image, const std::vector<std::size_t>& pixels, double mean) {
  double variance = 0.0;
  for (const std::size_t pixel : pixels) {
    const double rest = static_cast<double>(image.values()[pixel]) - mean;
    variance += rest * rest;
  }
  return std::sqrt(variance / static_cast<double>(pixels.size()));
}

/// |mean_D - mean_B| / max(sigma_B, floor)
void add_cnr(const ScoredImage& image,
             const DefectPixels& defect,
             double factor,
             ImageF& gradient) {
  const double background = mean_of(image.aspect, defect.ring);
  const double difference = mean_of(image.aspect, defect.inside) - background;
  const auto count = static_cast<double>(defect.ring.size());
  const double ring_sigma = sigma_of(image.aspect, defect.ring, background);
  const double sigma = std::max(ring_sigma, image.sigma_floor);
  if (std::abs(difference) <= kRounding * background) {
    return;
  }
  const double by_difference = factor * sign_of(difference) / sigma;
  add(gradient, defect.inside, by_difference);
  add(gradient, defect.ring, -by_difference);
  if (ring_sigma > image.sigma_floor) {
    const double by_sigma = -factor * std::abs(difference) / (sigma * sigma);
    add_each(gradient, defect.ring, [&](std::size_t pixel) {
      const double rest = static_cast<double>(image.aspect.values()[pixel]) - background;
      return by_sigma * rest / (count * ring_sigma);
    });
  }
}

/// (mean_D - mean_B) / max(mean_B, floor)
void add_weber(const ScoredImage& image,
               const DefectPixels& defect,
               double factor,
               ImageF& gradient) {
  const double background = mean_of(image.aspect, defect.ring);
  const double difference = mean_of(image.aspect, defect.inside) - background;
  const double denominator = std::max(background, image.sigma_floor);
  add(gradient, defect.inside, factor / denominator);
  add(gradient, defect.ring, -factor / denominator);
  if (background > image.sigma_floor) {
    add(gradient, defect.ring, -factor * difference / (denominator * denominator));
  }
}

/// The gradient of a score over all defects, when it is one.
void add_summary(std::string_view score, const ScoredImage& image, ImageF& gradient) {
  const std::vector<DefectScores> scores =
      defect_scores(image.aspect, image.defects, image.sigma_floor);
  const auto signed_weber = [&](std::size_t i, double factor) {
    add_weber(image, image.defects[i], factor * sign_of(scores[i].weber), gradient);
  };
  const auto index_of = [&](auto found) {
    return static_cast<std::size_t>(found - scores.begin());
  };
  if (score == "defects.min_cnr") {
    const std::size_t worst = index_of(std::ranges::min_element(scores, {}, &DefectScores::cnr));
    add_cnr(image, image.defects[worst], 1.0, gradient);
  } else if (score == "defects.min_weber") {
    const auto size = [](const DefectScores& defect) { return std::abs(defect.weber); };
    signed_weber(index_of(std::ranges::min_element(scores, {}, size)), 1.0);
  } else if (score == "defects.mean_weber") {
    for (std::size_t i = 0; i < scores.size(); ++i) {
      signed_weber(i, 1.0 / static_cast<double>(scores.size()));
    }
  }
}

ImageF defect_gradient(std::string_view score, const ScoredImage& image) {
  ImageF gradient(image.aspect.width(), image.aspect.height());
  add_summary(score, image, gradient);
  for (const DefectPixels& defect : image.defects) {
    const std::string prefix = "defects." + defect.label;
    if (score == prefix + ".cnr") {
      add_cnr(image, defect, 1.0, gradient);
    } else if (score == prefix + ".weber") {
      add_weber(image, defect, 1.0, gradient);
    }
  }
  return gradient;
}

}  // namespace

bool has_gradient(std::string_view score) {
  const bool is_whole = std::ranges::find(kWholeScores, score) != kWholeScores.end();
  return is_whole ||
         (score.starts_with("defects.") && (score.ends_with(".cnr") || score.ends_with(".weber")));
}

double noise_share(const ScoredImage& image) {
  if (image.deviation == nullptr) {
    return 0.0;
  }
  const Moments m = moments_of(image, spans_of(image.region));
  return m.noise_variance > 0.0 ? m.noise_variance / (m.deviation * m.deviation + m.noise_variance)
                                : 0.0;
}

std::optional<ImageF> gradient_by_aspect(std::string_view score, const ScoredImage& image) {
  if (!has_gradient(score)) {
    return std::nullopt;
  }
  if (score.starts_with("homogeneity.")) {
    return homogeneity_gradient(score, image);
  }
  if (image.defects.empty()) {
    return std::nullopt;
  }
  return defect_gradient(score, image);
}

}  // namespace glint
