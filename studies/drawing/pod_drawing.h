// SPDX-License-Identifier: GPL-3.0-or-later
//
// How surely defects are found by their size, as an SVG document; equal input gives equal bytes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/statistics/estimate.h"
#include "metrics/statistics/pod.h"

namespace glint {

/// Share found of the defects of one size.
struct PodLevel {
  double size = 0.0;
  Estimate share;
};

struct PodCurve {
  std::string title;
  std::vector<PodLevel> levels;
  std::optional<PodFit> fit;  ///< sizes as in the levels
};

struct PodChart {
  std::string title;
  std::string size_label;  ///< "depth (um)"
  std::string unit;        ///< "um"
  double confidence = 0.95;
  std::vector<PodCurve> curves;
};

/// Probability of detection against size: curves with their bands, shares with their bars, a90 and
/// a90/95 on the line of 90 %.
std::string pod_svg(const PodChart& chart);

}  // namespace glint
