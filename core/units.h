// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <string_view>

namespace glint {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kMmPerUm = 1e-3;

/// The factor from a key's written unit to the internal one (mm, rad, s, nm, px), read from the
/// key's suffix: `tilt_deg` -> pi/180, `height_um` -> 1e-3, anything else -> 1.
double internal_per_written(std::string_view key);

/// The unit a key is written in (`mm`, `um`, `deg`, `px`, ...), empty when it has none.
std::string_view written_unit(std::string_view key);

}  // namespace glint
