// SPDX-License-Identifier: GPL-3.0-or-later
//
// How wide the edges of a single picture are. Private to the room.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image/image.h"

namespace glint::acquisition_detail {

/// The sigma of a Gaussian step [px], median over the strong edges: the slope of each is compared
/// with its slope in the picture that was blurred further by a known sigma (Zhuo and Sim, Pattern
/// Recognition 44, 2011). It needs no level of the sides, and does not depend on exposure. Edges
/// along which a picture is smeared stay as they were: a smear counts where most run across it.
/// @param band  true where edges count, of the picture's size divided by `factor`
/// @return none where fewer than 40 pixels lie on strong edges
std::optional<double> edge_spread_px(const Image<std::uint16_t>& codes,
                                     const Mask& band,
                                     int factor);

}  // namespace glint::acquisition_detail
