// SPDX-License-Identifier: GPL-3.0-or-later
//
// The figures by which parts are sorted, as an SVG document; equal input gives equal bytes.
#pragma once

#include <string>
#include <vector>

#include "metrics/inspection/grading.h"
#include "metrics/inspection/inspection_settings.h"

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

}  // namespace glint
