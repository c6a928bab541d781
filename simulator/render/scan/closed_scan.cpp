// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean of a scan with as few frames as possible, as planned in scan_plan.h: a table look-up per
// pixel where the sensor clips, one exposure of the mean radiance where it does not, and rendered
// frames for the pixels that neither gives. Frames are rendered eight at a time, so that footprints
// are read once for all of them; rows of the mean radiance are exposed as soon as all rows within
// the blur's reach are there. docs/theory/clipped_mean.md. Cost: one evaluation per pixel, plus the
// frames of the pixels left over. Memory: three images; while few pixels need frames, the frames'
// images stay with the thread for the next candidate.
#include "simulator/render/scan/closed_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulator/render/footprint/footprint_frames.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

/// Frames that are rendered together: footprints are read once for all of them.
constexpr int kTileFrames = 8;

/// Gaps between rendered pixels that are not worth another start.
constexpr int kGapTolerance_px = 8;

/// Pictures are worth keeping for frames that are rendered in this share of their pixels at most.
constexpr double kSmallShare = 0.25;

/// Of so few pixels the frames that others follow from are kept, however small the picture.
constexpr double kFewPixels = 16384.0;

double count_of(const Spans& spans) {
  double pixels = 0.0;
  for (const RowSpan& span : spans) {
    pixels += static_cast<double>(span.size());
  }
  return pixels;
}

double share_of(const Spans& spans, int width, int height) {
  return count_of(spans) / width / height;
}

void fit_size(ImageF& image, int width, int height) {
  if (image.width() != width || image.height() != height) {
    image = ImageF::uninitialized(width, height);
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
  FootprintFrames frames(footprints, rendered);
  const int total = footprints.positions().frames();
  // Fewer at once where few of their pixels are rendered: pictures are kept as a whole.
  const double share = share_of(rendered, width, height);
  const int at_once = std::clamp(static_cast<int>(2.0 + kTileFrames * share), 1, kTileFrames);
  if (share <= kSmallShare || count_of(rendered) <= kFewPixels) {
    frames.keep_sources();
  }
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

/// The exposed mean radiance: for a linear sensor the mean of the exposed frames.
void expose_mean(const Footprints& footprints,
                 const Sensor& sensor,
                 const ScanPlan& plan,
                 ClosedScan& result) {
  const int width = result.aspect.width();
  const int height = result.aspect.height();
  const Spans& wanted = plan.by_mean_radiance;
  const Spans rendered =
      grown_spans(wanted, sensor.blur_radius_px(), kGapTolerance_px, width, height);
  const Spans near = grown_spans(wanted, reach_of(sensor, plan.reflectance), 0, width, height);
  SensorSettings quiet = sensor.settings();
  const double offset = dark_grey(quiet);
  quiet = without_noise(quiet);
  quiet.bits = 0;
  const Sensor quiet_sensor(quiet, width, height);
  ImageF mean = ImageF::uninitialized(width, height);
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

/// By one T(w) for all pixels.
void look_up_row(const ClippedMean& table, const ScanPlan& plan, int y, ClosedScan& result) {
  const int width = plan.width.width();
  const float* w = plan.width.row(y);
  const unsigned char* by_table = plan.by_table.row(y);
  const kernels::PieceValues dark = {.cubic = static_cast<float>(table.dark_level()),
                                     .straight = static_cast<float>(table.dark_deviation())};
  kernels::look_up_where(by_table,
                         w,
                         width,
                         table.piece_tables(),
                         dark,
                         result.aspect.row(y),
                         result.deviation.row(y));
  if (table.saturated_from() < ClippedMean::kWidest) {
    for (int x = 0; x < width; ++x) {
      const bool is_saturated = by_table[x] != 0 && table.is_saturated(static_cast<double>(w[x]));
      result.clipped_frames(x, y) = is_saturated ? 0xFFFF : 0;
    }
  }
}

void look_up_shining_row(const ShiningMean& table,
                         const ScanPlan& plan,
                         int y,
                         ClosedScan& result) {
  const int width = plan.width.width();
  const float* w = plan.width.row(y);
  const float* dark = plan.dark.row(y);
  const unsigned char* by_table = plan.by_table.row(y);
  table.look_up(by_table, w, dark, width, result.aspect.row(y), result.deviation.row(y));
  for (int x = 0; x < width; ++x) {
    const bool is_saturated = by_table[x] != 0 && table.is_saturated(static_cast<double>(w[x]),
                                                                     static_cast<double>(dark[x]));
    result.clipped_frames(x, y) = is_saturated ? 0xFFFF : 0;
  }
}

void look_up_means(const ScanPlan& plan, bool has_noise, ClosedScan& result) {
  const int width = plan.width.width();
  const int height = plan.width.height();
  result.aspect = ImageF::uninitialized(width, height);
  result.deviation = ImageF::uninitialized(width, height);
  for (int y = 0; y < height; ++y) {
    if (plan.shining) {
      look_up_shining_row(*plan.shining, plan, y, result);
    } else {
      look_up_row(*plan.table, plan, y, result);
    }
    const unsigned char* by_table = plan.by_table.row(y);
    const int tiles = y / kRippleTileHeight_px;
    kernels::multiply_runs(by_table, plan.correction.row(tiles), width, result.aspect.row(y));
    kernels::add_in_squares(
        by_table, plan.ripple.row(tiles), width, has_noise, result.deviation.row(y));
  }
}

}  // namespace

ClosedScan scan_closed(const Footprints& footprints,
                       const Sensor& sensor,
                       const ScanPlan& plan,
                       const FrameConsumer& consume,
                       FramePicturePool* pool) {
  const int width = footprints.rays().width_px;
  const int height = footprints.rays().height_px;
  ClosedScan result = {.form = plan.form};
  const Spans wanted = spans_of(plan.by_frames);
  if (plan.form.kind == ScanForm::Kind::kTable || !wanted.empty()) {
    result.clipped_frames = Image<std::uint16_t>(width, height);
  }
  if (plan.form.kind == ScanForm::Kind::kTable) {
    look_up_means(plan, sensor.settings().full_well_e > 0.0, result);
  } else if (plan.form.kind == ScanForm::Kind::kMeanRadiance) {
    result.aspect = zero_beside(plan.by_mean_radiance, width, height);
    expose_mean(footprints, sensor, plan, result);
    if (!result.clipped_frames.empty()) {
      count_full(plan.by_mean_radiance, result);
    }
  } else {
    result.aspect = ImageF(width, height);
  }
  if (wanted.empty()) {
    return result;
  }
  const Spans rendered =
      grown_spans(wanted, sensor.blur_radius_px(), kGapTolerance_px, width, height);
  // Of a large share they would be many, and clearing them is little beside the rendering.
  const bool is_pooled = pool != nullptr && share_of(rendered, width, height) <= kSmallShare;
  auto pictures = is_pooled ? pool->take() : std::make_unique<FramePictures>();
  result.cells = sum_frames(footprints, sensor, wanted, rendered, consume, *pictures);
  const ScanSums& sums = pictures->sums;
  for (const RowSpan& span : wanted) {
    for (int x = span.begin; x < span.end; ++x) {
      result.aspect(x, span.y) = static_cast<float>(sums.sum(x, span.y) / sums.frames);
      result.clipped_frames(x, span.y) = sums.clipped_frames(x, span.y);
      if (!result.deviation.empty()) {
        result.deviation(x, span.y) = 0.0F;
      }
    }
  }
  if (is_pooled) {
    pool->give_back(std::move(pictures));
  }
  return result;
}

void watch_integrated(const Footprints& footprints,
                      const Sensor& sensor,
                      const Spans& where,
                      const FrameConsumer& consume) {
  const CornerRays& rays = footprints.rays();
  const Spans rendered =
      grown_spans(where, sensor.blur_radius_px(), kGapTolerance_px, rays.width_px, rays.height_px);
  FramePictures pictures;
  sum_frames(footprints, sensor, where, rendered, consume, pictures);
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
