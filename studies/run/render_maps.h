// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures for people, made from a rendered view: defect map, picture and map side by side, sheet
// of views.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/image/exr_layers.h"
#include "defects/part/defective_part.h"
#include "simulator/render/path_tracing/film.h"

namespace glint {

/// The colour of a kind of defect in maps, as a screen shows it (sRGB).
std::array<std::uint8_t, 3> defect_colour(DefectType type);

/// The same as CSS has it: "#d55e00".
std::string defect_colour_css(DefectType type);

/// What each pixel shows, mixed by coverage: dark grey beside the part, light grey on sound
/// surface, a colour for each kind of defect. Linear values, like all pictures.
ImageRgb defect_map(const Film& sums, const DefectivePart& made);

/// 1 where defects cover at least half of what a pixel shows.
Mask defect_mask(const Film& sums);

/// 1 where all of a pixel is on the part.
Mask whole_part_mask(const Film& sums);

/// Reduced so that the longest side has at most so many pixels; each new pixel is the mean of the
/// area it covers.
ImageRgb shrunk(const ImageRgb& image, int max_px);

/// Two pictures of one size, a white gap between them, the longest side of each at most that long.
ImageRgb side_by_side(const ImageRgb& left, const ImageRgb& right, int max_px = 1000);

/// A grid of small pictures with their numbers from 1.
ImageRgb numbered_sheet(std::span<const ImageRgb> pictures);

}  // namespace glint
