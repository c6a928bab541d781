// SPDX-License-Identifier: GPL-3.0-or-later
//
// Decides for each pixel how its mean over a scan is found: from the table T(w), from the mean
// radiance, or from rendered frames. The table holds where the phase is linear over the blur, where
// all pixels within the blur's reach are plain, and where the phases of few frames hardly move the
// mean; masks of the exceptions are grown by that reach, row by row. docs/theory/clipped_mean.md,
// "Which form is used". Cost: a few passes over bytes and one over phases. Memory: two masks and
// two float images.
#include "simulator/render/scan/scan_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/image/grown_mask.h"
#include "core/image/mask_kernels.h"
#include "simulator/render/scan/kept_tables.h"
#include "simulator/render/scan/ripple_tiles.h"
#include "simulator/render/scan/width_rows.h"
#include "simulator/sensor/blur_kernel.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 3> kFormNames = {"floors", "table", "frames"};

/// A pixel beyond this share of the blur, on one side and times the gain, does not count.
constexpr double kSmallestTail = 7e-3;

/// Behind a blur narrower than this, pixels are boxes rather than Gaussians.
constexpr double kNarrowestBlur_px = 0.45;

/// Noise may shift the mean by this much where it is cut off.
constexpr double kLargestBias = 1e-4;

int count_of(const Mask& mask) {
  return mask_kernels::count_ones(mask.values().data(), static_cast<int>(mask.size()));
}

/// Pixels that the table does not give: no plain ones, or their phase is bent.
struct OtherPixels {
  Mask other;
  Mask lit;  ///< in some frame
};

OtherPixels find_others(const Footprints& footprints, const Sensor& sensor, ImageF& width) {
  const int columns = width.width();
  const auto* state = reinterpret_cast<const unsigned char*>(footprints.state().values().data());
  Mask not_plain = Mask::uninitialized(columns, width.height());
  OtherPixels pixels = {.other = Mask::uninitialized(columns, width.height()),
                        .lit = Mask::uninitialized(columns, width.height())};
  mask_kernels::split_states(state,
                             static_cast<int>(not_plain.size()),
                             not_plain.values().data(),
                             pixels.lit.values().data());
  WidthRows widths(footprints, sensor);
  // Bends are looked for where the neighbours' phases mean something.
  RowGrower beside(columns, 1);
  std::vector<unsigned char> is_linear(static_cast<std::size_t>(columns));
  std::vector<unsigned char> is_beside(is_linear.size());
  for (int y = 0; y < width.height(); ++y) {
    widths.find(y, width.row(y), is_linear.data());
    beside.grow(not_plain, y, is_beside.data());
    std::copy_n(not_plain.row(y), columns, pixels.other.row(y));
    mask_kernels::add_bends(is_linear.data(), is_beside.data(), columns, pixels.other.row(y));
  }
  return pixels;
}

/// Marks the pixels whose blur reaches beyond the picture, where the border goes on unchanged.
void mark_border(int y, int height, int reach, std::vector<unsigned char>& near) {
  const auto width = static_cast<int>(near.size());
  const bool is_all = y < reach || y >= height - reach || width <= 2 * reach;
  const int depth = is_all ? width : reach;
  std::fill_n(near.begin(), depth, 1);
  std::fill_n(near.rbegin(), depth, 1);
}

/// The pixels that T(w) gives, and those that need frames beside the watched ones.
void sort_pixels(const Footprints& footprints,
                 const Sensor& sensor,
                 const Mask& region,
                 ScanPlan& plan) {
  const OtherPixels pixels = find_others(footprints, sensor, plan.width);
  const int columns = region.width();
  const int reach = reach_of(sensor, plan.reflectance);
  RowGrower grower(columns, reach);
  std::vector<unsigned char> near(static_cast<std::size_t>(columns));
  std::vector<unsigned char> rest(near.size());
  for (int y = 0; y < region.height(); ++y) {
    unsigned char* closed = plan.by_table.row(y);
    grower.grow(pixels.other, y, near.data());
    mark_border(y, region.height(), reach, near);
    mask_kernels::mark_closed(region.row(y), plan.by_frames.row(y), near.data(), columns, closed);
    mask_kernels::subtract(region.row(y), closed, columns, rest.data());
    if (mask_kernels::count_ones(rest.data(), columns) > 0) {
      grower.grow(pixels.lit, y, near.data());
      mask_kernels::mark_frames(region.row(y), closed, near.data(), columns, plan.by_frames.row(y));
    }
  }
}

Mask without(const Mask& mask, const Mask& taken) {
  Mask rest = Mask::uninitialized(mask.width(), mask.height());
  mask_kernels::subtract(mask.values().data(),
                         taken.values().data(),
                         static_cast<int>(mask.size()),
                         rest.values().data());
  return rest;
}

}  // namespace

StripeSettings stripes_of(const ScanPositions& positions, double reflectance) {
  return {.duty = positions.duty,
          .dark = positions.dark,
          .gain = reflectance,
          .frames = positions.frames(),
          .phases = positions.even_phases()};
}

std::string_view form_name(ScanForm::Kind kind) {
  return kFormNames[static_cast<std::size_t>(kind)];
}

ScanForm::Kind form_of(const ScanPositions& positions,
                       const SensorSettings& sensor,
                       double reflectance) {
  if (!positions.is_even || positions.even_phases() == 0) {
    return ScanForm::Kind::kFrames;
  }
  const double brightest = reflectance * std::max(1.0, positions.dark);
  const GreyResponse bright = grey_response(sensor, brightest);
  const GreyResponse dark = grey_response(sensor, reflectance * positions.darkest);
  const double slope = sensor.gain * sensor.exposure;
  const double offset = dark_grey(sensor);
  // Where even the dark stripes reach full scale every frame is saturated; the table knows that.
  const double darkest =
      reflectance * (positions.duty < 1.0 ? std::min(1.0, positions.darkest) : 1.0);
  const double step = sensor.bits > 0 ? 1.0 / ((1 << sensor.bits) - 1) : 0.0;
  const bool is_unclipped =
      slope * brightest + offset <= 1.0 && slope * darkest + offset < 1.0 - 0.5 * step &&
      std::abs(bright.mean - slope * brightest - offset) <= kLargestBias &&
      std::abs(dark.mean - slope * reflectance * positions.darkest - offset) <= kLargestBias;
  if (is_unclipped) {
    // A narrow blur is cut off at 0: not linear, and the table's ripple of few frames is too large.
    const bool is_cut_off = blur_overshoot(sensor.blur_px) > 0.0;
    return is_cut_off ? ScanForm::Kind::kFrames : ScanForm::Kind::kMeanRadiance;
  }
  return sensor.blur_px >= kNarrowestBlur_px ? ScanForm::Kind::kTable : ScanForm::Kind::kFrames;
}

int reach_of(const Sensor& sensor, double reflectance) {
  const SensorSettings& settings = sensor.settings();
  const double gain = std::max(1.0, settings.gain * settings.exposure * reflectance);
  return sensor.blur_reach_px(kSmallestTail / gain);
}

namespace {

/// Fills the dark radiance of pixels. @return the lowest and the highest of those by table
std::pair<double, double> find_dark(const Footprints& footprints, ScanPlan& plan) {
  const int columns = plan.width.width();
  const std::ptrdiff_t corner_width = columns + 1;
  plan.dark = ImageF::uninitialized(columns, plan.width.height());
  float lowest = 2.0F;
  float highest = -1.0F;
  for (int y = 0; y < plan.dark.height(); ++y) {
    const float* top = footprints.dark().data() + y * corner_width;
    float* dark = plan.dark.row(y);
    footprint_kernels::means_of_corners({.top = top, .bottom = top + corner_width}, columns, dark);
    const unsigned char* by_table = plan.by_table.row(y);
    for (int x = 0; x < columns; ++x) {
      lowest = by_table[x] != 0 ? std::min(lowest, dark[x]) : lowest;
      highest = by_table[x] != 0 ? std::max(highest, dark[x]) : highest;
    }
  }
  const double any = footprints.positions().darkest;
  return lowest <= highest ? std::pair<double, double>(lowest, highest) : std::pair(any, any);
}

}  // namespace

void find_tables(const Footprints& footprints, const Sensor& sensor, ScanPlan& plan) {
  const StripeSettings stripes = stripes_of(footprints.positions(), plan.reflectance);
  if (footprints.positions().is_dark_even) {
    plan.table = kept_mean_table(sensor.settings(), stripes);
    return;
  }
  const auto [lowest, highest] = find_dark(footprints, plan);
  plan.shining = std::make_shared<const ShiningMean>(sensor.settings(), stripes, lowest, highest);
}

ScanPlan plan_scan(const Footprints& footprints,
                   const Sensor& sensor,
                   const Region& region,
                   const Mask& watched,
                   double reflectance) {
  const Mask& mask = region.mask;
  GLINT_CHECK(watched.empty() || watched.size() == mask.size(), "watched pixels of this picture");
  ScanPlan plan;
  plan.reflectance = reflectance;
  plan.form.kind = form_of(footprints.positions(), sensor.settings(), reflectance);
  plan.by_frames = watched;
  if (plan.form.kind == ScanForm::Kind::kFrames) {
    plan.by_frames = mask;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      plan.by_frames.values()[i] |= watched.values()[i];
    }
  }
  if (plan.form.kind == ScanForm::Kind::kMeanRadiance) {
    plan.by_mean_radiance = watched.empty() ? region.spans : spans_of(without(mask, watched));
  }
  if (plan.form.kind == ScanForm::Kind::kTable) {
    plan.width = ImageF::uninitialized(mask.width(), mask.height());
    plan.by_table = Mask::uninitialized(mask.width(), mask.height());
    if (watched.empty()) {
      plan.by_frames = Mask(mask.width(), mask.height());
    }
    sort_pixels(footprints, sensor, mask, plan);
    find_tables(footprints, sensor, plan);
    sort_tiles(footprints, sensor, count_of(mask), plan);
  }
  plan.form.frame_pixels = count_of(plan.by_frames);
  plan.form.table_pixels = count_of(plan.by_table);
  return plan;
}

}  // namespace glint
