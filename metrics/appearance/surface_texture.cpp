// SPDX-License-Identifier: GPL-3.0-or-later
//
// Spectra by Welch's method: windows under a Hann taper, overlapping by half, their periodograms'
// mean; the autocorrelation is its transform (Wiener and Khinchin). The transform is Eigen's.
#include "metrics/appearance/surface_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <span>

#include <unsupported/Eigen/FFT>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

using Complex = std::complex<double>;

constexpr double kLowCycles = 0.02;  ///< the band in which spectra are compared
constexpr double kHighCycles = 0.4;
constexpr std::size_t kDirections = 36;
constexpr double kFallen = 0.2;  ///< ISO 25178-2: autocorrelation length
constexpr int kSmallestWindowPx = 16;

struct Window {
  int x = 0;
  int y = 0;
};

/// Sums over all pixels above and to the left.
Image<std::int32_t> summed(const Mask& region) {
  Image<std::int32_t> sums(region.width() + 1, region.height() + 1);
  for (int y = 0; y < region.height(); ++y) {
    for (int x = 0; x < region.width(); ++x) {
      sums(x + 1, y + 1) =
          sums(x, y + 1) + sums(x + 1, y) - sums(x, y) + (region(x, y) != 0 ? 1 : 0);
    }
  }
  return sums;
}

std::vector<Window> windows_in(const ImageF& picture, const Mask& region, int size) {
  std::vector<Window> windows;
  const Image<std::int32_t> sums = region.empty() ? Image<std::int32_t>() : summed(region);
  for (int y = 0; y + size <= picture.height(); y += size / 2) {
    for (int x = 0; x + size <= picture.width(); x += size / 2) {
      const bool is_whole = region.empty() || sums(x + size, y + size) - sums(x, y + size) -
                                                      sums(x + size, y) + sums(x, y) ==
                                                  size * size;
      if (is_whole) {
        windows.push_back({.x = x, .y = y});
      }
    }
  }
  return windows;
}

/// At most so many, evenly from all of them.
std::vector<Window> thinned(const std::vector<Window>& windows, int max_windows) {
  const auto most = static_cast<std::size_t>(max_windows);
  std::vector<Window> kept;
  for (std::size_t i = 0; i < std::min(most, windows.size()); ++i) {
    kept.push_back(windows[windows.size() <= most ? i : i * windows.size() / most]);
  }
  return kept;
}

/// Of one row or column after another, in place.
class PlaneTransform {
 public:
  explicit PlaneTransform(int size) : size_(static_cast<std::size_t>(size)) {}

  void forward(std::vector<Complex>& plane) {
    std::vector<Complex> line(size_);
    std::vector<Complex> result(size_);
    for (std::size_t y = 0; y < size_; ++y) {
      std::copy_n(plane.begin() + static_cast<std::ptrdiff_t>(y * size_), size_, line.begin());
      fft_.fwd(result, line);
      std::ranges::copy(result, plane.begin() + static_cast<std::ptrdiff_t>(y * size_));
    }
    for (std::size_t x = 0; x < size_; ++x) {
      for (std::size_t y = 0; y < size_; ++y) {
        line[y] = plane[y * size_ + x];
      }
      fft_.fwd(result, line);
      for (std::size_t y = 0; y < size_; ++y) {
        plane[y * size_ + x] = result[y];
      }
    }
  }

 private:
  std::size_t size_;
  Eigen::FFT<double> fft_;
};

std::vector<double> hann(int size) {
  std::vector<double> taper;
  for (int i = 0; i < size; ++i) {
    taper.push_back(0.5 - 0.5 * std::cos(2.0 * kPi * (i + 0.5) / size));
  }
  return taper;
}

double window_mean(const ImageF& picture, const Window& at, int size) {
  double sum = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      sum += static_cast<double>(picture(at.x + x, at.y + y));
    }
  }
  return sum / (static_cast<double>(size) * size);
}

/// Adds the periodogram of a window, grey over its mean, and returns the window's relative
/// variance.
double add_periodogram(const ImageF& picture,
                       const Window& at,
                       std::span<const double> taper,
                       PlaneTransform& transform,
                       std::vector<double>& power) {
  const int size = static_cast<int>(taper.size());
  const double mean = window_mean(picture, at, size);
  std::vector<Complex> plane(power.size());
  double variance = 0.0;
  double weight = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double grey = static_cast<double>(picture(at.x + x, at.y + y)) / std::max(mean, 1e-9);
      const double w = taper[static_cast<std::size_t>(x)] * taper[static_cast<std::size_t>(y)];
      plane[static_cast<std::size_t>(y * size + x)] = w * (grey - 1.0);
      variance += (grey - 1.0) * (grey - 1.0);
      weight += w * w;
    }
  }
  transform.forward(plane);
  for (std::size_t i = 0; i < power.size(); ++i) {
    power[i] += std::norm(plane[i]) / weight;
  }
  return variance / static_cast<double>(power.size());
}

/// Signed frequency of an index, in cycles per window.
int signed_frequency(std::size_t index, std::size_t size) {
  return index < (size + 1) / 2 ? static_cast<int>(index)
                                : static_cast<int>(index) - static_cast<int>(size);
}

/// Mean power over the direction, by cycles in a window.
void set_radial_spectrum(const std::vector<double>& power,
                         std::size_t size,
                         SurfaceTexture& texture) {
  texture.radial.assign(size / 2, 0.0);
  std::vector<double> counts(size / 2, 0.0);
  for (std::size_t y = 0; y < size; ++y) {
    for (std::size_t x = 0; x < size; ++x) {
      const int u = signed_frequency(x, size);
      const int v = signed_frequency(y, size);
      const auto bin = static_cast<std::size_t>(std::hypot(u, v));
      if (bin < texture.radial.size() && (u != 0 || v != 0)) {
        texture.radial[bin] += power[y * size + x];
        counts[bin] += 1.0;
      }
    }
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    texture.radial[i] /= std::max(counts[i], 1.0);
  }
}

/// The direction of a wave, 0 to below pi.
double direction_rad(int u, int v) {
  const double angle = std::atan2(v, u);
  return angle < 0.0 ? angle + kPi : angle;
}

/// Shares of the power by direction, and the lay: how strong it is and where it runs.
void set_directions(const std::vector<double>& power, std::size_t size, SurfaceTexture& texture) {
  texture.angular.assign(kDirections, 0.0);
  double sum = 0.0;
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t i = 0; i < power.size(); ++i) {
    const int u = signed_frequency(i % size, size);
    const int v = signed_frequency(i / size, size);
    const double per_px = std::hypot(u, v) / static_cast<double>(size);
    if (per_px >= kLowCycles && per_px <= kHighCycles) {
      const double angle = direction_rad(u, v);
      const auto direction = static_cast<std::size_t>(std::floor(angle / kPi * kDirections + 0.5));
      texture.angular[direction % kDirections] += power[i];
      sum += power[i];
      cosine += power[i] * std::cos(2.0 * angle);
      sine += power[i] * std::sin(2.0 * angle);
    }
  }
  for (double& share : texture.angular) {
    share /= sum > 0.0 ? sum : 1.0;
  }
  texture.lay_strength = sum > 0.0 ? std::hypot(cosine, sine) / sum : 0.0;
  // Waves run across the lines of a lay.
  texture.lay_rad = std::fmod(0.5 * std::atan2(sine, cosine) + 1.5 * kPi, kPi);
}

/// Where the autocorrelation along a direction first falls to kFallen, at most half a window.
double fallen_at(const std::vector<double>& correlation, std::size_t size, double angle_rad) {
  const auto at = [&](double x, double y) {
    const auto wrap = [&](int i) {
      return static_cast<std::size_t>((i % static_cast<int>(size) + static_cast<int>(size))) % size;
    };
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    const auto value = [&](int i, int j) { return correlation[wrap(j) * size + wrap(i)]; };
    const double u = x - x0;
    const double v = y - y0;
    return (1.0 - v) * ((1.0 - u) * value(x0, y0) + u * value(x0 + 1, y0)) +
           v * ((1.0 - u) * value(x0, y0 + 1) + u * value(x0 + 1, y0 + 1));
  };
  constexpr double kStepPx = 0.25;
  double before = 1.0;
  for (int i = 1; i * kStepPx <= 0.5 * static_cast<double>(size); ++i) {
    const double r = i * kStepPx;
    const double now = at(r * std::cos(angle_rad), r * std::sin(angle_rad)) / correlation[0];
    if (now <= kFallen) {
      return r - kStepPx * (kFallen - now) / std::max(before - now, 1e-12);
    }
    before = now;
  }
  return 0.5 * static_cast<double>(size);
}

void set_lengths(const std::vector<double>& power, int size, SurfaceTexture& texture) {
  std::vector<Complex> plane(power.begin(), power.end());
  plane[0] = 0.0;
  PlaneTransform(size).forward(plane);
  std::vector<double> correlation(plane.size());
  std::ranges::transform(plane, correlation.begin(), [](const Complex& c) { return c.real(); });
  if (correlation[0] <= 0.0) {
    return;
  }
  texture.autocorrelation_px = 0.5 * size;
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double angle = kPi * static_cast<double>(i) / kDirections;
    const double length = fallen_at(correlation, static_cast<std::size_t>(size), angle);
    texture.autocorrelation_px = std::min(texture.autocorrelation_px, length);
    texture.longest_px = std::max(texture.longest_px, length);
  }
}

/// Levels of equal width over mean +- 3 standard deviations, so that exposure does not count.
class Levels {
 public:
  Levels(double mean, double deviation, int count)
      : low_(mean - 3.0 * deviation),
        per_grey_(count / std::max(6.0 * deviation, 1e-12)),
        count_(count) {}

  int of(float grey) const {
    const double at = (static_cast<double>(grey) - low_) * per_grey_;
    return static_cast<int>(std::clamp(at, 0.0, count_ - 1.0));
  }

 private:
  double low_;
  double per_grey_;
  int count_;
};

void add_features(const std::vector<double>& counts, int levels, Cooccurrence& features) {
  double total = 0.0;
  double mean = 0.0;
  double square = 0.0;
  double product = 0.0;
  for (int i = 0; i < levels; ++i) {
    for (int j = 0; j < levels; ++j) {
      const double count = counts[static_cast<std::size_t>(i * levels + j)];
      total += count;
      mean += count * i;
      square += count * i * i;
      product += count * i * j;
    }
  }
  mean /= total;
  const double variance = square / total - mean * mean;
  features.correlation +=
      0.25 * (variance > 0.0 ? (product / total - mean * mean) / variance : 1.0);
  for (int i = 0; i < levels; ++i) {
    for (int j = 0; j < levels; ++j) {
      const double share = counts[static_cast<std::size_t>(i * levels + j)] / total;
      if (share > 0.0) {
        features.contrast += 0.25 * share * (i - j) * (i - j);
        features.energy += 0.25 * share * share;
        features.entropy -= 0.25 * share * std::log2(share);
      }
    }
  }
}

/// Grey levels about the mean of a window.
Levels levels_in(const ImageF& picture, const Window& at, int size, int levels) {
  const double mean = window_mean(picture, at, size);
  double square = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      square += std::pow(static_cast<double>(picture(at.x + x, at.y + y)) - mean, 2);
    }
  }
  return {mean, std::sqrt(square / (static_cast<double>(size) * size)), levels};
}

Cooccurrence cooccurrence_of(const ImageF& picture,
                             std::span<const Window> windows,
                             int size,
                             int levels) {
  constexpr std::array<std::array<int, 2>, 4> kLags = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  Cooccurrence features;
  std::vector<std::vector<double>> counts(kLags.size());
  for (std::vector<double>& lag : counts) {
    lag.assign(static_cast<std::size_t>(levels) * static_cast<std::size_t>(levels), 0.0);
  }
  for (const Window& at : windows) {
    const Levels level = levels_in(picture, at, size, levels);
    for (int y = 1; y + 1 < size; ++y) {
      for (int x = 0; x + 1 < size; ++x) {
        const int i = level.of(picture(at.x + x, at.y + y));
        for (std::size_t k = 0; k < kLags.size(); ++k) {
          const int j = level.of(picture(at.x + x + kLags[k][0], at.y + y + kLags[k][1]));
          counts[k][static_cast<std::size_t>(i * levels + j)] += 1.0;
          counts[k][static_cast<std::size_t>(j * levels + i)] += 1.0;
        }
      }
    }
  }
  for (const std::vector<double>& lag : counts) {
    add_features(lag, levels, features);
  }
  return features;
}

/// Mean of the windows' periodograms, size x size. @param[out] spread  standard deviation in them
std::vector<double> mean_periodogram(const ImageF& picture,
                                     std::span<const Window> windows,
                                     int size,
                                     double& spread) {
  const std::vector<double> taper = hann(size);
  PlaneTransform transform(size);
  std::vector<double> power(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 0.0);
  double variance = 0.0;
  for (const Window& at : windows) {
    variance += add_periodogram(picture, at, taper, transform, power);
  }
  const auto count = static_cast<double>(windows.size());
  for (double& value : power) {
    value /= count;
  }
  spread = std::sqrt(variance / count);
  return power;
}

/// Root mean square of the decades between two radial spectra.
double radial_distance(const SurfaceTexture& first, const SurfaceTexture& second) {
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < first.radial.size(); ++i) {
    const double cycles = (static_cast<double>(i) + 0.5) / first.window_px;
    if (cycles >= kLowCycles && cycles <= kHighCycles) {
      const double ratio =
          std::log10(std::max(first.radial[i], 1e-12) / std::max(second.radial[i], 1e-12));
      squares += ratio * ratio;
      count += 1.0;
    }
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace

SurfaceTexture texture_of(const ImageF& picture,
                          const Mask& region,
                          const TextureWindows& settings) {
  SurfaceTexture texture;
  int size = settings.window_px;
  std::vector<Window> windows = windows_in(picture, region, size);
  while (windows.empty() && size > kSmallestWindowPx) {
    size /= 2;
    windows = windows_in(picture, region, size);
  }
  windows = thinned(windows, settings.max_windows);
  texture.windows = static_cast<int>(windows.size());
  texture.window_px = size;
  if (windows.empty()) {
    return texture;
  }
  const std::vector<double> power = mean_periodogram(picture, windows, size, texture.spread);
  set_radial_spectrum(power, static_cast<std::size_t>(size), texture);
  set_directions(power, static_cast<std::size_t>(size), texture);
  set_lengths(power, size, texture);
  texture.cooccurrence = cooccurrence_of(picture, windows, size, settings.grey_levels);
  return texture;
}

TextureDistance distance_between(const SurfaceTexture& first, const SurfaceTexture& second) {
  if (first.windows == 0 || second.windows == 0 || first.window_px != second.window_px) {
    throw ConfigError("appearance: textures are compared by windows of one size");
  }
  TextureDistance distance;
  distance.radial = radial_distance(first, second);
  for (std::size_t i = 0; i < first.angular.size(); ++i) {
    distance.angular += 0.5 * std::abs(first.angular[i] - second.angular[i]);
  }
  const auto log_ratio = [](double a, double b) {
    return std::abs(std::log(std::max(a, 1e-9) / std::max(b, 1e-9)));
  };
  distance.contrast = log_ratio(first.cooccurrence.contrast, second.cooccurrence.contrast);
  distance.length = log_ratio(first.autocorrelation_px, second.autocorrelation_px);
  const double between = std::abs(first.lay_rad - second.lay_rad);
  distance.lay_rad = std::min(between, kPi - between);
  return distance;
}

}  // namespace glint
