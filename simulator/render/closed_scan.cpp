// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/closed_scan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/render/grown_mask.h"
#include "simulator/render/mask_kernels.h"
#include "simulator/render/width_kernels.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

constexpr std::array<std::string_view, 3> kFormNames = {"floors", "table", "frames"};

/// Frames that are rendered together: footprints are read once for all of them.
constexpr int kFramesAtOnce = 8;

/// Gaps between rendered pixels that are not worth another start.
constexpr int kBridge_px = 8;

/// Second differences of the phase that the table bears (docs/theory/clipped_mean.md).
constexpr float kAbsoluteBend = 2e-3F;
constexpr float kRelativeBend = 0.25F;

/// A pixel beyond this share of the blur, on one side and times the gain, does not count.
constexpr double kSmallestTail = 7e-3;

/// A sampled blur narrower than this is no Gaussian any more.
constexpr double kNarrowestBlur_px = 0.7;

/// What the phase of few frames may move a pixel's mean by, as a share of it and for each phase:
/// its scatter is in the deviation, but the fewer the phases the less it is that of a normal
/// number.
constexpr double kLargestPhaseShare = 8e-4;

/// Variance of a box pixel [px^2].
constexpr double kBoxVariance = 1.0 / 12.0;

/// Noise may shift the mean by this much where it is cut off.
constexpr double kLargestBias = 1e-4;

int count_of(const Mask& mask) {
  return mask_kernels::count_ones(mask.values().data(), static_cast<int>(mask.size()));
}

/// How far from a pixel others count: beyond, less than kSmallestTail of the light, times the gain,
/// spreads to it from one side.
int reach_of(const Sensor& sensor, double reflectance) {
  const SensorSettings& settings = sensor.settings();
  const double gain = std::max(1.0, settings.gain * settings.exposure * reflectance);
  return sensor.blur_reach_px(kSmallestTail / gain);
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
  const GreyResponse dark = grey_response(sensor, reflectance * positions.dark);
  const double slope = sensor.gain * sensor.exposure;
  const double offset =
      sensor.full_well_e > 0.0 ? sensor.gain * sensor.dark_e / sensor.full_well_e : 0.0;
  // Where even the dark stripes reach full scale every frame is blind; the table knows that.
  const double darkest = reflectance * (positions.duty < 1.0 ? std::min(1.0, positions.dark) : 1.0);
  const double step = sensor.bits > 0 ? 1.0 / ((1 << sensor.bits) - 1) : 0.0;
  const bool is_linear =
      slope * brightest + offset <= 1.0 && slope * darkest + offset < 1.0 - 0.5 * step &&
      std::abs(bright.mean - slope * brightest - offset) <= kLargestBias &&
      std::abs(dark.mean - slope * reflectance * positions.dark - offset) <= kLargestBias;
  if (is_linear) {
    return ScanForm::Kind::kFloors;
  }
  return sensor.blur_px < kNarrowestBlur_px ? ScanForm::Kind::kFrames : ScanForm::Kind::kTable;
}

namespace {

/// Widths w of T(w), row by row with the neighbours' differences at hand.
class WidthRows {
 public:
  WidthRows(const Footprints& footprints, const Sensor& sensor)
      : footprints_(footprints),
        columns_(footprints.rays().width_px),
        last_(footprints.rays().height_px - 1),
        rule_{.variance_px2 = static_cast<float>(sensor.blur_variance_px2() + kBoxVariance),
              .absolute = kAbsoluteBend,
              .relative = kRelativeBend} {
    for (std::size_t slot = 0; slot < 3; ++slot) {
      gx_[slot].resize(static_cast<std::size_t>(columns_));
      gy_[slot].resize(static_cast<std::size_t>(columns_));
    }
  }

  /// Rows are asked for in order. @param is_linear  1 where the phase is
  void find(int y, float* width, unsigned char* is_linear) {
    if (y == 0) {
      load(0);
    }
    if (y < last_) {
      load(y + 1);
    }
    kernels::stripe_widths(around(gx_, y), around(gy_, y), columns_, rule_, width, is_linear);
  }

 private:
  using Ring = std::array<std::vector<float>, 3>;

  static std::size_t slot_of(int y) { return static_cast<std::size_t>(y % 3); }

  void load(int y) {
    const std::ptrdiff_t corner_width = columns_ + 1;
    const float* top = footprints_.hits().stripes_mm().data() + y * corner_width;
    kernels::phase_slopes({.top = top, .bottom = top + corner_width},
                          columns_,
                          static_cast<float>(1.0 / footprints_.positions().period_mm),
                          gx_[slot_of(y)].data(),
                          gy_[slot_of(y)].data());
  }

  kernels::ThreeRows around(const Ring& ring, int y) const {
    return {.above = ring[slot_of(std::max(0, y - 1))].data(),
            .here = ring[slot_of(y)].data(),
            .below = ring[slot_of(std::min(last_, y + 1))].data()};
  }

  const Footprints& footprints_;
  int columns_;
  int last_;
  kernels::LinearPhase rule_;
  Ring gx_;
  Ring gy_;
};

/// For each interval of the table 1 where the phase of few frames moves the mean by no more than a
/// share of it.
std::vector<unsigned char> even_widths(const ClippedMean& table, double largest_share) {
  std::vector<unsigned char> is_even;
  for (int i = 0; i < ClippedMean::kIntervals; ++i) {
    const double w = ClippedMean::kWidest * (i + 0.5) / ClippedMean::kIntervals;
    is_even.push_back(table.phase_deviation(w) <= largest_share * table.mean(w) ? 1 : 0);
  }
  return is_even;
}

}  // namespace

ScanPlan with_same_pixels(const ScanPlan& plan,
                          const Footprints& footprints,
                          const Sensor& sensor) {
  ScanPlan same = plan;
  if (plan.form.kind == ScanForm::Kind::kTable) {
    same.table = std::make_shared<const ClippedMean>(
        sensor.settings(), stripes_of(footprints.positions(), plan.reflectance));
    WidthRows widths(footprints, sensor);
    std::vector<unsigned char> unused(static_cast<std::size_t>(same.width.width()));
    for (int y = 0; y < same.width.height(); ++y) {
      widths.find(y, same.width.row(y), unused.data());
    }
  }
  return same;
}

namespace {

/// Clears the pixels of a row whose width lies in an interval of the table that is not even.
void keep_even_widths(const std::vector<unsigned char>& is_even,
                      const float* width,
                      int count,
                      unsigned char* mask) {
  constexpr auto kPerUnit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest);
  constexpr auto kLast = static_cast<float>(ClippedMean::kIntervals - 1);
  for (int i = 0; i < count; ++i) {
    const float place = std::min(width[i] * kPerUnit, kLast);
    const int is_kept = mask[i] & is_even[static_cast<std::size_t>(place)];
    mask[i] = static_cast<unsigned char>(is_kept);
  }
}

/// Pixels that the table does not give: no plain ones, or their phase is bent.
struct OtherPixels {
  Mask other;
  Mask lit;  ///< in some frame
};

OtherPixels find_others(const Footprints& footprints, const Sensor& sensor, ImageF& width) {
  const int columns = width.width();
  const auto* state = reinterpret_cast<const unsigned char*>(footprints.state().values().data());
  Mask not_plain = Mask::unset(columns, width.height());
  OtherPixels pixels = {.other = Mask::unset(columns, width.height()),
                        .lit = Mask::unset(columns, width.height())};
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

/// The pixels that T(w) gives, and those that need frames beside the watched ones.
void sort_pixels(const Footprints& footprints,
                 const Sensor& sensor,
                 const Mask& region,
                 ScanPlan& plan) {
  const OtherPixels pixels = find_others(footprints, sensor, plan.width);
  const int columns = region.width();
  const double largest_share = kLargestPhaseShare * footprints.positions().even_phases();
  const std::vector<unsigned char> is_even = even_widths(*plan.table, largest_share);
  const bool are_even = std::ranges::find(is_even, 0) == is_even.end();
  RowGrower grower(columns, reach_of(sensor, plan.reflectance));
  std::vector<unsigned char> near(static_cast<std::size_t>(columns));
  std::vector<unsigned char> rest(near.size());
  for (int y = 0; y < region.height(); ++y) {
    unsigned char* closed = plan.by_table.row(y);
    grower.grow(pixels.other, y, near.data());
    mask_kernels::mark_closed(region.row(y), plan.by_frames.row(y), near.data(), columns, closed);
    if (!are_even) {
      keep_even_widths(is_even, plan.width.row(y), columns, closed);
    }
    mask_kernels::subtract(region.row(y), closed, columns, rest.data());
    if (mask_kernels::count_ones(rest.data(), columns) > 0) {
      grower.grow(pixels.lit, y, near.data());
      mask_kernels::mark_frames(region.row(y), closed, near.data(), columns, plan.by_frames.row(y));
    }
  }
}

Mask without(const Mask& mask, const Mask& taken) {
  Mask rest = Mask::unset(mask.width(), mask.height());
  mask_kernels::subtract(mask.values().data(),
                         taken.values().data(),
                         static_cast<int>(mask.size()),
                         rest.values().data());
  return rest;
}

}  // namespace

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
  if (plan.form.kind == ScanForm::Kind::kFloors) {
    plan.by_floors = watched.empty() ? region.spans : spans_of(without(mask, watched));
  }
  if (plan.form.kind == ScanForm::Kind::kTable) {
    plan.width = ImageF::unset(mask.width(), mask.height());
    plan.by_table = Mask::unset(mask.width(), mask.height());
    plan.table = std::make_shared<const ClippedMean>(
        sensor.settings(), stripes_of(footprints.positions(), reflectance));
    if (watched.empty()) {
      plan.by_frames = Mask(mask.width(), mask.height());
    }
    sort_pixels(footprints, sensor, mask, plan);
  }
  plan.form.frame_pixels = count_of(plan.by_frames);
  plan.form.table_pixels = count_of(plan.by_table);
  return plan;
}

namespace {

/// Pictures that frames are made in.
struct FramePictures {
  std::vector<ImageF> radiance;
  ImageF grey;
  ScanSums sums;
};

double share_of(const Spans& spans, int width, int height) {
  double pixels = 0.0;
  for (const RowSpan& span : spans) {
    pixels += static_cast<double>(span.size());
  }
  return pixels / width / height;
}

void fit_size(ImageF& image, int width, int height) {
  if (image.width() != width || image.height() != height) {
    image = ImageF::unset(width, height);
  }
}

/// Renders and exposes frames where they are wanted; sums and counts only there. What the pictures
/// held before does not matter. @return the cells of these frames
std::shared_ptr<const PixelCells> sum_frames(const Footprints& footprints,
                                             const Sensor& sensor,
                                             const Spans& wanted,
                                             const Spans& rendered,
                                             const FrameConsumer& consume,
                                             FramePictures& pictures) {
  const int width = footprints.rays().width_px;
  const int height = footprints.rays().height_px;
  const FootprintFrames frames(footprints, rendered);
  const int total = footprints.positions().frames();
  // Fewer at once where few of their pixels are rendered: pictures are kept as a whole.
  const double share = share_of(rendered, width, height);
  const int at_once = std::clamp(static_cast<int>(2.0 + kFramesAtOnce * share), 1, kFramesAtOnce);
  pictures.radiance.resize(static_cast<std::size_t>(std::min(at_once, total)));
  for (ImageF& radiance : pictures.radiance) {
    fit_size(radiance, width, height);
  }
  fit_size(pictures.grey, consume ? width : 0, consume ? height : 0);
  pictures.sums.frames = 0;
  for (int first = 0; first < total; first += at_once) {
    pictures.radiance.resize(static_cast<std::size_t>(std::min(at_once, total - first)));
    frames.render(first, pictures.radiance);
    for (std::size_t k = 0; k < pictures.radiance.size(); ++k) {
      const int index = first + static_cast<int>(k);
      sensor.accumulate(
          pictures.radiance[k], index, wanted, pictures.sums, consume ? &pictures.grey : nullptr);
      if (consume) {
        consume(index, pictures.grey);
      }
    }
  }
  return frames.cells();
}

/// The pictures that a thread keeps from one candidate to the next: to clear new ones takes longer
/// than to render a small share of their pixels. nullptr for a large share: they would be many.
FramePictures* kept_pictures(const Spans& rendered, int width, int height) {
  constexpr double kSmallShare = 0.25;
  thread_local FramePictures pictures;
  return share_of(rendered, width, height) <= kSmallShare ? &pictures : nullptr;
}

/// The exposed mean radiance: for a linear sensor the mean of the exposed frames.
void expose_mean(const Footprints& footprints,
                 const Sensor& sensor,
                 const ScanPlan& plan,
                 ClosedScan& result) {
  const int width = result.aspect.width();
  const int height = result.aspect.height();
  const Spans& wanted = plan.by_floors;
  const Spans rendered = grown_spans(wanted, sensor.blur_radius_px(), kBridge_px, width, height);
  const Spans near = grown_spans(wanted, reach_of(sensor, plan.reflectance), 0, width, height);
  SensorSettings quiet = sensor.settings();
  const double offset =
      quiet.full_well_e > 0.0 ? quiet.gain * quiet.dark_e / quiet.full_well_e : 0.0;
  quiet.full_well_e = quiet.read_noise_e = quiet.dark_e = 0.0;
  quiet.bits = 0;
  const Sensor quiet_sensor(quiet, width, height);
  ImageF mean = ImageF::unset(width, height);
  // Rows are exposed as soon as all are there that their light comes from.
  auto next = wanted.begin();
  const auto expose_with = [&](int rows) {
    const int known = rows < height ? rows - sensor.blur_radius_px() : height;
    const auto first = next;
    while (next != wanted.end() && next->y < known) {
      ++next;
    }
    quiet_sensor.expose(mean, 0, Spans(first, next), result.aspect);
  };
  FootprintFrames(footprints, rendered).render_mean(near, mean, expose_with);
  if (sensor.settings().full_well_e == 0.0) {
    return;
  }
  const int frames = footprints.positions().frames();
  result.deviation = ImageF(width, height);
  const double linear = quiet.gain * quiet.exposure;
  for (const RowSpan& span : wanted) {
    float* row = result.aspect.row(span.y);
    for (int x = span.begin; x < span.end; ++x) {
      const double radiance = static_cast<double>(row[x]) / linear;
      result.deviation(x, span.y) = static_cast<float>(
          std::sqrt(grey_response(sensor.settings(), radiance).variance / frames));
      row[x] += static_cast<float>(offset);
    }
  }
}

/// A mean at full scale is one of frames that all are.
void count_full(const Spans& spans, ClosedScan& result) {
  constexpr float kFullScale = 1.0F - 1e-6F;
  for (const RowSpan& span : spans) {
    for (int x = span.begin; x < span.end; ++x) {
      result.clipped_frames(x, span.y) = result.aspect(x, span.y) >= kFullScale ? 0xFFFF : 0;
    }
  }
}

void look_up_means(const ScanPlan& plan, const ClippedMean& table, ClosedScan& result) {
  const int width = plan.width.width();
  const int height = plan.width.height();
  const kernels::PieceTables tables = {
      .coefficients = table.coefficients().data(),
      .nodes = table.deviations().data(),
      .pieces = ClippedMean::kIntervals,
      .per_unit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest)};
  const kernels::PieceValues dark = {.cubic = static_cast<float>(table.dark_level()),
                                     .straight = static_cast<float>(table.dark_deviation())};
  result.aspect = ImageF::unset(width, height);
  result.deviation = ImageF::unset(width, height);
  for (int y = 0; y < height; ++y) {
    const float* w = plan.width.row(y);
    const unsigned char* by_table = plan.by_table.row(y);
    kernels::look_up_where(
        by_table, w, width, tables, dark, result.aspect.row(y), result.deviation.row(y));
    if (table.blind_from() < ClippedMean::kWidest) {
      for (int x = 0; x < width; ++x) {
        const bool is_blind = by_table[x] != 0 && table.is_blind(static_cast<double>(w[x]));
        result.clipped_frames(x, y) = is_blind ? 0xFFFF : 0;
      }
    }
  }
}

}  // namespace

ClosedScan scan_closed(const Footprints& footprints,
                       const Sensor& sensor,
                       const ScanPlan& plan,
                       const FrameConsumer& consume) {
  const int width = footprints.rays().width_px;
  const int height = footprints.rays().height_px;
  ClosedScan result = {.form = plan.form};
  const Spans wanted = spans_of(plan.by_frames);
  if (plan.form.kind == ScanForm::Kind::kTable || !wanted.empty()) {
    result.clipped_frames = Image<std::uint16_t>(width, height);
  }
  if (plan.form.kind == ScanForm::Kind::kTable) {
    look_up_means(plan, *plan.table, result);
  } else if (plan.form.kind == ScanForm::Kind::kFloors) {
    result.aspect = zero_beside(plan.by_floors, width, height);
    expose_mean(footprints, sensor, plan, result);
    if (!result.clipped_frames.empty()) {
      count_full(plan.by_floors, result);
    }
  } else {
    result.aspect = ImageF(width, height);
  }
  if (wanted.empty()) {
    return result;
  }
  const Spans rendered = grown_spans(wanted, sensor.blur_radius_px(), kBridge_px, width, height);
  FramePictures own;
  FramePictures* const kept = kept_pictures(rendered, width, height);
  FramePictures& pictures = kept != nullptr ? *kept : own;
  result.cells = sum_frames(footprints, sensor, wanted, rendered, consume, pictures);
  const ScanSums& sums = pictures.sums;
  for (const RowSpan& span : wanted) {
    for (int x = span.begin; x < span.end; ++x) {
      result.aspect(x, span.y) = static_cast<float>(sums.sum(x, span.y) / sums.frames);
      result.clipped_frames(x, span.y) = sums.clipped_frames(x, span.y);
      if (!result.deviation.empty()) {
        result.deviation(x, span.y) = 0.0F;
      }
    }
  }
  return result;
}

ScanResult scan_integrated(const Footprints& footprints,
                           const Sensor& sensor,
                           const FrameConsumer& consume) {
  const Spans all = whole_image(footprints.rays().width_px, footprints.rays().height_px);
  ScanResult result;
  FramePictures pictures;
  sum_frames(footprints, sensor, all, all, consume, pictures);
  result.sums = std::move(pictures.sums);
  result.aspect = result.sums.aspect();
  result.hidden_share = footprints.hidden_share();
  return result;
}

}  // namespace glint
