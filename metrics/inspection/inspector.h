// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the pictures of a part to the list of its defects. Formulas and choices:
// docs/theory/inspection.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "core/thread_pool.h"
#include "metrics/inspection/inspection_settings.h"
#include "metrics/inspection/masked_filter.h"
#include "metrics/inspection/picture_pool.h"

namespace glint {

enum class DefectKind { kHole, kScratch };  ///< kHole: hole or bump

std::string_view kind_name(DefectKind kind);  ///< "hole", "scratch"

/// One blob of the response beyond the threshold: 8-connected pixels of one sign. Moments are those
/// of its pixels, each counted once, with a pixel's own extent (1/12 px2 a pixel along both axes).
struct FoundDefect {
  double x_px = 0.0;  ///< centre of mass; the centre of the first pixel is (0.5, 0.5)
  double y_px = 0.0;
  int area_px = 0;         ///< size of the seed
  double weight = 0.0;     ///< sum of |response|
  double peak = 0.0;       ///< largest |response|
  bool is_bright = true;   ///< brighter than its background where the response is largest
  double length_px = 0.0;  ///< axes of the ellipse with the same moments, 4 sqrt(l1), 4 sqrt(l2)
  double width_px = 0.0;
  double angle_rad = 0.0;   ///< of the long axis, in (-pi/2, pi/2]; +x to +y (down)
  double elongation = 0.0;  ///< in [0, 1]: 0 a disc, 1 a line
  DefectKind kind = DefectKind::kHole;
  int left_px = 0;  ///< box of its pixels
  int top_px = 0;
  int right_px = 0;   ///< one beyond
  int bottom_px = 0;  ///< one beyond
};

struct Inspection {
  double threshold = 0.0;  ///< that was used, of |response|
  /// Inspector::noise() of the response, which takes a third of an inspection: 0 unless it makes
  /// the threshold (threshold = "noise").
  double noise = 0.0;
  std::vector<FoundDefect> defects;  ///< by their first pixel, row by row
};

/// Larger greys are refused as no picture's: sums of their products could overflow.
inline constexpr float kLargestGrey = 1e20F;

/// Thresholds below this share of full scale would list the rounding of flat pictures.
inline constexpr double kMinThreshold = 1e-5;

/// Inspects pictures of one size and one mask; what depends on these alone is made once. Immutable;
/// may be shared between threads. Results are the same bytes for any number of threads.
class Inspector {
 public:
  /// @param mask  where the part is; the settings' rim is taken off. Filters see the mask's pixels
  ///              only: each result is divided by the kernel's share that lies in the mask
  /// @throws ConfigError when nothing is left of the mask
  Inspector(const InspectionSettings& settings, const Mask& mask);

  const InspectionSettings& settings() const { return settings_; }

  /// Where defects are looked for: the mask without its rim.
  const Mask& region() const { return region_; }

  /// The filtered aspect image, 0 outside the region, in shares of full scale; of filter structure
  /// structure_of().
  /// @throws ConfigError for another size than the mask's, NaN, or filter phase
  ImageF response(const ImageF& aspect, ThreadPool& pool) const;

  /// Response of a scan's frames, for all filters (phase needs the frames).
  ImageF response(std::span<const ImageF> frames, ThreadPool& pool) const;

  /// The threshold for a response: fixed or by its own noise, but at least min_threshold(). On
  /// the calling thread alone.
  /// @param calibrated  of threshold = "false_alarms", from threshold_for(); else ignored
  /// @throws ConfigError when it is missing
  double threshold(const ImageF& response, std::optional<double> calibrated = {}) const;

  /// The threshold, raised as far as `max_reports` asks for.
  double capped_threshold(const ImageF& response, double threshold, ThreadPool& pool) const;

  /// The lower bound of thresholds: kMinThreshold, more for filters that amplify rounding.
  double min_threshold() const { return kMinThreshold * filter_.amplification(); }

  /// The response's robust standard deviation over the region; of filter structure robust_size().
  double noise(const ImageF& response, ThreadPool& pool) const;

  /// Blobs of |response| >= threshold of the wanted polarity. @param threshold  > 0
  std::vector<FoundDefect> blobs(const ImageF& response, double threshold, ThreadPool& pool) const;

  /// All steps, frames to list.
  Inspection inspect(const ImageF& aspect,
                     ThreadPool& pool,
                     std::optional<double> calibrated = {}) const;
  Inspection inspect(std::span<const Image<std::uint8_t>> frames,
                     ThreadPool& pool,
                     std::optional<double> calibrated = {}) const;
  Inspection inspect(std::span<const ImageF> frames,
                     ThreadPool& pool,
                     std::optional<double> calibrated = {}) const;

 private:
  Inspection list(const ImageF& response, ThreadPool& pool, std::optional<double> calibrated) const;
  double threshold_at(double noise, std::optional<double> calibrated) const;

  InspectionSettings settings_;
  Mask mask_;
  Mask region_;
  Spans region_spans_;
  MaskedFilter filter_;
  std::shared_ptr<PicturePool> scratch_;
};

}  // namespace glint
