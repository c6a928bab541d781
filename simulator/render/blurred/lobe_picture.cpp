// SPDX-License-Identifier: GPL-3.0-or-later
//
// A quadtree over tiles of 16 x 16 pixels. A square is interpolated to second order between 3 x 3
// nodes when all its rays run as interpolated between those of the nodes, and when at two points
// between them the summed light is the interpolated one; else it is cut in four. Pixels whose rays
// part (silhouettes, steep defects) are summed ray by ray. Cost: 30 to 80 us a summed point.
#include "simulator/render/blurred/lobe_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <span>

#include "core/parabola.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr int kTile = 16;
constexpr int kBand = 8 * kTile;  ///< rows that share their nodes; another thread may do the next
/// Largest error of an interpolated picture, of full scale.
constexpr double kAllowed = 8e-4;
/// Largest distance of a ray from the interpolated one, in widths alpha of the lobe.
constexpr double kAllowedTurn = 0.02;

/// Three pixels in a line: ends and middle; at the picture's edge some are the same.
using Nodes = std::array<int, 3>;

Nodes nodes_of(int first, int last) {
  return {first, (first + last) / 2, last};
}

struct Square {
  Nodes x, y;     ///< 3 x 3 of them
  int end_x = 0;  ///< of the pixels that it stands for
  int end_y = 0;
  int size = 1;
};

constexpr std::size_t kNodes = 9;

class LobePicture {
 public:
  LobePicture(const LobeTask& task, BlurredPixels& pixels)
      : cache_(task.cache),
        response_(task.response),
        period_mm_(task.tunnel.period_mm),
        duty_(task.tunnel.duty),
        phase_mm_(task.phase_mm),
        gain_(task.gain),
        camera_mm_(task.camera_in_world_mm),
        turn_(kAllowedTurn * task.alpha),
        per_axis_(static_cast<int>(std::lround(std::sqrt(task.cache.samples)))),
        weight_(wave_factors(task.response.harmonics(), task.tunnel, 0.0)),
        numbers_(task.response.size()),
        nodes_(static_cast<std::size_t>(task.cache.num_pixels()), -1),
        pixels_(pixels) {}

  /// The rows of a band. @return points at which directions were summed
  std::int64_t fill(int band) {
    const int end = std::min(cache_.height_px, (band + 1) * kBand);
    for (int y = band * kBand; y < end; y += kTile) {
      for (int x = 0; x < cache_.width_px; x += kTile) {
        fill_square(x, y, kTile);
      }
    }
    return points_;
  }

 private:
  std::size_t ray_of(int x, int y, int sample) const {
    return static_cast<std::size_t>(sample) * static_cast<std::size_t>(cache_.num_pixels()) +
           static_cast<std::size_t>(y) * static_cast<std::size_t>(cache_.width_px) +
           static_cast<std::size_t>(x);
  }

  bool is_seen(std::size_t ray) const { return cache_.weight[ray] > 0.0F; }

  /// Whether its phase runs on smoothly to its neighbours.
  bool has_phase(std::size_t ray) const { return is_seen(ray) && !std::isnan(phase_mm_[ray]); }

  /// The ray that stands for the pixel.
  int node_sample() const { return (per_axis_ / 2) * per_axis_ + per_axis_ / 2; }

  /// Of a sample within its pixel, from that of the node.
  double offset(int index) const {
    const int node = per_axis_ / 2;
    return static_cast<double>(index - node) / per_axis_;
  }

  Vector3d direction(std::size_t ray) const {
    return {static_cast<double>(cache_.direction_x[ray]),
            static_cast<double>(cache_.direction_y[ray]),
            static_cast<double>(cache_.direction_z[ray])};
  }

  void sum_lobe(std::size_t ray, std::span<float> numbers) {
    const Vector3d point_mm(static_cast<double>(cache_.origin_x[ray]),
                            static_cast<double>(cache_.origin_y[ray]),
                            static_cast<double>(cache_.origin_z[ray]));
    const double phase_mm = has_phase(ray) ? static_cast<double>(phase_mm_[ray]) : 0.0;
    response_.at({.point_mm = point_mm,
                  .to_viewer = (camera_mm_ - point_mm).normalized(),
                  .mirrored = direction(ray).normalized()},
                 phase_mm,
                 numbers);
    ++points_;
  }

  std::span<const float> node(int x, int y) {
    const std::size_t pixel = ray_of(x, y, 0);
    if (nodes_[pixel] < 0) {
      const std::size_t end = kept_.size();
      nodes_[pixel] = static_cast<std::int32_t>(end / response_.size());
      kept_.resize(end + response_.size());
      sum_lobe(ray_of(x, y, node_sample()), std::span(kept_).subspan(end));
    }
    return {kept_.data() + static_cast<std::size_t>(nodes_[pixel]) * response_.size(),
            response_.size()};
  }

  static std::array<double, kNodes> shares_at(const Square& square, double x, double y) {
    const auto along = parabola_shares(square.x, x);
    const auto across = parabola_shares(square.y, y);
    std::array<double, kNodes> shares;
    for (std::size_t i = 0; i < kNodes; ++i) {
      shares[i] = along[i % 3] * across[i / 3];
    }
    return shares;
  }

  template <class Visit>
  void visit_rays(const Square& square, const Visit& visit) const {
    for (int y = square.y[0]; y < square.end_y; ++y) {
      for (int x = square.x[0]; x < square.end_x; ++x) {
        for (int sample = 0; sample < cache_.samples; ++sample) {
          visit(x, y, sample);
        }
      }
    }
  }

  bool is_empty(const Square& square) const {
    bool is_empty = true;
    visit_rays(square, [&](int x, int y, int sample) {
      is_empty = is_empty && !is_seen(ray_of(x, y, sample));
    });
    return is_empty;
  }

  /// Whether all its rays run as interpolated between those of its nodes.
  bool is_even(const Square& square) const {
    std::array<Vector3d, kNodes> nodes;
    for (std::size_t i = 0; i < kNodes; ++i) {
      const std::size_t ray = ray_of(square.x[i % 3], square.y[i / 3], node_sample());
      if (!has_phase(ray)) {
        return false;
      }
      nodes[i] = direction(ray);
    }
    bool is_even = true;
    visit_rays(square, [&](int x, int y, int sample) {
      const std::size_t ray = ray_of(x, y, sample);
      if (!is_even || !has_phase(ray)) {
        is_even = false;
        return;
      }
      Vector3d off = direction(ray);
      const auto shares =
          shares_at(square, x + offset(sample % per_axis_), y + offset(sample / per_axis_));
      for (std::size_t i = 0; i < kNodes; ++i) {
        off -= shares[i] * nodes[i];
      }
      is_even = off.squaredNorm() < turn_ * turn_;
    });
    return is_even;
  }

  void interpolate(const Square& square, double x, double y, std::span<float> numbers) {
    const auto shares = shares_at(square, x, y);
    std::ranges::fill(numbers, 0.0F);
    for (std::size_t i = 0; i < kNodes; ++i) {
      if (shares[i] == 0.0) {
        continue;
      }
      const std::span<const float> kept = node(square.x[i % 3], square.y[i / 3]);
      const auto share = static_cast<float>(shares[i]);
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        numbers[k] += share * kept[k];
      }
    }
  }

  /// How far pictures may differ by these numbers.
  double distance(std::span<const float> a, std::span<const float> b) const {
    const auto off = [&](std::size_t i) { return static_cast<double>(std::abs(a[i] - b[i])); };
    double sum = off(0) + duty_ * off(1);
    for (std::size_t j = 0; j < weight_.size(); ++j) {
      sum += static_cast<double>(std::abs(weight_[j])) * std::hypot(off(2 + 2 * j), off(3 + 2 * j));
    }
    return sum;
  }

  /// Whether the light that is summed for a ray is the interpolated one.
  bool is_interpolated_at(const Square& square, int x, int y, int sample) {
    const std::size_t ray = ray_of(x, y, sample);
    if (!has_phase(ray)) {
      return false;
    }
    std::vector<float> expected(response_.size());
    interpolate(square, x + offset(sample % per_axis_), y + offset(sample / per_axis_), expected);
    if (sample == node_sample()) {
      return distance(expected, node(x, y)) <= kAllowed;
    }
    std::vector<float> summed(response_.size());
    sum_lobe(ray, summed);
    return distance(expected, summed) <= kAllowed;
  }

  /// Half-way between nodes, where errors along and across add and where they cancel. Pixels of a
  /// square of two are nodes themselves, but their outer rays are not.
  bool is_interpolated_well(const Square& square) {
    if (square.size == 2) {
      return per_axis_ == 1 || (is_interpolated_at(square, square.x[1], square.y[1], 0) &&
                                is_interpolated_at(square, square.x[2], square.y[1], 0));
    }
    const int y = (square.y[0] + square.y[1]) / 2;
    return is_interpolated_at(square, (square.x[0] + square.x[1]) / 2, y, node_sample()) &&
           is_interpolated_at(square, (square.x[1] + square.x[2]) / 2, y, node_sample());
  }

  void fill_square(int x, int y, int size) {
    if (x >= cache_.width_px || y >= cache_.height_px) {
      return;
    }
    const Square square = {.x = nodes_of(x, std::min(x + size, cache_.width_px - 1)),
                           .y = nodes_of(y, std::min(y + size, cache_.height_px - 1)),
                           .end_x = std::min(x + size, cache_.width_px),
                           .end_y = std::min(y + size, cache_.height_px),
                           .size = size};
    if (is_empty(square)) {
      return;
    }
    if (size == 1) {
      fill_pixel(x, y);
    } else if (is_even(square) && is_interpolated_well(square)) {
      visit_rays(square, [&](int at_x, int at_y, int sample) {
        interpolate(
            square, at_x + offset(sample % per_axis_), at_y + offset(sample / per_axis_), numbers_);
        add_ray(at_x, at_y, sample);
      });
    } else {
      for (int i = 0; i < 4; ++i) {
        fill_square(x + (i % 2) * size / 2, y + (i / 2) * size / 2, size / 2);
      }
    }
  }

  void fill_pixel(int x, int y) {
    const std::size_t middle = ray_of(x, y, node_sample());
    for (int sample = 0; sample < cache_.samples; ++sample) {
      const std::size_t ray = ray_of(x, y, sample);
      if (!is_seen(ray)) {
        continue;
      }
      const bool is_near = has_phase(middle) && has_phase(ray) &&
                           (direction(ray) - direction(middle)).squaredNorm() < turn_ * turn_;
      if (is_near) {
        std::ranges::copy(node(x, y), numbers_.begin());
      } else {
        sum_lobe(ray, numbers_);
      }
      add_ray(x, y, sample);
    }
  }

  /// The light of a ray with the numbers that were found for it.
  void add_ray(int x, int y, int sample) {
    const std::size_t ray = ray_of(x, y, sample);
    const std::size_t pixel = ray_of(x, y, 0);
    const float share = gain_[ray] / static_cast<float>(cache_.samples);
    if (share == 0.0F) {
      return;
    }
    pixels_.even.values()[pixel] += share * (numbers_[0] + static_cast<float>(duty_) * numbers_[1]);
    const double phase = has_phase(ray) ? static_cast<double>(phase_mm_[ray]) / period_mm_ : 0.0;
    const double angle = 2.0 * kPi * (phase - std::floor(phase));
    const std::complex<float> first(std::polar(1.0, angle));
    const std::complex<float> step(std::polar(1.0, response_.harmonics().step * angle));
    std::complex<float> wave = first;
    for (std::size_t j = 0; j < weight_.size(); ++j) {
      const std::complex<float> value(numbers_[2 + 2 * j], numbers_[3 + 2 * j]);
      const std::complex<float> turned = share * wave * value;
      pixels_.real[j].values()[pixel] += turned.real();
      pixels_.imaginary[j].values()[pixel] += turned.imag();
      wave *= step;
    }
  }

  const RayCache& cache_;
  const StripeResponse& response_;
  double period_mm_;
  double duty_;
  const std::vector<float>& phase_mm_;
  const std::vector<float>& gain_;
  Vector3d camera_mm_;
  double turn_;
  int per_axis_;
  std::vector<std::complex<float>> weight_;
  std::vector<float> numbers_;       ///< of the ray that is worked on
  std::vector<std::int32_t> nodes_;  ///< of each pixel: its place in kept_; -1: not summed yet
  std::vector<float> kept_;
  std::int64_t points_ = 0;
  BlurredPixels& pixels_;
};

}  // namespace

int num_bands(const RayCache& cache) {
  return (cache.height_px + kBand - 1) / kBand;
}

std::int64_t fill_band(const LobeTask& task, int band, BlurredPixels& pixels) {
  return LobePicture(task, pixels).fill(band);
}

}  // namespace glint
