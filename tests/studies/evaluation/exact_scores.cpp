// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/evaluation/exact_scores.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "simulator/sensor/blur_kernel.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Centre and one side of the sensor's blur, in double. Its reach is that of another, near sigma.
std::vector<double> blur_weights(double sigma_px, int radius) {
  std::vector<double> weights = blur_kernel(sigma_px);
  weights.resize(static_cast<std::size_t>(radius) + 1, 0.0);
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
    const double a = derivative(i);
    const double b = derivative(i + 1);
    return f_[i] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)));
  }

 private:
  double derivative(std::size_t i) const {
    if (i == 0) {
      return 2.0 * f_[1] - 1.5 * f_[0] - 0.5 * f_[2];
    }
    return i + 1 < f_.size() ? 0.5 * (f_[i + 1] - f_[i - 1]) : 0.0;
  }

  std::vector<double> f_;
};

/// T(w) under the dark stripes of a scene, or T(w, D) as ShiningMean has it where their light
/// depends on the place.
class ExactMeans {
 public:
  ExactMeans(const SceneSettings& scene, const ScanPositions& positions)
      : sensor_(scene.sensor),
        stripes_(stripes_of(positions, scene.render.reflectance)),
        is_even_(positions.is_dark_even) {
    stripes_.dark = Tunnel(scene.tunnel).dark().mean();  // the positions have it in float
  }

  double at(double w, double dark) {
    if (is_even_) {
      return table_of(0, stripes_.dark).at(w);
    }
    const DarkStencil stencil = ShiningMean::stencil_of(dark);
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int level = stencil.first + k;
      sum += stencil.weight[static_cast<std::size_t>(k)] *
             table_of(level, ShiningMean::dark_of(level)).at(w);
    }
    return sum;
  }

 private:
  const ExactTable& table_of(int level, double dark) {
    auto found = tables_.find(level);
    if (found == tables_.end()) {
      StripeSettings stripes = stripes_;
      stripes.dark = dark;
      found = tables_.emplace(level, ExactTable(ClippedMean::nodes_of(sensor_, stripes))).first;
    }
    return found->second;
  }

  SensorSettings sensor_;
  StripeSettings stripes_;
  bool is_even_;
  std::map<int, ExactTable> tables_;
};

std::vector<Vector3d> errors_of(const ExactWall& wall,
                                const ExactRays& rays,
                                const WallHits& hits) {
  std::vector<Vector3d> errors;
  for (std::size_t i = 0; i < rays.origin_mm.size(); ++i) {
    const ExactPlace exact = wall.intersect(rays.origin_mm[i], rays.direction[i]);
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
  for (const RowSpan& span : plan.by_mean_radiance) {
    std::fill_n(wanted_.row(span.y) + span.begin, span.size(), static_cast<unsigned char>(1));
  }
  const Sensor sensor(scene.sensor, wanted_.width(), wanted_.height());
  rendered_ = dilated(wanted_, sensor.blur_radius_px());
  const ExactPicture picture = picture_of(traced.corners);
  const ExactWall wall(scene.tunnel);
  errors_.corners = errors_of(wall, picture.corners, footprints.hits());
  for (std::size_t g = 0; g < picture.refined.size(); ++g) {
    errors_.refined.push_back(
        errors_of(wall,
                  picture.refined[g],
                  intersect_light(traced.corners.refined[g].rays, footprints.tunnel())));
  }
  const ExactFrames frames(
      traced.corners, scene, picture, errors_, plan.form.kind == ScanForm::Kind::kMeanRadiance);
  held_.assign(frames.frames(), std::vector<double>(wanted_.size(), 0.0));
  frames.add_detached(rendered_, held_);
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
  const bool is_linear = plan_.form.kind == ScanForm::Kind::kMeanRadiance;
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
      ExactMeans means(scene, frames.positions());
      const double variance =
          variance_of(blur_weights(scene.sensor.blur_px, sensor.blur_radius_px())) + 1.0 / 12.0;
      for (std::size_t i = 0; i < aspect.size(); ++i) {
        if (plan_.by_table.values()[i] != 0 && wanted_.values()[i] == 0) {
          const int x = static_cast<int>(i) % wanted_.width();
          const int y = static_cast<int>(i) / wanted_.width();
          const LinearFunction phase = frames.phase_at(x, y);
          const float correction =
              plan_.correction(x / kRippleTileWidth_px, y / kRippleTileHeight_px);
          aspect[i] =
              static_cast<double>(correction) *
              means.at(std::sqrt(variance) * std::hypot(phase.dx, phase.dy), frames.dark_at(x, y));
        }
      }
    }
    is_first = false;
  });
  return aspect;
}

double ExactScores::clearance(const SceneSettings& scene, const ExactPicture& picture) const {
  double minimum = 1.0;
  for_each_grey(scene, picture, [&](const ExactFrames&, const std::vector<double>& grey) {
    for (std::size_t i = 0; i < grey.size(); ++i) {
      minimum = wanted_.values()[i] != 0 ? std::min(minimum, std::abs(grey[i] - 1.0)) : minimum;
    }
  });
  return minimum;
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
