// SPDX-License-Identifier: GPL-3.0-or-later
//
// The film of a view by the sum of direct light, where render.method = "direct" asks for it. Films
// hold the light of each group at power 1; how exactly it is summed follows from what the sensor
// and the scene's powers make of it. docs/theory/direct_light.md
#pragma once

#include <span>
#include <vector>

#include "core/thread_pool.h"
#include "simulator/material/local.h"
#include "simulator/render/direct/render_direct.h"
#include "simulator/render/path_tracing/render_paths.h"
#include "studies/definition/scene.h"

namespace glint {

/// How many times grey values grow with the radiance of the brightest light group, as a power of 2
/// that is at least as large: exposure x gain x factor, 0 where that is 1 or less, 30 at most. The
/// same for many powers, so that a search over them seldom renders again.
/// @param frames  factors of each group in each frame of the scene
int brightness_octave(const SensorSettings& sensor, std::span<const std::vector<Colour>> frames);

/// Errors of 5e-4 of full scale for each panel of a light at 2 x 2 rays a pixel
/// (render.rays_per_axis = 2), four times that at 1 and a quarter at 4 x 4; those of interpolation
/// twice as large.
/// @param octave  brightness_octave(): radiance is that much more exact
DirectSettings direct_settings(const RenderSettings& render, int octave);

/// render_direct(), or render_paths() where the settings have no light. Nothing that counts samples
/// is finer than the masks of a scan: 16 a pixel, or settings.samples where these are fewer.
/// @param preview  sees the whole film, once
/// @throws ConfigError  as render_direct()
Film direct_film(const PhysicalScene& scene,
                 PathSettings settings,
                 const DirectSettings& direct,
                 ThreadPool& pool,
                 const PathPreview& preview = {});

}  // namespace glint
