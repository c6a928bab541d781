// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace glint {

/// One row of corner rays. direction and origin: x, y, z.
struct CornerLine {
  const float* direction[3] = {nullptr, nullptr, nullptr};
  const float* origin[3] = {nullptr, nullptr, nullptr};
  const std::uint8_t* path = nullptr;
  const std::int32_t* piece = nullptr;
};

/// Limits of a cell that is surely smooth; see cell_rule.cpp.
struct CellLimits {
  std::uint8_t wanted_path = 1;  ///< of all corners
  float max_error_rad = 0;
  float max_jump_share = 0;
  float error_per_bend = 0;
  float error_per_kink = 0;
};

/// Marks cells 1 ... num_cells - 2 between lines[1] and lines[2] that are surely smooth: in float,
/// by the rule of check_cell() with all twelve neighbours alike and a margin for rounding.
/// Lines hold num_cells + 1 rays. Other cells are marked 0: they need the exact rule.
void mark_smooth_cells(const CornerLine* lines,
                       int num_cells,
                       const CellLimits& limits,
                       std::uint8_t* is_smooth);

}  // namespace glint
