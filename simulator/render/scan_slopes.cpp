// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan_slopes.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "simulator/render/cell_slopes.h"
#include "simulator/render/frame_slopes.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

/// Relative steps of the settings between the two tables of a difference.
constexpr double kTableStep = 1e-4;

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
    return ClippedMean(changed_sensor, changed_stripes);
  };
  std::vector<double> slope = table_at(1.0).nodes();
  const ClippedMean low = table_at(-1.0);
  for (std::size_t i = 0; i < slope.size(); ++i) {
    slope[i] = (slope[i] - low.nodes()[i]) / (2.0 * kTableStep);
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
        by_aspect_(by_aspect),
        slopes_(slopes),
        width_(by_aspect.width()) {
    for (auto* row : {&v_, &gx_, &gy_, &looked_up_, &weight_}) {
      row->resize(static_cast<std::size_t>(width_));
    }
  }

  /// Slopes by the hits, the period and the blur.
  void add_widths(const ClippedMean& table) {
    const std::vector<float> coefficients = width_slope(table);
    const double variance = sensor_.blur_variance_px2() + 1.0 / 12.0;
    double by_variance = 0.0;
    double by_period = 0.0;
    for (int y = 0; y < by_aspect_.height(); ++y) {
      if (!load_weights(y)) {
        continue;
      }
      footprints_.phases(y, {.v = v_.data(), .gx = gx_.data(), .gy = gy_.data()});
      look_up(y, coefficients);
      for (std::size_t x = 0; x < weight_.size(); ++x) {
        const float w = plan_.width.row(y)[x];
        const float by_width = weight_[x] * looked_up_[x];
        const float factor = w > 0.0F ? by_width * static_cast<float>(variance) / w : 0.0F;
        const float by_gx = factor * gx_[x];
        const float by_gy = factor * gy_[x];
        const float squared = by_gx * gx_[x] + by_gy * gy_[x];
        by_variance += static_cast<double>(squared);
        gx_[x] = by_gx;
        gy_[x] = by_gy;
      }
      scatter(y);
    }
    // w^2 = variance (gx^2 + gy^2): the sums are by_w w = sum of by_w variance |g|^2 / w.
    by_period = -by_variance / footprints_.positions().period_mm;
    slopes_.period_mm += by_period;
    by_variance /= 2.0 * variance;
    slopes_.blur_px += by_variance * variance_slope();
  }

  /// Sum of slopes times what a table of another quantity has.
  double weighted(const std::vector<float>& coefficients) {
    double sum = 0.0;
    for (int y = 0; y < by_aspect_.height(); ++y) {
      if (load_weights(y)) {
        look_up(y, coefficients);
        for (std::size_t x = 0; x < weight_.size(); ++x) {
          sum += static_cast<double>(weight_[x] * looked_up_[x]);
        }
      }
    }
    return sum;
  }

 private:
  bool load_weights(int y) {
    const unsigned char* by_table = plan_.by_table.row(y);
    const float* by_aspect = by_aspect_.row(y);
    bool has_any = false;
    for (std::size_t x = 0; x < weight_.size(); ++x) {
      weight_[x] = by_table[x] != 0 ? by_aspect[x] : 0.0F;
      has_any |= weight_[x] != 0.0F;
    }
    return has_any;
  }

  void look_up(int y, const std::vector<float>& coefficients) {
    kernels::look_up(plan_.width.row(y),
                     width_,
                     coefficients.data(),
                     ClippedMean::kIntervals,
                     static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest),
                     looked_up_.data());
  }

  /// Slopes by gx and gy to the corners.
  void scatter(int y) {
    const auto corner_width = static_cast<std::size_t>(width_) + 1;
    float* top = slopes_.corners.x.data() + static_cast<std::size_t>(y) * corner_width;
    float* bottom = top + corner_width;
    const auto half = static_cast<float>(0.5 / footprints_.positions().period_mm);
    for (std::size_t x = 0; x < gx_.size(); ++x) {
      top[x] -= half * (gx_[x] + gy_[x]);
      bottom[x] += half * (gy_[x] - gx_[x]);
    }
    for (std::size_t x = 0; x < gx_.size(); ++x) {
      top[x + 1] += half * (gx_[x] - gy_[x]);
      bottom[x + 1] += half * (gx_[x] + gy_[x]);
    }
  }

  double variance_slope() const {
    SensorSettings settings = sensor_.settings();
    const double step = 1e-3 * settings.blur_px;
    if (step == 0.0) {
      return 0.0;
    }
    const auto variance_at = [&](double blur_px) {
      settings.blur_px = blur_px;
      return Sensor(settings, 1, 1).blur_variance_px2();
    };
    const double blur_px = sensor_.settings().blur_px;
    return (variance_at(blur_px + step) - variance_at(blur_px - step)) / (2.0 * step);
  }

  const Footprints& footprints_;
  const Sensor& sensor_;
  const ScanPlan& plan_;
  const ImageF& by_aspect_;
  ScanSlopes& slopes_;
  int width_;
  std::vector<float> v_, gx_, gy_, looked_up_, weight_;
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
  table.add_widths(ClippedMean(settings, stripes));
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
  for (std::size_t g = 0; g < refined.size(); ++g) {
    if (!refined[g].empty()) {
      const RayCache& group = footprints.rays().refined[g].rays;
      const WallHits met = meet_light(group, footprints.tunnel());
      motion.collect(
          group.block(0, static_cast<int>(group.weight.size())),
          {.x_mm = met.x_mm.data(), .y_mm = met.y_mm.data(), .margin_mm = met.margin_mm.data()},
          refined[g].from(0));
    }
  }
}

ScanSlopes slopes_of_scan(const Footprints& footprints,
                          const Sensor& sensor,
                          const ScanPlan& plan,
                          double reflectance,
                          const ImageF& by_aspect,
                          const WantedSlopes& wanted) {
  if (plan.form.kind == ScanForm::Kind::kFrames) {
    throw ConfigError(
        "search.algorithm: there are no derivatives of a scan that does not take the stripes "
        "through whole periods, or under an uneven light");
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
  for (const SlopesByHits* hits : {&slopes.corners}) {
    for (const float x : hits->x) {
      by_x += static_cast<double>(x);
    }
  }
  for (const SlopesByHits& hits : slopes.refined) {
    for (const float x : hits.x) {
      by_x += static_cast<double>(x);
    }
  }
  slopes.offset_mm = -by_x;
  return slopes;
}

}  // namespace glint
