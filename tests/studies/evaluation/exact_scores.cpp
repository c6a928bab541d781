// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/evaluation/exact_scores.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/studies/imaging/exact_stripes.h"

namespace glint {
namespace {

using Eigen::Vector3d;

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
        wall_(settings_),
        positions_(Tunnel(settings_), scene.scan),
        wants_mean_(wants_mean),
        frames_(wants_mean ? 1 : static_cast<std::size_t>(positions_.frames())),
        sum_(settings_.duty) {
    dark_ = Tunnel(settings_).dark_radiance();
    for (std::size_t i = 0; i < picture.corners.origin_mm.size(); ++i) {
      places_.push_back(meet(picture.corners, errors.corners, i));
    }
  }

  std::size_t frames() const { return frames_; }

  const ScanPositions& positions() const { return positions_; }

  /// The phase of a pixel's stripes from its corners.
  LinearFunction phase_at(int x, int y) const { return phase_of(corners_at(x, y)); }

  /// What single places see that stand for a quarter of a cell each, added to images.
  void add_held(const Mask& where, std::vector<std::vector<double>>& images) const {
    for (int y = 0; y < where.height(); ++y) {
      for (int x = 0; x < where.width(); ++x) {
        const std::size_t a = corner_of(x, y);
        const std::size_t b = corner_of(x, y + 1);
        if (where(x, y) != 0 && rays_.kind(x, y) == PixelKind::kSmooth &&
            lowest_of(corners_at(x, y)) < kLowest) {
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
          add_held_of_refined(rays_.refined[g], picture_.refined[g], errors_.refined[g], i, images);
        }
      }
    }
  }

  /// Radiance images, frame by frame; what add_held() adds is left out.
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
            !is_dark(corners_at(x, y))) {
          radiance.assign(frames_, 0.0);
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
  using Corners = std::array<ExactPlace, 4>;

  std::size_t index_of(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(rays_.width_px) +
           static_cast<std::size_t>(x);
  }

  std::size_t corner_of(int x, int y) const {
    return static_cast<std::size_t>(y) * (static_cast<std::size_t>(rays_.width_px) + 1) +
           static_cast<std::size_t>(x);
  }

  ExactPlace meet(const ExactRays& rays, const std::vector<Vector3d>& errors, std::size_t i) const {
    ExactPlace place = wall_.meet(rays.origin_mm[i], rays.direction[i]);
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

  double mean_weight(int x, int y) const {
    const std::size_t top = corner_of(x, y);
    const std::size_t bottom = corner_of(x, y + 1);
    double sum = 0.0;
    for (const std::size_t at : {top, top + 1, bottom, bottom + 1}) {
      sum += static_cast<double>(rays_.corners.weight[at]);
    }
    return 0.25 * sum;
  }

  LinearFunction phase_of(const Corners& c) const {
    const LinearFunction x = linear_through({c[0].x_mm, c[1].x_mm, c[2].x_mm, c[3].x_mm});
    const double period_mm = settings_.period_mm;
    return {.value = (x.value - settings_.offset_mm) / period_mm,
            .dx = x.dx / period_mm,
            .dy = x.dy / period_mm};
  }

  /// Margins below this are no places on the wall.
  static constexpr double kLowest = -1e20;

  static double lowest_of(const Corners& c) {
    return std::min({c[0].margin_mm, c[1].margin_mm, c[2].margin_mm, c[3].margin_mm});
  }

  /// Without a corner that meets light.
  bool is_dark(const Corners& corners) const {
    const double half_slot = positions_.half_slot_mm;
    return std::ranges::all_of(corners, [](const ExactPlace& p) { return p.margin_mm < 0.0; }) ||
           std::ranges::all_of(corners,
                               [&](const ExactPlace& p) { return std::abs(p.y_mm) < half_slot; });
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

  void add_held_of_refined(const RefinedGroup& group,
                           const ExactRays& rays,
                           const std::vector<Vector3d>& errors,
                           std::size_t pixel,
                           std::vector<std::vector<double>>& images) const {
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const std::size_t first = pixel * (n + 1) * (n + 1);
    const double share = 0.25 / static_cast<double>(n * n);
    for (std::size_t cell = 0; cell < n * n; ++cell) {
      const std::size_t a = first + cell / n * (n + 1) + cell % n;
      const std::size_t b = a + n + 1;
      std::array<ExactPlace, 4> met;
      const std::array<std::size_t, 4> at = {a, a + 1, b, b + 1};
      for (std::size_t i = 0; i < 4; ++i) {
        met[i] = meet(rays, errors, at[i]);
      }
      if (group.is_smooth[pixel * n * n + cell] != 0 && lowest_of(met) >= kLowest) {
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
    if (lowest < kLowest) {
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
                   const std::vector<Vector3d>& errors,
                   std::size_t pixel,
                   std::vector<double>& radiance) {
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const std::size_t first = pixel * (n + 1) * (n + 1);
    met_.clear();
    for (std::size_t i = 0; i < (n + 1) * (n + 1); ++i) {
      met_.push_back(meet(rays, errors, first + i));
    }
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
  ExactWall wall_;
  ScanPositions positions_;
  bool wants_mean_;
  std::size_t frames_;
  double dark_ = 0.0;
  std::vector<ExactPlace> places_;  ///< of the corners
  std::vector<ExactPlace> met_;     ///< of a refined pixel
  ExactStripes sum_;
  std::vector<double> shares_;
};

/// Centre and one side of the sensor's blur, in double.
std::vector<double> blur_weights(double sigma_px, int radius) {
  std::vector<double> weights;
  double total = 0.0;
  for (int k = 0; k <= radius; ++k) {
    const double distance = k / sigma_px;
    weights.push_back(std::exp(-0.5 * distance * distance));
    total += (k == 0 ? 1.0 : 2.0) * weights.back();
  }
  for (double& weight : weights) {
    weight /= total;
  }
  return weights;
}

double variance_of(const std::vector<double>& weights) {
  double variance = 0.0;
  for (std::size_t k = 1; k < weights.size(); ++k) {
    variance += 2.0 * static_cast<double>(k * k) * weights[k];
  }
  return variance;
}

/// Blurred at the wanted pixels; beyond the border the nearest pixel counts.
void blur(const std::vector<double>& image,
          const Mask& wanted,
          const std::vector<double>& weights,
          std::vector<double>& across,
          std::vector<double>& blurred) {
  const int width = wanted.width();
  const int height = wanted.height();
  const int radius = static_cast<int>(weights.size()) - 1;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = weights[0] * image[at(x, y)];
      for (int k = 1; k <= radius; ++k) {
        sum += weights[static_cast<std::size_t>(k)] *
               (image[at(std::max(0, x - k), y)] + image[at(std::min(width - 1, x + k), y)]);
      }
      across[at(x, y)] = sum;
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (wanted(x, y) == 0) {
        continue;
      }
      double sum = weights[0] * across[at(x, y)];
      for (int k = 1; k <= radius; ++k) {
        sum += weights[static_cast<std::size_t>(k)] *
               (across[at(x, std::max(0, y - k))] + across[at(x, std::min(height - 1, y + k))]);
      }
      blurred[at(x, y)] = sum;
    }
  }
}

/// Cubic pieces through the nodes of T(w), as ClippedMean has them but in double.
class ExactTable {
 public:
  explicit ExactTable(std::vector<double> nodes) : f_(std::move(nodes)) {}

  double at(double w) const {
    const double place = std::min(w / ClippedMean::kWidest, 1.0) * ClippedMean::kIntervals;
    const auto i =
        std::min<std::size_t>(ClippedMean::kIntervals - 1, static_cast<std::size_t>(place));
    const double s = place - static_cast<double>(i);
    const double rise = f_[i + 1] - f_[i];
    const double a = slope(i);
    const double b = slope(i + 1);
    return f_[i] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)));
  }

 private:
  double slope(std::size_t i) const {
    if (i == 0) {
      return 2.0 * f_[1] - 1.5 * f_[0] - 0.5 * f_[2];
    }
    return i + 1 < f_.size() ? 0.5 * (f_[i + 1] - f_[i - 1]) : 0.0;
  }

  std::vector<double> f_;
};

std::vector<Vector3d> errors_of(const ExactWall& wall,
                                const ExactRays& rays,
                                const WallHits& hits) {
  std::vector<Vector3d> errors;
  for (std::size_t i = 0; i < rays.origin_mm.size(); ++i) {
    const ExactPlace exact = wall.meet(rays.origin_mm[i], rays.direction[i]);
    const auto margin = static_cast<double>(hits.margin_mm[i]);
    const bool is_nowhere = exact.margin_mm < -1e20 || margin < -1e20;
    errors.push_back(is_nowhere ? Vector3d::Zero()
                                : Vector3d(static_cast<double>(hits.x_mm[i]) - exact.x_mm,
                                           static_cast<double>(hits.y_mm[i]) - exact.y_mm,
                                           margin - exact.margin_mm));
  }
  return errors;
}

}  // namespace

ExactScores::ExactScores(const SceneSettings& scene,
                         const TracedScene& traced,
                         const Footprints& footprints,
                         const ScanPlan& plan,
                         double sigma_floor)
    : traced_(traced),
      plan_(plan),
      sigma_floor_(sigma_floor),
      wanted_(plan.by_frames.empty() ? Mask(traced.corners.width_px, traced.corners.height_px)
                                     : plan.by_frames) {
  for (const RowSpan& span : plan.by_floors) {
    std::fill_n(wanted_.row(span.y) + span.begin, span.size(), static_cast<unsigned char>(1));
  }
  const Sensor sensor(scene.sensor, wanted_.width(), wanted_.height());
  rendered_ = dilated(wanted_, sensor.blur_radius_px());
  const ExactPicture picture = picture_of(traced.corners);
  const ExactWall wall(scene.tunnel);
  errors_.corners = errors_of(wall, picture.corners, footprints.hits());
  for (std::size_t g = 0; g < picture.refined.size(); ++g) {
    errors_.refined.push_back(errors_of(
        wall, picture.refined[g], meet_light(traced.corners.refined[g].rays, footprints.tunnel())));
  }
  const ExactFrames frames(
      traced.corners, scene, picture, errors_, plan.form.kind == ScanForm::Kind::kFloors);
  held_.assign(frames.frames(), std::vector<double>(wanted_.size(), 0.0));
  frames.add_held(rendered_, held_);
  for_each_grey(scene, picture, [&](const ExactFrames&, const std::vector<double>& grey) {
    std::vector<char>& is_full = is_full_.emplace_back();
    for (const double value : grey) {
      is_full.push_back(value > 1.0 ? 1 : 0);
    }
  });
}

/// Calls use(frames, grey) with the grey values of each frame before they are clipped.
template <class Use>
void ExactScores::for_each_grey(const SceneSettings& scene,
                                const ExactPicture& picture,
                                const Use& use) const {
  const bool is_linear = plan_.form.kind == ScanForm::Kind::kFloors;
  ExactFrames frames(traced_.corners, scene, picture, errors_, is_linear);
  const Sensor sensor(scene.sensor, wanted_.width(), wanted_.height());
  const std::vector<double> weights = blur_weights(scene.sensor.blur_px, sensor.blur_radius_px());
  std::vector<double> across(wanted_.size(), 0.0), blurred(across);
  const double gain = scene.sensor.gain * scene.sensor.exposure;
  std::vector<std::vector<double>> images = frames.render(rendered_);
  for (std::size_t k = 0; k < images.size(); ++k) {
    std::ranges::transform(images[k], held_[k], images[k].begin(), std::plus<>());
    blur(images[k], wanted_, weights, across, blurred);
    for (double& grey : blurred) {
      grey *= gain;
    }
    use(frames, blurred);
  }
}

std::vector<double> ExactScores::aspect_of(const SceneSettings& scene,
                                           const ExactPicture& picture) const {
  std::vector<double> aspect(wanted_.size(), 0.0);
  const Sensor sensor(scene.sensor, wanted_.width(), wanted_.height());
  bool is_first = true;
  std::size_t frame = 0;
  for_each_grey(scene, picture, [&](const ExactFrames& frames, const std::vector<double>& grey) {
    const auto share = 1.0 / static_cast<double>(frames.frames());
    const std::vector<char>& is_full = is_full_[frame];
    ++frame;
    for (std::size_t i = 0; i < aspect.size(); ++i) {
      aspect[i] += wanted_.values()[i] != 0 ? share * (is_full[i] != 0 ? 1.0 : grey[i]) : 0.0;
    }
    if (is_first && plan_.form.kind == ScanForm::Kind::kTable) {
      StripeSettings stripes = stripes_of(frames.positions(), scene.render.reflectance);
      stripes.dark = Tunnel(scene.tunnel).dark_radiance();  // the positions have it in float
      const ExactTable table(ClippedMean::nodes_of(scene.sensor, stripes));
      const double variance =
          variance_of(blur_weights(scene.sensor.blur_px, sensor.blur_radius_px())) + 1.0 / 12.0;
      for (std::size_t i = 0; i < aspect.size(); ++i) {
        if (plan_.by_table.values()[i] != 0 && wanted_.values()[i] == 0) {
          const auto at = static_cast<int>(i);
          const LinearFunction phase = frames.phase_at(at % wanted_.width(), at / wanted_.width());
          aspect[i] = table.at(std::sqrt(variance) * std::hypot(phase.dx, phase.dy));
        }
      }
    }
    is_first = false;
  });
  return aspect;
}

double ExactScores::clearance(const SceneSettings& scene, const ExactPicture& picture) const {
  double least = 1.0;
  for_each_grey(scene, picture, [&](const ExactFrames&, const std::vector<double>& grey) {
    for (std::size_t i = 0; i < grey.size(); ++i) {
      least = wanted_.values()[i] != 0 ? std::min(least, std::abs(grey[i] - 1.0)) : least;
    }
  });
  return least;
}

ExactValues ExactScores::at(const SceneSettings& scene, const ExactPicture& picture) const {
  return scores_of(aspect_of(scene, picture));
}

ExactValues ExactScores::scores_of(const std::vector<double>& aspect) const {
  double count = 0.0, sum = 0.0, squares = 0.0;
  const auto& region = traced_.region.mask.values();
  for (std::size_t i = 0; i < aspect.size(); ++i) {
    count += region[i] != 0 ? 1.0 : 0.0;
    sum += region[i] != 0 ? aspect[i] : 0.0;
  }
  const double mean = sum / count;
  for (std::size_t i = 0; i < aspect.size(); ++i) {
    squares += region[i] != 0 ? (aspect[i] - mean) * (aspect[i] - mean) : 0.0;
  }
  double min_cnr = std::numeric_limits<double>::infinity();
  for (const DefectPixels& defect : traced_.defects) {
    const auto mean_of = [&](const std::vector<std::size_t>& pixels) {
      double total = 0.0;
      for (const std::size_t pixel : pixels) {
        total += aspect[pixel];
      }
      return total / static_cast<double>(pixels.size());
    };
    const double background = mean_of(defect.ring);
    double variance = 0.0;
    for (const std::size_t pixel : defect.ring) {
      variance += (aspect[pixel] - background) * (aspect[pixel] - background);
    }
    const double sigma = std::sqrt(variance / static_cast<double>(defect.ring.size()));
    min_cnr = std::min(
        min_cnr, std::abs(mean_of(defect.inside) - background) / std::max(sigma, sigma_floor_));
  }
  return {1.0 - std::sqrt(squares / count) / mean, mean, min_cnr};
}

}  // namespace glint
