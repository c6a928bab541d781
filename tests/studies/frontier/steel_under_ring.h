// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint::test {

/// Brushed steel under a ring light, by 8 samples and 2 reflections; the text ends in
/// [render.paths].
inline constexpr const char* kSteelUnderRing = R"(
schema = 1
title = "Ring"
[part]
shape = "plate"
length_mm = 48
width_mm = 36
thickness_mm = 5
[material]
type = "conductor"
colour_srgb = [196, 199, 199]
roughness = 0.4
[camera]
width_px = 24
height_px = 18
object_pixel_mm = 1.2
working_distance_mm = 180
[sensor]
wavelengths_nm = [630]
bits = 8
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 80
radiance = [2]
[render.paths]
samples = 8
max_reflections = 2
)";

}  // namespace glint::test
