// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures by path tracing: every light, any number of reflections on the part, any material.
// docs/theory/path_tracing.md
#pragma once

#include <cstdint>
#include <functional>

#include "core/thread_pool.h"
#include "simulator/render/path_tracing/film.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// How far a rendering has come, after each pass.
struct PathProgress {
  int pass = 0;                 ///< from 1
  int samples = 0;              ///< of the pixels that have most
  std::int64_t tiles_left = 0;  ///< tiles of 8 x 8 pixels that need more samples
  const Film* sums = nullptr;   ///< what there is; valid during the call only
};

/// Called after each pass by the caller's thread, never at the same time. false: stop here.
using PathPreview = std::function<bool(const PathProgress&)>;

/// Renders all light groups at once. The first pass has 4 samples a pixel, so that a preview comes
/// soon. The same bytes for any number of threads; what does not depend on light (masks, ids) is
/// the same with and without it.
///
/// Linear radiance, W / (m^2 sr), nothing is clamped. Memory: 4 bytes a pixel for each group and
/// channel, 60 bytes more, 2 more for each defect.
/// @throws ConfigError for settings out of their range, more than 65535 samples a pixel
Film render_paths(const PhysicalScene& scene,
                  const PathSettings& settings,
                  ThreadPool& pool,
                  const PathPreview& preview = {});

}  // namespace glint
