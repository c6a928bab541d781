// SPDX-License-Identifier: GPL-3.0-or-later
//
// Charts of populations as SVG documents; equal input gives equal bytes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "metrics/inspection/grading.h"
#include "metrics/statistics/estimate.h"
#include "metrics/statistics/pod.h"

namespace glint {

/// A part in a scatter of its two figures for one kind of defects.
struct SizesPoint {
  DefectSizes sizes;
  Grade expert = Grade::kPerfect;
  bool is_test = true;    ///< else limits were learned from it
  bool is_wrong = false;  ///< sorted into another class than the expert's
};

/// Sum of all defects against the biggest, as figures 24 and 25 of the first seed have them.
struct SizesChart {
  std::string title;
  std::string unit;  ///< "px", "weight"
  std::vector<SizesPoint> points;
  GradeLimits limits;
};

std::string sizes_svg(const SizesChart& chart);

/// A figure of one design with its interval; up to two of a kind.
struct DesignRow {
  std::string title;
  Estimate share;  ///< in [0, 1]
  std::optional<Estimate> other_share;
  Estimate rate;  ///< >= 0
};

struct DesignsChart {
  std::string title;
  std::string share_label;  ///< of the left axis
  std::string share_name;   ///< of the filled points, in the legend; empty: no legend
  std::string other_name;   ///< of the open points
  std::string rate_label;   ///< of the right axis
  std::vector<DesignRow> rows;
};

/// Shares and rates of designs below each other.
std::string designs_svg(const DesignsChart& chart);

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
