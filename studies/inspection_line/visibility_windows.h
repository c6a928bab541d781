// SPDX-License-Identifier: GPL-3.0-or-later
//
// Matched filters about defects of a scan: windows of the response, compared with windows of
// flawless scans. Definitions: docs/theory/visibility_trials.md.
#pragma once

#include <span>
#include <vector>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "metrics/aspect_image/roi.h"

namespace glint {

/// A window has kSamples x kSamples samples; each is the mean of step x step pixels.
struct WindowShape {
  static constexpr int kSamples = 7;

  int step_px = 1;  ///< >= 1

  /// About two radii to each side of a defect of that area.
  static WindowShape of_area(double area_px);
};

/// The samples about a pixel, row by row; what lies outside the image counts as 0.
std::vector<double> window_at(const ImageF& image, int x, int y, WindowShape shape);

/// Windows of the flawless responses at random places that lie whole in the region; as many for
/// each response. Places are the same for the same region. Where it is too narrow for whole
/// windows, only their middles lie in it; none for an empty region.
std::vector<std::vector<double>> background_windows(std::span<const ImageF> flawless,
                                                    const Mask& region,
                                                    WindowShape shape);

/// The pixel in the middle of a defect.
struct MiddlePixel {
  int x = 0;
  int y = 0;
};

MiddlePixel middle_of(const DefectView& view);

/// What a scan shows about one defect.
struct DefectWindow {
  std::vector<double> with;     ///< response of the scan of the part
  std::vector<double> without;  ///< of a flawless one in the same place
  std::vector<double> mean;     ///< of many flawless ones
};

/// For each defect the squared d' of what it shows, less the mean of what `without` shows: the
/// noise of one scan alone has a squared d' of about the number of samples. May be below 0.
std::vector<double> squared_dprimes(std::span<const DefectWindow> defects,
                                    std::span<const std::vector<double>> background,
                                    ThreadPool& pool);

}  // namespace glint
