// SPDX-License-Identifier: GPL-3.0-or-later
//
// Phase shifting: mean, amplitude and phase of a cosine in each pixel by least squares over the
// frames. The frames' positions are the same for all pixels, so the normal equations are solved
// once and a pixel costs three weighted sums. The response compares each pixel's phasor with the
// Gaussian mean of those around it, which needs no unwrapping. docs/theory/inspection_masks.md,
// "Phases of shifted stripes". Cost: 3 N products per pixel, and a separable blur of two images.
// Memory: some images.
#include "metrics/inspection/phase.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "core/error.h"
#include "core/units.h"
#include "metrics/inspection/phase_kernels.h"

namespace glint {
namespace {

constexpr int kRowsPerChunk = 16;
constexpr double kLargestNoise = 10.0;  // times that of whole periods

/// Mean, cosine and sine of a pixel are these weights times its frames.
struct PhaseWeights {
  std::vector<float> mean;
  std::vector<float> cosine;
  std::vector<float> sine;
};

Eigen::Vector3d waves_at(int frame, int frames, double periods) {
  const double angle = 2.0 * kPi * periods * frame / frames;
  return {1.0, std::cos(angle), std::sin(angle)};
}

/// Normal equations of mean, sine and cosine.
/// @throws ConfigError  the frames do not determine them
Eigen::Matrix3d normal_equations(int frames, double periods) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (int j = 0; j < frames; ++j) {
    const Eigen::Vector3d wave = waves_at(j, frames, periods);
    normal += wave * wave.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal);
  const double minimum = 1.0 / (kLargestNoise * kLargestNoise) * 0.5 * frames;
  if (!(solver.eigenvalues()(0) > minimum)) {
    throw ConfigError(
        "phases",
        fmt::format("{} frames over {} periods do not determine mean, sine and cosine; "
                    "take one whole period, or other steps",
                    frames,
                    periods));
  }
  return normal;
}

PhaseWeights phase_weights(int frames, double periods) {
  if (frames < 3) {
    throw ConfigError("phases", fmt::format("{} frames, at least 3 are needed", frames));
  }
  if (!(periods > 0.0) || !std::isfinite(periods)) {
    throw ConfigError("phases", fmt::format("{} periods, must be positive", periods));
  }
  const Eigen::Matrix3d inverse = normal_equations(frames, periods).inverse();
  PhaseWeights weights;
  for (int j = 0; j < frames; ++j) {
    const Eigen::Vector3d weight = inverse * waves_at(j, frames, periods);
    weights.mean.push_back(static_cast<float>(weight(0)));
    weights.cosine.push_back(static_cast<float>(weight(1)));
    weights.sine.push_back(static_cast<float>(weight(2)));
  }
  return weights;
}

void check_sizes(std::span<const ImageF> frames) {
  for (std::size_t j = 1; j < frames.size(); ++j) {
    if (frames[j].width() != frames[0].width() || frames[j].height() != frames[0].height()) {
      throw ConfigError("phases",
                        fmt::format("frame {} has {} x {} pixels, the first {} x {}",
                                    j + 1,
                                    frames[j].width(),
                                    frames[j].height(),
                                    frames[0].width(),
                                    frames[0].height()));
    }
  }
}

/// Calls body(y) for all rows, some at a time.
template <class Body>
void for_rows(int height, ThreadPool& pool, const Body& body) {
  pool.for_each((height + kRowsPerChunk - 1) / kRowsPerChunk, [&](std::int64_t chunk) {
    const int first = static_cast<int>(chunk) * kRowsPerChunk;
    for (int y = first; y < std::min(first + kRowsPerChunk, height); ++y) {
      body(y);
    }
  });
}

void combine_row(std::span<const ImageF> frames,
                 const std::vector<float>& weights,
                 int y,
                 ImageF& sum) {
  for (std::size_t j = 0; j < frames.size(); ++j) {
    add_scaled(frames[j].row(y), weights[j], sum.row(y), sum.width());
  }
}

/// amplitude (cos, sin) of each pixel.
struct Phasors {
  ImageF cosine;
  ImageF sine;
};

void check_finite(const Phasors& phasors, int y) {
  double sum = 0.0;
  for (int x = 0; x < phasors.cosine.width(); ++x) {
    sum += static_cast<double>(phasors.cosine(x, y)) + static_cast<double>(phasors.sine(x, y));
  }
  if (!std::isfinite(sum)) {
    throw ConfigError("phases", fmt::format("row {} of the frames holds NaN or infinity", y + 1));
  }
}

Phasors phasors_of(std::span<const ImageF> frames, const PhaseWeights& weights, ThreadPool& pool) {
  check_sizes(frames);
  const ImageF zero(frames[0].width(), frames[0].height());
  Phasors phasors{.cosine = zero, .sine = zero};
  for_rows(zero.height(), pool, [&](int y) {
    combine_row(frames, weights.cosine, y, phasors.cosine);
    combine_row(frames, weights.sine, y, phasors.sine);
    check_finite(phasors, y);
  });
  return phasors;
}

void clear_outside(const Mask& mask, Phasors& phasors) {
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] == 0) {
      phasors.cosine.values()[i] = 0.0F;
      phasors.sine.values()[i] = 0.0F;
    }
  }
}

std::vector<float> gaussian_taps(int kernel_px, double sigma_px) {
  const int half = kernel_px / 2;
  const double sigma = sigma_px > 0.0 ? sigma_px : 0.3 * (half - 1.0) + 0.8;
  std::vector<double> exact;
  double sum = 0.0;
  for (int k = -half; k <= half; ++k) {
    exact.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += exact.back();
  }
  std::vector<float> taps;
  for (const double tap : exact) {
    taps.push_back(static_cast<float>(tap / sum));
  }
  return taps;
}

/// Zero beyond the border. What the window misses there or outside the mask scales cosine and sine
/// alike, so the angle needs no division by the share it sees.
ImageF smoothed(const ImageF& image, const std::vector<float>& taps, ThreadPool& pool) {
  const int count = static_cast<int>(taps.size());
  const int half = count / 2;
  const int width = image.width();
  ImageF along(width, image.height());
  for_rows(image.height(), pool, [&](int y) {
    std::vector<float> padded(static_cast<std::size_t>(width + 2 * half));
    std::copy_n(image.row(y), width, padded.begin() + half);
    convolve_along(padded.data(), taps.data(), count, along.row(y), width);
  });
  ImageF result(width, image.height());
  for_rows(image.height(), pool, [&](int y) {
    const int first = std::max(y - half, 0);
    const int last = std::min(y + half, image.height() - 1);
    for (int v = first; v <= last; ++v) {
      add_scaled(along.row(v), taps[static_cast<std::size_t>(v - y + half)], result.row(y), width);
    }
  });
  return result;
}

/// The angle from one phasor to another, in periods.
float turn_between(float cos_from, float sin_from, float cos_to, float sin_to) {
  const float cross = cos_from * sin_to - sin_from * cos_to;
  const float dot = cos_from * cos_to + sin_from * sin_to;
  return std::atan2(cross, dot) * static_cast<float>(0.5 / kPi);
}

}  // namespace

PhaseMaps phase_maps(std::span<const ImageF> frames, double periods, ThreadPool& pool) {
  const PhaseWeights weights = phase_weights(static_cast<int>(frames.size()), periods);
  const Phasors phasors = phasors_of(frames, weights, pool);
  const ImageF zero(frames[0].width(), frames[0].height());
  PhaseMaps maps{.mean = zero, .modulation = zero, .phase_rad = zero};
  for_rows(zero.height(), pool, [&](int y) {
    combine_row(frames, weights.mean, y, maps.mean);
    for (int x = 0; x < zero.width(); ++x) {
      const float cosine = phasors.cosine(x, y);
      const float sine = phasors.sine(x, y);
      const float mean = maps.mean(x, y);
      maps.modulation(x, y) = mean > 0.0F ? std::hypot(cosine, sine) / mean : 0.0F;
      maps.phase_rad(x, y) = std::atan2(sine, cosine);
    }
  });
  return maps;
}

ImageF phase_response(std::span<const ImageF> frames,
                      double periods,
                      const Mask& mask,
                      int kernel_px,
                      double sigma_px,
                      ThreadPool& pool) {
  GLINT_CHECK(kernel_px >= 3 && kernel_px % 2 == 1, "the kernel must be odd");
  Phasors phasors =
      phasors_of(frames, phase_weights(static_cast<int>(frames.size()), periods), pool);
  GLINT_CHECK(mask.width() == frames[0].width() && mask.height() == frames[0].height(),
              "mask and frames differ in size");
  clear_outside(mask, phasors);
  const std::vector<float> taps = gaussian_taps(kernel_px, sigma_px);
  const ImageF cosine = smoothed(phasors.cosine, taps, pool);
  const ImageF sine = smoothed(phasors.sine, taps, pool);
  ImageF response(mask.width(), mask.height());
  for_rows(mask.height(), pool, [&](int y) {
    for (int x = 0; x < mask.width(); ++x) {
      const float c = phasors.cosine(x, y);
      const float s = phasors.sine(x, y);
      if (c * c + s * s >= kMinAmplitude * kMinAmplitude) {
        response(x, y) = turn_between(cosine(x, y), sine(x, y), c, s);
      }
    }
  });
  return response;
}

}  // namespace glint
