// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs compared by their figures, as an SVG document; equal input gives equal bytes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {

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

}  // namespace glint
