// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan_slopes.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "simulator/render/cell_slopes.h"
#include "simulator/render/frame_slopes.h"
#include "simulator/render/slope_kernels.h"

namespace glint {
namespace {

/// Step of a setting between the two tables of a difference. Short: where the last part of a stripe
/// comes to clip, the table bends as a power of 3/2.
constexpr double kTableStep = 1e-6;

/// The difference of two tables as one.
std::vector<float> table_slope(const SensorSettings& sensor,
                               const StripeSettings& stripes,
                               double SensorSettings::*of_sensor,
                               double StripeSettings::*of_stripes) {
  const auto table_at = [&](double sign) {
    SensorSettings changed_sensor = sensor;
    StripeSettings changed_stripes = stripes;
    double& number = of_sensor != nullptr ? changed_sensor.*of_sensor : changed_stripes.*of_stripes;
    number += sign * kTableStep;
    return ClippedMean::nodes_of(changed_sensor, changed_stripes);
  };
  std::vector<double> slope = table_at(1.0);
  const std::vector<double> low = table_at(-1.0);
  for (std::size_t i = 0; i < slope.size(); ++i) {
    slope[i] = (slope[i] - low[i]) / (2.0 * kTableStep);
  }
  return ClippedMean::pieces_through(slope);
}

/// Coefficients of the table's derivative by w.
std::vector<float> width_slope(const ClippedMean& table) {
  std::vector<float> slope = table.coefficients();
  const auto per_unit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest);
  for (std::size_t i = 0; i < slope.size(); i += 4) {
    slope[i] = per_unit * slope[i + 1];
    slope[i + 1] = per_unit * 2.0F * slope[i + 2];
    slope[i + 2] = per_unit * 3.0F * slope[i + 3];
    slope[i + 3] = 0.0F;
  }
  return slope;
}

/// The pixels that T(w) gives.
class TableSlopes {
 public:
  TableSlopes(const Footprints& footprints,
              const Sensor& sensor,
              const ScanPlan& plan,
              const ImageF& by_aspect,
              ScanSlopes& slopes)
      : footprints_(footprints),
        sensor_(sensor),
        plan_(plan),
        slopes_(slopes),
        weight_(by_aspect),
        width_(by_aspect.width()) {
    for (int y = 0; y < weight_.height(); ++y) {
      const unsigned char* by_table = plan.by_table.row(y);
      float* weight = weight_.row(y);
      bool has_any = false;
      for (int x = 0; x < width_; ++x) {
        weight[x] = by_table[x] != 0 ? weight[x] : 0.0F;
        has_any |= weight[x] != 0.0F;
      }
      if (has_any) {
        rows_.push_back(y);
      }
    }
  }

  /// Slopes by the hits, the period and the blur.
  void add_widths(const ClippedMean& table) {
    const std::vector<float> coefficients = width_slope(table);
    const double variance = sensor_.blur_variance_px2() + 1.0 / 12.0;
    const double per_period = 1.0 / footprints_.positions().period_mm;
    const auto corner_width = static_cast<std::size_t>(width_) + 1;
    std::vector<float> v(static_cast<std::size_t>(width_)), gx(v), gy(v), by_gx(v), by_gy(v);
    double by_gradient = 0.0;  // sum of slopes times gx and gy
    for (const int y : rows_) {
      footprints_.phases(y, {.v = v.data(), .gx = gx.data(), .gy = gy.data()});
      by_gradient += slope_kernels::width_slopes(plan_.width.row(y),
                                                 gx.data(),
                                                 gy.data(),
                                                 weight_.row(y),
                                                 width_,
                                                 pieces(coefficients),
                                                 static_cast<float>(variance),
                                                 by_gx.data(),
                                                 by_gy.data());
      float* top = slopes_.corners.x.data() + static_cast<std::size_t>(y) * corner_width;
      slope_kernels::add_to_corners(by_gx.data(),
                                    by_gy.data(),
                                    width_,
                                    static_cast<float>(0.5 * per_period),
                                    top,
                                    top + corner_width);
    }
    // gx and gy go with 1 / period, and w with the root of the variance.
    slopes_.period_mm -= by_gradient * per_period;
    slopes_.blur_px += by_gradient / (2.0 * variance) * variance_slope();
  }

  /// Sum of slopes times what a table of another quantity has.
  double weighted(const std::vector<float>& coefficients) const {
    double sum = 0.0;
    for (const int y : rows_) {
      sum += slope_kernels::weighted_look_up(
          plan_.width.row(y), weight_.row(y), width_, pieces(coefficients));
    }
    return sum;
  }

 private:
  static slope_kernels::Pieces pieces(const std::vector<float>& coefficients) {
    return {.coefficients = coefficients.data(),
            .count = ClippedMean::kIntervals,
            .per_unit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest)};
  }

  /// A weight w at the distance k changes by w (k^2 - variance) / sigma^3 with the blur's sigma.
  double variance_slope() const {
    const double sigma = sensor_.settings().blur_px;
    if (sigma == 0.0) {
      return 0.0;
    }
    const double variance = sensor_.blur_variance_px2();
    const std::vector<float>& weights = sensor_.blur_weights();
    double fourth = 0.0;  // mean of k^4
    for (std::size_t k = 1; k < weights.size(); ++k) {
      const auto square = static_cast<double>(k * k);
      fourth += 2.0 * square * square * static_cast<double>(weights[k]);
    }
    return (fourth - variance * variance) / (sigma * sigma * sigma);
  }

  const Footprints& footprints_;
  const Sensor& sensor_;
  const ScanPlan& plan_;
  ScanSlopes& slopes_;
  ImageF weight_;  ///< slope by the aspect image where it is from the table, else 0
  int width_;
  std::vector<int> rows_;  ///< with any weight
};

void add_table(const Footprints& footprints,
               const Sensor& sensor,
               const ScanPlan& plan,
               double reflectance,
               const ImageF& by_aspect,
               const WantedSlopes& wanted,
               ScanSlopes& slopes) {
  const SensorSettings& settings = sensor.settings();
  const StripeSettings stripes = stripes_of(footprints.positions(), reflectance);
  TableSlopes table(footprints, sensor, plan, by_aspect, slopes);
  table.add_widths(*plan.table);
  const auto add = [&](double SensorSettings::*of_sensor, double StripeSettings::*of_stripes) {
    return table.weighted(table_slope(settings, stripes, of_sensor, of_stripes));
  };
  slopes.gain += wanted.gain ? add(&SensorSettings::gain, nullptr) : 0.0;
  slopes.exposure += wanted.exposure ? add(&SensorSettings::exposure, nullptr) : 0.0;
  slopes.duty += wanted.duty ? add(nullptr, &StripeSettings::duty) : 0.0;
  slopes.dark += wanted.dark ? add(nullptr, &StripeSettings::dark) : 0.0;
}

}  // namespace

void SlopesByHits::resize(std::size_t rays) {
  for (auto* array : {&x, &y, &margin}) {
    array->resize(rays);
  }
}

void ScanSlopes::collect(const Footprints& footprints, WallMotion& motion) const {
  const RayCache& rays = footprints.rays().corners;
  const WallHits& hits = footprints.hits();
  motion.collect(
      rays.block(0, static_cast<int>(rays.weight.size())),
      {.x_mm = hits.x_mm.data(), .y_mm = hits.y_mm.data(), .margin_mm = hits.margin_mm.data()},
      corners.from(0));
  WallHits met;
  for (std::size_t g = 0; g < refined.size(); ++g) {
    const RefinedGroup& group = footprints.rays().refined[g];
    const int count = (group.cells_per_axis + 1) * (group.cells_per_axis + 1);
    for (std::size_t i = 0; i < refined[g].pixels.size(); ++i) {
      const auto first = static_cast<std::int64_t>(refined[g].pixels[i]) * count;
      meet_light(group.rays, footprints.tunnel(), first, count, met);
      motion.collect(
          group.rays.block(first, count),
          {.x_mm = met.x_mm.data(), .y_mm = met.y_mm.data(), .margin_mm = met.margin_mm.data()},
          refined[g].by_hits.from(i * static_cast<std::size_t>(count)));
    }
  }
}

ScanSlopes slopes_of_scan(const Footprints& footprints,
                          const Sensor& sensor,
                          const ScanPlan& plan,
                          double reflectance,
                          const ImageF& by_aspect,
                          const WantedSlopes& wanted) {
  if (!footprints.positions().is_even) {
    throw ConfigError(
        "search.algorithm: there are no derivatives under an uneven light (led_ripple, "
        "end_falloff)");
  }
  ScanSlopes slopes;
  slopes.corners.resize(footprints.rays().corners.weight.size());
  slopes.refined.resize(footprints.rays().refined.size());
  Mask by_frames = plan.by_frames;
  if (plan.form.kind == ScanForm::Kind::kTable) {
    add_table(footprints, sensor, plan, reflectance, by_aspect, wanted, slopes);
  } else {
    std::ranges::fill(by_frames.values(), static_cast<unsigned char>(1));
  }
  for (std::size_t i = 0; i < by_frames.size(); ++i) {
    by_frames.values()[i] = by_frames.values()[i] != 0 && by_aspect.values()[i] != 0.0F ? 1 : 0;
  }
  add_frame_slopes(footprints, sensor, by_frames, by_aspect, wanted.blur, slopes);
  double by_x = 0.0;
  const auto add_sum = [&](const std::vector<float>& x) {
    by_x += slope_kernels::exact_sum(x.data(), x.size());
  };
  add_sum(slopes.corners.x);
  for (const RefinedSlopes& group : slopes.refined) {
    add_sum(group.by_hits.x);
  }
  slopes.offset_mm = -by_x;
  return slopes;
}

}  // namespace glint
