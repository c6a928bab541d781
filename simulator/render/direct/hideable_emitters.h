// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/light/area/lights.h"

namespace glint {

/// Of more emitters no pairs are looked at: all count as hideable.
inline constexpr std::size_t kMaxPartedEmitters = 256;

/// For each emitter 1 where another one might stand between it and some point of a box; 0: none
/// does. Sure for 0, as each pair is parted by a plane or lies on one cone around the box; on the
/// safe side for 1. Above kMaxPartedEmitters all are 1.
std::vector<std::uint8_t> hideable_emitters(const Lights& lights,
                                            const Eigen::AlignedBox3d& box_mm);

/// The first emitter that might stand before another one, whatever their number; empty: none.
/// @param emitter  index of the other one
std::optional<std::size_t> emitter_before(const Lights& lights,
                                          std::size_t emitter,
                                          const Eigen::AlignedBox3d& box_mm);

}  // namespace glint
