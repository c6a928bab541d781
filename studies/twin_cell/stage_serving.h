// SPDX-License-Identifier: GPL-3.0-or-later
//
// The twin of a cell's linear stage, and what its place makes of the stripes.
#pragma once

#include <cstdint>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "hardware/twin/side_channel/side_channel.h"
#include "hardware/twin/stage/stage_twin.h"
#include "studies/cell/cell_stage.h"
#include "studies/twin_cell/cell_renderer.h"

namespace glint {

/// Where the stripes of a scan stand: beyond those of one of its frames.
struct StagePlace {
  int position = 0;       ///< the frame's number
  double shift_mm = 0.0;  ///< along the scan, to a tenth of a micrometre

  bool operator==(const StagePlace&) const = default;
};

/// The scan of a truth, along the stage.
struct StripeScan {
  int positions = 1;
  double step_mm = 0.0;    ///< > 0
  double period_mm = 0.0;  ///< > 0; after which the stripes stand as before
};

/// The last frame before a place that is so far along the scan, and how far the place is beyond it.
/// What lies before the first frame, or a step or more after the last one, is taken whole periods
/// back or on.
StagePlace place_along(double along_mm, const StripeScan& scan);

class StageServing {
 public:
  /// @param port  none: the cell's; 0: a free one
  StageServing(const CellStage& stage, const CellRenderer& renderer, std::optional<int> port);

  /// None: it moves, or has not been moved and stands at no position of the scan.
  std::optional<StagePlace> place() const;

  nlohmann::ordered_json description() const;

 private:
  std::uint64_t token_;
  StageWay way_;
  StripeScan scan_;
  StageTwin twin_;
  SideChannel side_;
};

}  // namespace glint
