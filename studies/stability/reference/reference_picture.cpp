// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/reference/reference_picture.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace glint::stability {
namespace {

constexpr double kBlurSigmas = 5.0;
constexpr int kGreyTable = 2048;
constexpr double kManyElectrons = 2e4;

struct Film {
  int width = 0;
  int height = 0;
  std::vector<double> values;
};

Film film_at(const ReferenceScene& scene, const ReferenceRays& rays, int position) {
  const ReferenceWall& wall = scene.wall;
  const double shift_mm = position * wall.step_mm;
  const int count = rays.samples * rays.samples;
  Film film{.width = kFilm * scene.camera.width_px, .height = kFilm * scene.camera.height_px};
  film.values.resize(static_cast<std::size_t>(film.width) * static_cast<std::size_t>(film.height));
  const double* x = rays.x_mm.data();
  for (int py = 0; py < scene.camera.height_px; ++py) {
    for (int px = 0; px < scene.camera.width_px; ++px) {
      for (int cell = 0; cell < kFilm * kFilm; ++cell) {
        int bright = 0;
        for (int s = 0; s < count; ++s, ++x) {
          const double moved = *x - shift_mm;
          const double phase = (moved - wall.offset_mm) / wall.period_mm;
          bright += std::abs(moved) < 0.5 * wall.length_mm && phase - std::floor(phase) < wall.duty
                        ? 1
                        : 0;
        }
        const int at = (kFilm * py + cell / kFilm) * film.width + kFilm * px + cell % kFilm;
        film.values[static_cast<std::size_t>(at)] = static_cast<double>(bright) / count;
      }
    }
  }
  return film;
}

/// One pass of a Gaussian along a line of values that lie `stride` apart; the ends are repeated.
void blur_line(double* line, int length, int stride, const std::vector<double>& weights) {
  const int radius = static_cast<int>(weights.size()) - 1;
  std::vector<double> source(static_cast<std::size_t>(length + 2 * radius));
  for (int i = 0; i < length + 2 * radius; ++i) {
    source[static_cast<std::size_t>(i)] = line[std::clamp(i - radius, 0, length - 1) * stride];
  }
  for (int i = 0; i < length; ++i) {
    const double* centre = source.data() + i + radius;
    double sum = weights[0] * centre[0];
    for (int k = 1; k <= radius; ++k) {
      sum += weights[static_cast<std::size_t>(k)] * (centre[k] + centre[-k]);
    }
    line[i * stride] = sum;
  }
}

void blur(double sigma_px, Film& film) {
  if (sigma_px == 0.0) {
    return;
  }
  const double sigma = kFilm * sigma_px;
  std::vector<double> weights;
  double total = 0.0;
  for (int k = 0; k <= std::ceil(kBlurSigmas * sigma); ++k) {
    // The Gaussian's share of a film cell.
    const double low = (k - 0.5) / (sigma * std::sqrt(2.0));
    const double high = (k + 0.5) / (sigma * std::sqrt(2.0));
    weights.push_back(0.5 * (std::erf(high) - std::erf(low)));
    total += (k == 0 ? 1.0 : 2.0) * weights.back();
  }
  for (double& weight : weights) {
    weight /= total;
  }
  for (int y = 0; y < film.height; ++y) {
    blur_line(
        film.values.data() + static_cast<std::ptrdiff_t>(y) * film.width, film.width, 1, weights);
  }
  for (int x = 0; x < film.width; ++x) {
    blur_line(film.values.data() + x, film.height, film.width, weights);
  }
}

double rounded_grey(const SensorSettings& sensor, double grey) {
  const double clipped = std::clamp(grey, 0.0, 1.0);
  const double levels = std::exp2(sensor.bits) - 1.0;
  return sensor.bits == 0 ? clipped : std::floor(clipped * levels + 0.5) / levels;
}

/// expected_grey() of all radiances of a frame, by a table where each value is a long sum.
class GreyTable {
 public:
  explicit GreyTable(const SensorSettings& sensor) : sensor_(sensor) {
    if (sensor.full_well_e > 0.0) {
      for (int i = 0; i <= kGreyTable; ++i) {
        table_.push_back(expected_grey(sensor, static_cast<double>(i) / kGreyTable));
      }
    }
  }

  std::array<double, 2> at(double radiance) const {
    if (table_.empty()) {
      return {rounded_grey(sensor_, sensor_.gain * sensor_.exposure * radiance), 0.0};
    }
    const double place = std::clamp(radiance, 0.0, 1.0) * kGreyTable;
    const auto below = static_cast<std::size_t>(std::min(place, kGreyTable - 1.0));
    const double share = place - static_cast<double>(below);
    const auto& a = table_[below];
    const auto& b = table_[below + 1];
    return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
  }

 private:
  SensorSettings sensor_;
  std::vector<std::array<double, 2>> table_;
};

/// Pixels wholly on the part, without its rim and its dents.
std::vector<char> region_of(const ReferenceScene& scene, const ReferenceRays& rays) {
  const int rim = scene.metrics.erosion_px;
  const ImageF& coverage = rays.coverage;
  std::vector<char> region;
  for (int y = 0; y < coverage.height(); ++y) {
    for (int x = 0; x < coverage.width(); ++x) {
      bool is_in =
          x >= rim && y >= rim && x < coverage.width() - rim && y < coverage.height() - rim;
      for (int i = 0; is_in && i < (2 * rim + 1) * (2 * rim + 1); ++i) {
        is_in = coverage(x - rim + i % (2 * rim + 1), y - rim + i / (2 * rim + 1)) == 1.0F;
      }
      for (const ImageF& radii : rays.radii) {
        is_in = is_in && static_cast<double>(radii(x, y)) > scene.metrics.exclusion_radii;
      }
      region.push_back(is_in ? 1 : 0);
    }
  }
  return region;
}

/// The largest mean difference over a dent's pixels of any frame.
class Changes {
 public:
  Changes(const ReferenceScene& scene, const ReferenceRays& rays)
      : pixels_(scene.dent_pixels), largest_(rays.radii.size(), 0.0) {
    for (std::size_t dent = pixels_.size(); dent < rays.radii.size(); ++dent) {
      const auto& radii = rays.radii[dent].values();
      pixels_.emplace_back();
      for (std::size_t i = 0; i < radii.size(); ++i) {
        if (radii[i] <= 1.0F && rays.coverage.values()[i] == 1.0F) {
          pixels_.back().push_back(i);
        }
      }
    }
  }

  void add(const std::vector<double>& with, const std::vector<double>& without) {
    for (std::size_t dent = 0; dent < largest_.size(); ++dent) {
      double sum = 0.0;
      for (const std::size_t i : pixels_[dent]) {
        sum += std::abs(with[i] - without[i]);
      }
      const auto count = static_cast<double>(std::max<std::size_t>(1, pixels_[dent].size()));
      largest_[dent] = std::max(largest_[dent], sum / count);
    }
  }

  const std::vector<double>& largest() const { return largest_; }

 private:
  std::vector<std::vector<std::size_t>> pixels_;
  std::vector<double> largest_;
};

std::vector<double> exposed(const GreyTable& grey,
                            const std::vector<double>& radiance,
                            ReferenceImage* sum) {
  std::vector<double> frame;
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    const auto [mean, variance] = grey.at(radiance[i]);
    frame.push_back(mean);
    if (sum != nullptr) {
      sum->mean[i] += mean;
      sum->variance[i] += variance;
    }
  }
  return frame;
}

/// 1 - sigma / mu with what the noise adds to sigma^2.
void score(ReferenceScores& scores) {
  double count = 0.0;
  double sum = 0.0;
  double square = 0.0;
  double noise = 0.0;
  for (std::size_t i = 0; i < scores.region.size(); ++i) {
    if (scores.region[i] != 0) {
      count += 1.0;
      sum += scores.aspect.mean[i];
      square += scores.aspect.mean[i] * scores.aspect.mean[i];
      noise += scores.aspect.variance[i];
    }
  }
  if (count == 0.0) {
    throw ConfigError("metrics.erosion_px", "no pixel of the part is left to score");
  }
  scores.mean = sum / count;
  const double spread = std::max(0.0, square / count - scores.mean * scores.mean) + noise / count;
  scores.h_rms = scores.mean > 0.0 ? 1.0 - std::sqrt(spread) / scores.mean : -std::sqrt(count);
}

}  // namespace

std::vector<double> reference_radiance(const ReferenceScene& scene,
                                       const ReferenceRays& rays,
                                       int position) {
  Film film = film_at(scene, rays, position);
  blur(scene.sensor.blur_px, film);
  std::vector<double> pixels;
  for (int py = 0; py < scene.camera.height_px; ++py) {
    for (int px = 0; px < scene.camera.width_px; ++px) {
      double sum = 0.0;
      for (int cell = 0; cell < kFilm * kFilm; ++cell) {
        const int at = (kFilm * py + cell / kFilm) * film.width + kFilm * px + cell % kFilm;
        sum += film.values[static_cast<std::size_t>(at)];
      }
      pixels.push_back(sum / (kFilm * kFilm));
    }
  }
  return pixels;
}

std::array<double, 2> expected_grey(const SensorSettings& sensor, double radiance) {
  const double electrons = sensor.exposure * sensor.full_well_e * radiance;
  if (sensor.full_well_e == 0.0 || electrons > kManyElectrons) {
    const double grey = sensor.gain * sensor.exposure * radiance;
    const double variance = sensor.full_well_e == 0.0 || grey >= 1.0
                                ? 0.0
                                : electrons * std::pow(sensor.gain / sensor.full_well_e, 2.0);
    return {rounded_grey(sensor, grey), variance};
  }
  double mean = 0.0;
  double square = 0.0;
  const double spread = 12.0 * std::sqrt(electrons) + 20.0;
  double k = std::max(0.0, std::floor(electrons - spread));
  while (k <= electrons + spread) {
    const double log_p = electrons > 0.0
                             ? k * std::log(electrons) - electrons - std::lgamma(k + 1.0)
                             : (k == 0.0 ? 0.0 : -1e9);
    const double grey = rounded_grey(sensor, k * sensor.gain / sensor.full_well_e);
    mean += std::exp(log_p) * grey;
    square += std::exp(log_p) * grey * grey;
    k += 1.0;
  }
  return {mean, std::max(0.0, square - mean * mean)};
}

ReferenceScores reference_scores(const ReferenceScene& scene, const RaySampling& sampling) {
  const ReferenceRays rays = trace_reference(scene, sampling);
  RaySampling flawless_sampling = sampling;
  flawless_sampling.has_dents = false;
  const bool has_dents = !scene.part.dents.empty();
  const ReferenceRays flawless =
      has_dents ? trace_reference(scene, flawless_sampling) : ReferenceRays();
  const GreyTable grey(scene.sensor);
  ReferenceScores scores;
  scores.region = region_of(scene, rays);
  scores.aspect.mean.assign(scores.region.size(), 0.0);
  scores.aspect.variance = scores.aspect.mean;
  Changes changes(scene, rays);
  for (int k = 0; k < scene.wall.positions; ++k) {
    const auto frame = exposed(grey, reference_radiance(scene, rays, k), &scores.aspect);
    if (has_dents) {
      changes.add(frame, exposed(grey, reference_radiance(scene, flawless, k), nullptr));
    }
  }
  for (std::size_t i = 0; i < scores.region.size(); ++i) {
    scores.aspect.mean[i] /= scene.wall.positions;
    scores.aspect.variance[i] /= std::pow(scene.wall.positions, 2.0);
  }
  scores.change = changes.largest();
  score(scores);
  return scores;
}

}  // namespace glint::stability
