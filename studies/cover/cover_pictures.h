// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part coloured by what inspects it: blue by the number of views, red and yellow where none
// does.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/image/image_io.h"
#include "core/thread_pool.h"
#include "studies/coverage/scene_coverage.h"

namespace glint {

using ScreenColour = std::array<std::uint8_t, 3>;

/// As a screen shows it (sRGB).
ScreenColour coverage_colour(const CellCoverage& cell);

/// An entry of the legend and its share of the surface.
struct LegendEntry {
  std::string name;
  ScreenColour colour = {};
  double share = 0.0;
};

/// The colours that occur, uninspected ones first.
std::vector<LegendEntry> coverage_legend(const SceneCoverage& covered);

/// "#08519c"
std::string css_colour(const ScreenColour& colour);

struct CoveragePicture {
  std::string caption;
  ImageRgb image;
};

/// From around the part, and from where most of the largest gap is seen, if there is one.
std::vector<CoveragePicture> draw_coverage(const SceneCoverage& covered, ThreadPool& pool);

/// A PLY whose vertices have colours and whose faces have the number of views that inspect them,
/// `smallest_defect_um`, `incidence_deg`, `lit_share` and `pixel_um`.
/// @param smallest_um  one of smallest_defects_um() for each cell
std::string coverage_ply(const SceneCoverage& covered, std::span<const float> smallest_um);

}  // namespace glint
