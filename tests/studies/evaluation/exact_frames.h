// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "simulator/render/scan/closed_scan.h"
#include "tests/studies/evaluation/exact_places.h"
#include "tests/studies/imaging/exact_stripes.h"

namespace glint {

/// Frames of some pixels, in double.
class ExactFrames {
 public:
  ExactFrames(const CornerRays& rays,
              const SceneSettings& scene,
              const ExactPicture& picture,
              const HitErrors& errors,
              bool wants_mean)
      : rays_(rays),
        picture_(picture),
        errors_(errors),
        settings_(scene.tunnel),
        wall_dark_(Tunnel(settings_).dark()),
        wall_(settings_),
        positions_(Tunnel(settings_), scene.scan),
        wants_mean_(wants_mean),
        frames_(wants_mean ? 1 : static_cast<std::size_t>(positions_.frames())),
        sum_(settings_.duty) {
    for (std::size_t i = 0; i < picture.corners.origin_mm.size(); ++i) {
      places_.push_back(intersect(picture.corners, errors.corners, i));
    }
  }

  std::size_t frames() const { return frames_; }

  const ScanPositions& positions() const { return positions_; }

  /// The phase of a pixel's stripes from its corners.
  LinearFunction phase_at(int x, int y) const { return phase_of(corners_at(x, y)); }

  double dark_at(int x, int y) const {
    return exact_mean_dark(wall_dark_, corners_at(x, y), weights_at(x, y));
  }

  /// What single places see that stand for a quarter of a cell each, added to images.
  void add_detached(const Mask& where, std::vector<std::vector<double>>& images) const {
    for (int y = 0; y < where.height(); ++y) {
      for (int x = 0; x < where.width(); ++x) {
        const std::size_t a = corner_of(x, y);
        const std::size_t b = corner_of(x, y + 1);
        if (where(x, y) != 0 && rays_.kind(x, y) == PixelKind::kSmooth &&
            lowest_of(corners_at(x, y)) < kLowestMargin_mm) {
          turn_to(corners_at(x, y), weights_at(x, y));
          for (const std::size_t at : {a, a + 1, b, b + 1}) {
            const auto weight = static_cast<double>(rays_.corners.weight[at]);
            add_place(places_[at], 0.25 * weight, index_of(x, y), images);
          }
        }
      }
    }
    for (std::size_t g = 0; g < rays_.refined.size(); ++g) {
      for (std::size_t i = 0; i < rays_.refined[g].pixels.size(); ++i) {
        if (where.values()[static_cast<std::size_t>(rays_.refined[g].pixels[i])] != 0) {
          add_detached_of_refined(
              rays_.refined[g], picture_.refined[g], errors_.refined[g], i, images);
        }
      }
    }
  }

  /// Radiance images, frame by frame; what add_detached() adds is left out.
  std::vector<std::vector<double>> render(const Mask& where) {
    const std::size_t size = where.size();
    std::vector<std::vector<double>> images(frames_, std::vector<double>(size, 0.0));
    std::vector<double> radiance;
    const auto store = [&](std::size_t pixel) {
      for (std::size_t k = 0; k < frames_; ++k) {
        images[k][pixel] = radiance[k];
      }
    };
    for (int y = 0; y < where.height(); ++y) {
      for (int x = 0; x < where.width(); ++x) {
        if (where(x, y) != 0 && rays_.kind(x, y) == PixelKind::kSmooth &&
            !is_dark(corners_at(x, y), positions_.half_slot_mm)) {
          radiance.assign(frames_, 0.0);
          turn_to(corners_at(x, y), weights_at(x, y));
          add_cell(corners_at(x, y), mean_weight(x, y), radiance);
          store(index_of(x, y));
        }
      }
    }
    for (std::size_t g = 0; g < rays_.refined.size(); ++g) {
      const RefinedGroup& group = rays_.refined[g];
      for (std::size_t i = 0; i < group.pixels.size(); ++i) {
        const auto pixel = static_cast<std::size_t>(group.pixels[i]);
        if (where.values()[pixel] != 0) {
          radiance.assign(frames_, 0.0);
          add_refined(group, picture_.refined[g], errors_.refined[g], i, radiance);
          store(pixel);
        }
      }
    }
    return images;
  }

 private:
  std::size_t index_of(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(rays_.width_px) +
           static_cast<std::size_t>(x);
  }

  std::size_t corner_of(int x, int y) const {
    return static_cast<std::size_t>(y) * (static_cast<std::size_t>(rays_.width_px) + 1) +
           static_cast<std::size_t>(x);
  }

  ExactPlace intersect(const ExactRays& rays,
                       const std::vector<Eigen::Vector3d>& errors,
                       std::size_t i) const {
    ExactPlace place = wall_.intersect(rays.origin_mm[i], rays.direction[i]);
    place.x_mm += errors[i].x();
    place.y_mm += errors[i].y();
    place.margin_mm += errors[i].z();
    return place;
  }

  Corners corners_at(int x, int y) const {
    const std::size_t top = corner_of(x, y);
    const std::size_t bottom = corner_of(x, y + 1);
    return {places_[top], places_[top + 1], places_[bottom], places_[bottom + 1]};
  }

  std::array<float, 4> weights_at(int x, int y) const {
    const float* top = rays_.corners.weight.data() + corner_of(x, y);
    const float* bottom = rays_.corners.weight.data() + corner_of(x, y + 1);
    return {top[0], top[1], bottom[0], bottom[1]};
  }

  double mean_weight(int x, int y) const {
    double sum = 0.0;
    for (const float weight : weights_at(x, y)) {
      sum += static_cast<double>(weight);
    }
    return 0.25 * sum;
  }

  /// The pixel that is rendered next.
  void turn_to(std::span<const ExactPlace> places, std::span<const float> weights) const {
    dark_ = exact_mean_dark(wall_dark_, places, weights);
  }

  LinearFunction phase_of(const Corners& c) const {
    const LinearFunction x = linear_through({c[0].x_mm, c[1].x_mm, c[2].x_mm, c[3].x_mm});
    const double period_mm = settings_.period_mm;
    return {.value = (x.value - settings_.offset_mm) / period_mm,
            .dx = x.dx / period_mm,
            .dy = x.dy / period_mm};
  }

  void add_place(const ExactPlace& place,
                 double gain,
                 std::size_t pixel,
                 std::vector<std::vector<double>>& images) const {
    if (place.margin_mm < 0.0 || std::abs(place.y_mm) < positions_.half_slot_mm) {
      return;
    }
    const double phase = (place.x_mm - settings_.offset_mm) / settings_.period_mm;
    const double frames = static_cast<double>(positions_.frames());
    for (std::size_t k = 0; k < positions_.shift_periods.size(); ++k) {
      const double moved = phase - positions_.shift_periods[k];
      const bool is_bright = moved - std::floor(moved) < settings_.duty;
      const double radiance = gain * (is_bright ? 1.0 : dark_);
      images[wants_mean_ ? 0 : k][pixel] += wants_mean_ ? radiance / frames : radiance;
    }
  }

  void add_detached_of_refined(const RefinedGroup& group,
                               const ExactRays& rays,
                               const std::vector<Eigen::Vector3d>& errors,
                               std::size_t pixel,
                               std::vector<std::vector<double>>& images) const {
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const std::size_t first = pixel * (n + 1) * (n + 1);
    const double share = 0.25 / static_cast<double>(n * n);
    std::vector<ExactPlace> all;
    for (std::size_t i = 0; i < (n + 1) * (n + 1); ++i) {
      all.push_back(intersect(rays, errors, first + i));
    }
    turn_to(all, std::span(group.rays.weight).subspan(first));
    for (std::size_t cell = 0; cell < n * n; ++cell) {
      const std::size_t a = first + cell / n * (n + 1) + cell % n;
      const std::size_t b = a + n + 1;
      std::array<ExactPlace, 4> met;
      const std::array<std::size_t, 4> at = {a, a + 1, b, b + 1};
      for (std::size_t i = 0; i < 4; ++i) {
        met[i] = intersect(rays, errors, at[i]);
      }
      if (group.is_smooth[pixel * n * n + cell] != 0 && lowest_of(met) >= kLowestMargin_mm) {
        continue;
      }
      for (std::size_t i = 0; i < 4; ++i) {
        const auto weight = static_cast<double>(group.rays.weight[at[i]]);
        add_place(met[i], share * weight, static_cast<std::size_t>(group.pixels[pixel]), images);
      }
    }
  }

  /// @param gain  of the light, times the cell's share of the pixel
  void add_cell(const Corners& c, double gain, std::vector<double>& radiance) {
    const double lowest = lowest_of(c);
    if (lowest < kLowestMargin_mm) {
      return;
    }
    const LinearFunction phase = phase_of(c);
    PixelPolygon wall;
    if (lowest < 0.0) {
      wall.clip(linear_through({c[0].margin_mm, c[1].margin_mm, c[2].margin_mm, c[3].margin_mm}),
                0);
    }
    sum_.clear();
    const double half_slot = positions_.half_slot_mm;
    const auto [low, high] = std::minmax({c[0].y_mm, c[1].y_mm, c[2].y_mm, c[3].y_mm});
    if (low >= half_slot || high <= -half_slot) {
      sum_.add(wall, phase);
    } else {
      const LinearFunction y = linear_through({c[0].y_mm, c[1].y_mm, c[2].y_mm, c[3].y_mm});
      PixelPolygon left = wall;
      left.clip({.value = -half_slot - y.value, .dx = -y.dx, .dy = -y.dy}, 3);
      sum_.add(left, phase);
      wall.clip({.value = y.value - half_slot, .dx = y.dx, .dy = y.dy}, 4);
      sum_.add(wall, phase);
    }
    shares_.clear();
    for (const double shift : positions_.shift_periods) {
      shares_.push_back(sum_.share(shift));
    }
    const double bright = 1.0 - dark_;
    if (wants_mean_) {
      double mean = 0.0;
      for (const double share : shares_) {
        mean += share;
      }
      mean /= static_cast<double>(shares_.size());
      radiance[0] += gain * (dark_ * sum_.area() + bright * mean);
      return;
    }
    for (std::size_t k = 0; k < radiance.size(); ++k) {
      radiance[k] += gain * (dark_ * sum_.area() + bright * shares_[k]);
    }
  }

  void add_refined(const RefinedGroup& group,
                   const ExactRays& rays,
                   const std::vector<Eigen::Vector3d>& errors,
                   std::size_t pixel,
                   std::vector<double>& radiance) {
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const std::size_t first = pixel * (n + 1) * (n + 1);
    met_.clear();
    for (std::size_t i = 0; i < (n + 1) * (n + 1); ++i) {
      met_.push_back(intersect(rays, errors, first + i));
    }
    turn_to(met_, std::span(group.rays.weight).subspan(first));
    const double share = 1.0 / static_cast<double>(n * n);
    for (std::size_t cell = 0; cell < n * n; ++cell) {
      if (group.is_smooth[pixel * n * n + cell] == 0) {
        continue;  // held
      }
      const std::size_t a = cell / n * (n + 1) + cell % n;
      const std::size_t b = a + n + 1;
      double weight = 0.0;
      for (const std::size_t at : {a, a + 1, b, b + 1}) {
        weight += 0.25 * static_cast<double>(group.rays.weight[first + at]);
      }
      add_cell({met_[a], met_[a + 1], met_[b], met_[b + 1]}, share * weight, radiance);
    }
  }

  const CornerRays& rays_;
  const ExactPicture& picture_;
  const HitErrors& errors_;
  const TunnelSettings& settings_;
  DarkRadiance wall_dark_;
  ExactWall wall_;
  ScanPositions positions_;
  bool wants_mean_;
  std::size_t frames_;
  mutable double dark_ = 0.0;       ///< of the pixel in work
  std::vector<ExactPlace> places_;  ///< of the corners
  std::vector<ExactPlace> met_;     ///< of a refined pixel
  ExactStripes sum_;
  std::vector<double> shares_;
};

}  // namespace glint
