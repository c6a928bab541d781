// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/inspector.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/inspection/aspect.h"
#include "metrics/inspection/blobs.h"
#include "metrics/inspection/calibration.h"
#include "metrics/inspection/filter_kernels.h"
#include "metrics/inspection/phase.h"
#include "metrics/inspection/response_noise.h"
#include "metrics/inspection/structure.h"

namespace glint {
namespace {

using Filter = InspectionSettings::Filter;
using Threshold = InspectionSettings::Threshold;

/// The mask without a rim; beyond the picture counts as outside.
Mask without_rim(const Mask& mask, int rim_px) {
  Mask outside(mask.width() + 2, mask.height() + 2, 1);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      outside(x + 1, y + 1) = mask(x, y) != 0 ? 0 : 1;
    }
  }
  const Mask grown = dilated(outside, rim_px);
  Mask inner(mask.width(), mask.height());
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      inner(x, y) = grown(x + 1, y + 1) != 0 ? 0 : 1;
    }
  }
  return inner;
}

Mask region_of(const InspectionSettings& settings, const Mask& mask) {
  const auto is_inside = [](unsigned char value) { return value != 0; };
  const auto on_part = std::ranges::count_if(mask.values(), is_inside);
  if (on_part == 0) {
    throw ConfigError("inspection", "the mask has no pixel, at least one must be on the part");
  }
  Mask region = without_rim(mask, settings.erosion_px);
  if (std::ranges::none_of(region.values(), is_inside)) {
    throw ConfigError("inspection.erosion_px",
                      fmt::format("no pixel is left of {} in the mask after a rim of {} "
                                  "px, at least one must be",
                                  on_part,
                                  settings.erosion_px));
  }
  return region;
}

template <class T>
void check_size(const Image<T>& image, const Mask& mask) {
  if (image.width() != mask.width() || image.height() != mask.height()) {
    throw ConfigError("images",
                      fmt::format("an image of {} x {} px does not fit the mask of {} x {} px",
                                  image.width(),
                                  image.height(),
                                  mask.width(),
                                  mask.height()));
  }
}

[[noreturn]] void throw_not_finite(const ImageF& aspect) {
  const auto& values = aspect.values();
  const auto bad =
      std::ranges::find_if(values, [](float v) { return !(std::abs(v) <= kLargestGrey); });
  const auto at = static_cast<int>(bad - values.begin());
  throw ConfigError(
      "images",
      fmt::format("pixel ({}, {}) of the mean image is NaN, infinite or beyond {:g}, must "
                  "be a share of full scale",
                  at % aspect.width(),
                  at / aspect.width(),
                  kLargestGrey));
}

void keep_all_inside(const ImageF& aspect, const Mask& mask, ThreadPool& pool, ImageF& kept) {
  const int bands = (aspect.height() + kRowsPerBand - 1) / kRowsPerBand;
  const auto is_finite = pool.map<int>(bands, [&](std::int64_t band) {
    const int first = static_cast<int>(band) * kRowsPerBand;
    int all_finite = 1;
    for (int y = first; y < std::min(first + kRowsPerBand, aspect.height()); ++y) {
      const bool is_row_finite = inspection_kernels::keep_inside(
          aspect.row(y), mask.row(y), aspect.width(), kLargestGrey, kept.row(y));
      all_finite &= is_row_finite ? 1 : 0;
    }
    return all_finite;
  });
  if (std::ranges::find(is_finite, 0) != is_finite.end()) {
    throw_not_finite(aspect);
  }
}

[[noreturn]] void throw_needs_frames() {
  throw ConfigError("inspection.filter",
                    "phase needs the images of the sequence, allowed for a mean image are "
                    "gaussian, difference_of_gaussians, matched and structure");
}

}  // namespace

std::string_view kind_name(DefectKind kind) {
  return kind == DefectKind::kHole ? "hole" : "scratch";
}

Inspector::Inspector(const InspectionSettings& settings, const Mask& mask)
    : settings_(settings),
      mask_(mask),
      region_(region_of(settings, mask)),
      region_spans_(spans_of(region_)),
      filter_(settings, mask_, region_),
      scratch_(std::make_shared<PicturePool>(mask.width(), mask.height())) {}

ImageF Inspector::response(const ImageF& aspect, ThreadPool& pool) const {
  if (settings_.filter == Filter::kPhase) {
    throw_needs_frames();
  }
  check_size(aspect, mask_);
  ImageF result(aspect.width(), aspect.height());
  ImageF masked = scratch_->take();
  keep_all_inside(aspect, mask_, pool, masked);
  if (settings_.filter == Filter::kStructure) {
    const ImageF whole = structure_of(masked, mask_, settings_.structure_px, pool);
    keep_all_inside(whole, region_, pool, result);
  } else {
    filter_.respond(masked, pool, result);
  }
  scratch_->give_back(std::move(masked));
  return result;
}

ImageF Inspector::response(std::span<const ImageF> frames, ThreadPool& pool) const {
  if (settings_.filter != Filter::kPhase) {
    return response(aspect_of(frames, pool), pool);
  }
  for (const ImageF& frame : frames) {
    check_size(frame, mask_);
  }
  const ImageF whole = phase_response(
      frames, settings_.periods, mask_, settings_.kernel_px, settings_.sigma_px, pool);
  ImageF result(whole.width(), whole.height());
  keep_all_inside(whole, region_, pool, result);
  return result;
}

double Inspector::noise(const ImageF& response, ThreadPool& pool) const {
  check_size(response, mask_);
  if (settings_.filter == Filter::kStructure) {
    return robust_size(response, region_spans_);
  }
  return robust_deviation(response, region_spans_, pool);
}

double Inspector::threshold_at(double noise, std::optional<double> calibrated) const {
  if (settings_.threshold == Threshold::kNoise) {
    return std::max(min_threshold(), settings_.threshold_sigmas * noise);
  }
  if (settings_.threshold == Threshold::kFixed) {
    return std::max(min_threshold(), settings_.threshold_grey);
  }
  if (!calibrated.has_value()) {
    throw ConfigError("inspection.threshold",
                      "false_alarms needs pictures of flawless parts to be calibrated "
                      "with, allowed without them are fixed and noise");
  }
  return std::max(min_threshold(), *calibrated);
}

double Inspector::threshold(const ImageF& response, std::optional<double> calibrated) const {
  check_size(response, mask_);
  if (settings_.threshold != Threshold::kNoise) {
    return threshold_at(0.0, calibrated);
  }
  // Not by a pool of its own: as long as that lived, it would limit all others of the program.
  return threshold_at(settings_.filter == Filter::kStructure
                          ? robust_size(response, region_spans_)
                          : robust_deviation(response, region_spans_),
                      calibrated);
}

double Inspector::capped_threshold(const ImageF& response,
                                   double threshold,
                                   ThreadPool& pool) const {
  const auto most = static_cast<std::size_t>(settings_.max_reports);
  if (most == 0 || blobs(response, threshold, pool).size() <= most) {
    return threshold;
  }
  return std::max(threshold, threshold_for(*this, {&response, 1}, static_cast<double>(most), pool));
}

std::vector<FoundDefect> Inspector::blobs(const ImageF& response,
                                          double threshold,
                                          ThreadPool& pool) const {
  check_size(response, mask_);
  return find_blobs(response, threshold, settings_, pool);
}

Inspection Inspector::list(const ImageF& response,
                           ThreadPool& pool,
                           std::optional<double> calibrated) const {
  Inspection result;
  if (settings_.threshold == Threshold::kNoise) {
    result.noise = noise(response, pool);
  }
  result.threshold = capped_threshold(response, threshold_at(result.noise, calibrated), pool);
  result.defects = blobs(response, result.threshold, pool);
  return result;
}

Inspection Inspector::inspect(const ImageF& aspect,
                              ThreadPool& pool,
                              std::optional<double> calibrated) const {
  return list(response(aspect, pool), pool, calibrated);
}

Inspection Inspector::inspect(std::span<const Image<std::uint8_t>> frames,
                              ThreadPool& pool,
                              std::optional<double> calibrated) const {
  if (settings_.filter == Filter::kStructure) {
    return inspect(aspect_of(frames, pool), pool, calibrated);
  }
  if (settings_.filter != Filter::kPhase) {
    ImageF aspect = scratch_->take();
    masked_aspect(frames, mask_, pool, aspect);
    ImageF response = scratch_->take();
    filter_.respond(aspect, pool, response);
    Inspection result = list(response, pool, calibrated);
    scratch_->give_back(std::move(aspect));
    scratch_->give_back(std::move(response));
    return result;
  }
  std::vector<ImageF> shares;
  for (const Image<std::uint8_t>& frame : frames) {
    shares.push_back(aspect_of(std::span(&frame, 1), pool));
  }
  return list(response(shares, pool), pool, calibrated);
}

Inspection Inspector::inspect(std::span<const ImageF> frames,
                              ThreadPool& pool,
                              std::optional<double> calibrated) const {
  return list(response(frames, pool), pool, calibrated);
}

}  // namespace glint
