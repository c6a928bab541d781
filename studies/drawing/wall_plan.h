// SPDX-License-Identifier: GPL-3.0-or-later
//
// The wall of a tunnel as a workshop needs it: arcs and straight pieces with their points and
// radii, as words of a sheet, as a table and as DXF.
#pragma once

#include <string>
#include <vector>

#include "studies/drawing/arc_chain.h"
#include "studies/drawing/drawing.h"

namespace glint {

/// Each panel as arcs from its rim on, its end moved to the edge of the slot. Two walls that are
/// mirror images have mirrored arcs.
std::vector<std::vector<Arc>> wall_arcs(const CrossSection& section);

/// Lines for the sheet: the arcs of the panel at y > 0, or of the only one, with their points
/// (y, z) and radii in mm; at most so many, else a line that the table has them.
std::vector<std::string> wall_lines(const CrossSection& section, std::size_t max_lines = 16);

/// All arcs: panel, from_y_mm, from_z_mm, to_y_mm, to_z_mm, radius_mm, centre_y_mm, centre_z_mm,
/// angle_deg; the last four are empty for straight pieces.
std::string wall_csv(const CrossSection& section);

/// The cross-section at 1 : 1: layers LIGHT (the wall's arcs), PART (its outline), CAMERA (its
/// axis) and NOTES (title and units). y to the right, z upwards.
std::string wall_dxf(const CrossSection& section);

}  // namespace glint
