// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/light/area/lights.h"

namespace glint {

/// For each emitter 1 where another one might stand between it and some point of a box; 0: none
/// does. Sure for 0, as each pair is parted by a plane; on the safe side for 1. Above 256 emitters
/// all are 1.
std::vector<std::uint8_t> hideable_emitters(const Lights& lights,
                                            const Eigen::AlignedBox3d& box_mm);

}  // namespace glint
