// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "core/image/image.h"
#include "studies/compare/compared_pair.h"

namespace glint {

/// Looks whether the real picture, mirrored or turned, fits clearly better than as it is, its part
/// laid over the simulated one and turned by at most 12 degrees: in both pictures reduced to some
/// 100 pixels, and where that leaves the part's outline as it is by what is on the part. Pictures
/// of one size.
std::optional<BetterTurn> find_better_turn(const ImageF& simulated, const ImageF& real);

}  // namespace glint
