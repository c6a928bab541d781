// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of rough metal in direct light, without noise: as render_paths() with one reflection.
// docs/theory/direct_light.md
#pragma once

#include <cstdint>
#include <string>

#include "core/thread_pool.h"
#include "simulator/render/path_tracing/film.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// How exactly direct light is summed; errors are in radiance, where 1 is the full scale of a
/// sensor at exposure and gain 1, at factor 1 of each light group.
struct DirectSettings {
  double tolerance = 5e-4;     ///< of each panel of a light; > 0
  double interpolated = 1e-3;  ///< between points of the part where light is summed; 0: nowhere
  double spread = 0.06;        ///< rays of a pixel that differ by more are made more
  int rays_per_axis = 2;       ///< of a pixel; in [1, 4]
  int max_rays_per_axis = 8;   ///< where they differ
};

/// What summing took.
struct DirectCounts {
  std::int64_t rays = 0;    ///< camera rays
  std::int64_t points = 0;  ///< at which light was summed
  std::int64_t places = 0;  ///< on lights

  DirectCounts& operator+=(const DirectCounts& other);
};

/// Why direct light of that scene cannot be summed, as half a sentence; empty: it can.
std::string scene_without_direct_sum(const PhysicalScene& scene);

/// The film that render_paths() would make of very many samples with max_reflections 1: groups and
/// the pictures of the part are sums over settings.samples samples a pixel, and the latter are
/// those of render_paths(). Squares say that the samples of a pixel are all the same.
///
/// Light that arrives at faces which nothing rises above (of a convex part: all) is exact; else
/// whether the part hides a place on a light is asked at each place, and likewise where another
/// light might stand in the way. The same bytes for any number of threads.
/// @param settings  samples, channels, seed, windows count
/// @throws ConfigError for settings out of their range, or scene_without_direct_sum()
Film render_direct(const PhysicalScene& scene,
                   const PathSettings& settings,
                   const DirectSettings& direct,
                   ThreadPool& pool,
                   DirectCounts* counts = nullptr);

}  // namespace glint
