// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reverse mode through a scan's mean: from the derivatives by the mean image to those by hits,
// stripes and sensor. Pixels from the table T(w) use the chain rule through w^2 = variance |g|^2,
// with T'(w) from the table's own cubic pieces; the derivatives by gain, exposure, duty and dark
// radiance are differences of two neighbouring tables. Pixels from frames: frame_gradient.h.
// docs/theory/derivatives.md. Cost: one pass, however many keys there are. Memory: one float per
// corner ray, three in rows with a boundary of the light.
#include "simulator/render/derivative/scan_gradient.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "simulator/render/derivative/cell_gradient.h"
#include "simulator/render/derivative/frame_gradient.h"
#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/derivative/shining_gradient.h"
#include "simulator/render/derivative/table_kernels.h"
#include "simulator/sensor/blur_kernel.h"

namespace glint {
namespace {

/// Step of a setting between the two tables of a difference. Short: where the last part of a stripe
/// comes to clip, the table bends as a power of 3/2.
constexpr double kTableStep = 1e-6;

/// The difference of two tables as one.
std::vector<float> table_derivative(const SensorSettings& sensor,
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
  std::vector<double> derivative = table_at(1.0);
  const std::vector<double> low = table_at(-1.0);
  for (std::size_t i = 0; i < derivative.size(); ++i) {
    derivative[i] = (derivative[i] - low[i]) / (2.0 * kTableStep);
  }
  return ClippedMean::pieces_through(derivative);
}

/// Of a pixel's blur, its own box included [px^2].
double variance_of(const Sensor& sensor) {
  return sensor.blur_variance_px2() + 1.0 / 12.0;
}

/// Coefficients of the table's derivative by w.
std::vector<float> width_derivative(const ClippedMean& table) {
  std::vector<float> derivative = table.coefficients();
  const auto per_unit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest);
  for (std::size_t i = 0; i < derivative.size(); i += 4) {
    derivative[i] = per_unit * derivative[i + 1];
    derivative[i + 1] = per_unit * 2.0F * derivative[i + 2];
    derivative[i + 2] = per_unit * 3.0F * derivative[i + 3];
    derivative[i + 3] = 0.0F;
  }
  return derivative;
}

/// Derivatives by what moves the width of all stripes alike. The phase differences go with 1 /
/// period, and w with the root of the variance.
/// @param by_differences  sum of derivatives times both phase differences
void add_widths(const Footprints& footprints,
                const Sensor& sensor,
                double by_differences,
                ScanGradient& gradient) {
  const std::vector<double> derivatives = blur_kernel_derivative(sensor.settings().blur_px);
  double by_sigma = 0.0;
  for (std::size_t k = 1; k < derivatives.size(); ++k) {
    by_sigma += 2.0 * static_cast<double>(k * k) * derivatives[k];
  }
  gradient.period_mm -= by_differences * (1.0 / footprints.positions().period_mm);
  gradient.blur_px += by_differences / (2.0 * variance_of(sensor)) * by_sigma;
}

/// The pixels that T(w) gives.
class TableGradient {
 public:
  TableGradient(const Footprints& footprints,
                const Sensor& sensor,
                const ScanPlan& plan,
                const ImageF& by_aspect,
                ScanGradient& gradient)
      : footprints_(footprints),
        sensor_(sensor),
        plan_(plan),
        by_aspect_(by_aspect),
        gradient_(gradient) {}

  /// Also gets the sum of derivatives times what a table of another quantity has.
  void add_weighted(std::vector<float> coefficients, double& sum) {
    others_.push_back({.coefficients = std::move(coefficients), .sum = &sum});
  }

  /// Derivatives by the hits, the period and the blur, and the sums.
  void run(const ClippedMean& table) {
    const double per_period = 1.0 / footprints_.positions().period_mm;
    const auto scale = static_cast<float>(variance_of(sensor_) * per_period * per_period);
    add_widths(footprints_, sensor_, add_rows(width_derivative(table), scale), gradient_);
  }

 private:
  struct Other {
    std::vector<float> coefficients;
    double* sum;
  };

  /// @return sum of derivatives times gx and gy
  double add_rows(const std::vector<float>& by_w, float scale) {
    const int width = by_aspect_.width();
    const auto corner_width = static_cast<std::size_t>(width) + 1;
    std::vector<const float*> others;
    for (const Other& other : others_) {
      others.push_back(other.coefficients.data());
    }
    std::vector<double> sums(others.size());
    // A row's, between two zeros.
    std::vector<float> by_gx(static_cast<std::size_t>(width) + 2), by_gy(by_gx);
    std::vector<float> by_table_mean(static_cast<std::size_t>(width));
    double by_gradient = 0.0;
    for (int y = 0; y < by_aspect_.height(); ++y) {
      const unsigned char* by_table = plan_.by_table.row(y);
      if (std::memchr(by_table, 1, static_cast<std::size_t>(width)) == nullptr) {
        continue;
      }
      std::copy_n(by_aspect_.row(y), width, by_table_mean.data());
      footprint_kernels::multiply_runs(
          by_table, plan_.correction.row(y / kRippleTileHeight_px), width, by_table_mean.data());
      const std::size_t corner = static_cast<std::size_t>(y) * corner_width;
      const float* stripes_mm = footprints_.hits().stripes_mm().data() + corner;
      by_gradient += gradient_kernels::table_gradient(
          {.by_table = by_table,
           .derivative = by_table_mean.data(),
           .w = plan_.width.row(y),
           .corners = {.top = stripes_mm, .bottom = stripes_mm + corner_width},
           .count = width,
           .scale = scale},
          {.coefficients = by_w.data(),
           .count = ClippedMean::kIntervals,
           .per_unit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest)},
          others,
          sums.data(),
          by_gx.data() + 1,
          by_gy.data() + 1);
      float* top = gradient_.corners.x.data() + corner;
      gradient_kernels::add_gradients_to_corners(
          by_gx.data() + 1, by_gy.data() + 1, width, top, top + corner_width);
    }
    for (std::size_t i = 0; i < others_.size(); ++i) {
      *others_[i].sum += sums[i];
    }
    return by_gradient;
  }

  const Footprints& footprints_;
  const Sensor& sensor_;
  const ScanPlan& plan_;
  const ImageF& by_aspect_;
  ScanGradient& gradient_;
  std::vector<Other> others_;
};

void add_table(const Footprints& footprints,
               const Sensor& sensor,
               const ScanPlan& plan,
               double reflectance,
               const ImageF& by_aspect,
               const WantedDerivatives& wanted,
               ScanGradient& gradient) {
  const SensorSettings& settings = sensor.settings();
  const StripeSettings stripes = stripes_of(footprints.positions(), reflectance);
  TableGradient table(footprints, sensor, plan, by_aspect, gradient);
  const auto add = [&](bool is_wanted,
                       double SensorSettings::*of_sensor,
                       double StripeSettings::*of_stripes,
                       double& derivative) {
    if (is_wanted) {
      table.add_weighted(table_derivative(settings, stripes, of_sensor, of_stripes), derivative);
    }
  };
  add(wanted.gain, &SensorSettings::gain, nullptr, gradient.gain);
  add(wanted.exposure, &SensorSettings::exposure, nullptr, gradient.exposure);
  add(wanted.duty, nullptr, &StripeSettings::duty, gradient.duty);
  add(wanted.dark, nullptr, &StripeSettings::dark, gradient.dark);
  table.run(*plan.table);
}

/// The same under dark stripes whose light depends on the place.
void add_shining_table(const Footprints& footprints,
                       const Sensor& sensor,
                       const ScanPlan& plan,
                       const ImageF& by_aspect,
                       const WantedDerivatives& wanted,
                       ScanGradient& gradient) {
  StripeSettings stripes = stripes_of(footprints.positions(), plan.reflectance);
  std::vector<ShiningSum> sums;
  const auto add = [&](bool is_wanted,
                       double SensorSettings::*of_sensor,
                       double StripeSettings::*of_stripes,
                       double& derivative) {
    ShiningSum by = {.sum = &derivative};
    for (int k = 0; is_wanted && k < plan.shining->num_levels(); ++k) {
      stripes.dark = ShiningMean::dark_of(plan.shining->first_level() + k);
      by.pieces.push_back(table_derivative(sensor.settings(), stripes, of_sensor, of_stripes));
    }
    if (is_wanted) {
      sums.push_back(std::move(by));
    }
  };
  add(wanted.gain, &SensorSettings::gain, nullptr, gradient.gain);
  add(wanted.exposure, &SensorSettings::exposure, nullptr, gradient.exposure);
  add(wanted.duty, nullptr, &StripeSettings::duty, gradient.duty);
  const double by_differences =
      add_shining_gradient(footprints, plan, by_aspect, variance_of(sensor), sums, gradient);
  add_widths(footprints, sensor, by_differences, gradient);
}

/// The pixels that frames give and that have derivatives.
Spans weighted_pixels(const ScanPlan& plan, const ImageF& by_aspect) {
  const bool is_by_table = plan.form.kind == ScanForm::Kind::kTable;
  const Spans pixels =
      is_by_table ? spans_of(plan.by_frames) : whole_image(by_aspect.width(), by_aspect.height());
  Spans weighted;
  for (const RowSpan& span : pixels) {
    const float* by = by_aspect.row(span.y);
    const auto next_where = [&](int x, bool wanted) {
      while (x < span.end && (by[x] != 0.0F) != wanted) {
        ++x;
      }
      return x;
    };
    for (int begin = next_where(span.begin, true); begin < span.end;) {
      const int end = next_where(begin, false);
      weighted.push_back({.y = span.y, .begin = begin, .end = end});
      begin = next_where(end, true);
    }
  }
  return weighted;
}

}  // namespace

void GradientByHits::resize(std::size_t rows, std::size_t row) {
  GLINT_CHECK(row_ == 0 || row_ == row, "rows of one length");
  row_ = row;
  is_open_.resize(rows);
  x.resize(rows * row);
  y.resize(rows * row);
  margin.resize(rows * row);
}

void GradientByHits::open(std::size_t row) {
  if (is_open_[row] == 0) {
    is_open_[row] = 1;
    std::fill_n(y.data() + row * row_, row_, 0.0F);
    std::fill_n(margin.data() + row * row_, row_, 0.0F);
  }
}

void ScanGradient::collect(const Footprints& footprints, ShapeDerivative& motion) const {
  const RayCache& rays = footprints.rays().corners;
  const WallHits& hits = footprints.hits();
  corners.for_each_run([&](std::size_t first, int count, const HitGradient& gradient) {
    motion.collect(rays.block(static_cast<std::int64_t>(first), count),
                   {.x_mm = hits.x_mm.data() + first,
                    .y_mm = hits.y_mm.data() + first,
                    .margin_mm = hits.margin_mm.data() + first},
                   gradient);
  });
  for (const EdgeGradient& by : edges) {
    const OccludedEdge* edge = footprints.occluded_edge(by.pixel);
    GLINT_CHECK(edge != nullptr, "derivatives of these footprints");
    motion.collect(
        {.origin_x = edge->origin_x.data(),
         .origin_y = edge->origin_y.data(),
         .origin_z = edge->origin_z.data(),
         .direction_x = edge->direction_x.data(),
         .direction_y = edge->direction_y.data(),
         .direction_z = edge->direction_z.data(),
         .count = static_cast<int>(edge->x_mm.size())},
        {.x_mm = edge->x_mm.data(), .y_mm = edge->y_mm.data(), .margin_mm = edge->margin_mm.data()},
        {.x = by.x.data(), .y = by.y.data(), .margin = by.margin.data()});
  }
  WallHits met;
  for (std::size_t g = 0; g < refined.size(); ++g) {
    const RefinedGroup& group = footprints.rays().refined[g];
    const int count = (group.cells_per_axis + 1) * (group.cells_per_axis + 1);
    for (std::size_t i = 0; i < refined[g].pixels.size(); ++i) {
      const auto first = static_cast<std::int64_t>(refined[g].pixels[i]) * count;
      intersect_light(group.rays, footprints.tunnel(), first, count, met);
      motion.collect(
          group.rays.block(first, count),
          {.x_mm = met.x_mm.data(), .y_mm = met.y_mm.data(), .margin_mm = met.margin_mm.data()},
          refined[g].by_hits.from(i * static_cast<std::size_t>(count)));
    }
  }
}

namespace {

ScanGradient empty_gradient(const Footprints& footprints) {
  const CornerRays& rays = footprints.rays();
  ScanGradient gradient;
  gradient.dark_nodes.resize(static_cast<std::size_t>(footprints.tunnel().dark().num_nodes()));
  gradient.corners.resize(static_cast<std::size_t>(rays.height_px) + 1,
                          static_cast<std::size_t>(rays.width_px) + 1);
  gradient.refined.resize(rays.refined.size());
  return gradient;
}

}  // namespace

ScanGradient gradient_of_scan(const Footprints& footprints,
                              const Sensor& sensor,
                              const ScanPlan& plan,
                              double reflectance,
                              const ImageF& by_aspect,
                              const WantedDerivatives& wanted,
                              const std::shared_ptr<const PixelCells>& cells) {
  if (!footprints.positions().is_even) {
    throw ConfigError("search.algorithm",
                      "there are no derivatives under an uneven light (led_ripple, "
                      "end_falloff)");
  }
  ScanGradient gradient = empty_gradient(footprints);
  if (plan.shining) {
    add_shining_table(footprints, sensor, plan, by_aspect, wanted, gradient);
  } else if (plan.form.kind == ScanForm::Kind::kTable) {
    add_table(footprints, sensor, plan, reflectance, by_aspect, wanted, gradient);
  }
  add_frame_gradient(footprints,
                     sensor,
                     weighted_pixels(plan, by_aspect),
                     by_aspect,
                     wanted,
                     plan.form.kind == ScanForm::Kind::kMeanRadiance ? nullptr : cells,
                     gradient);
  return gradient;
}

}  // namespace glint
