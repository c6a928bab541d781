// SPDX-License-Identifier: GPL-3.0-or-later
//
// What simulated lines of path-traced parts have rendered, at power 1 of every light: a search over
// powers renders each part once.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/cache.h"
#include "simulator/geometry/surface/surface_detail.h"
#include "simulator/render/path_tracing/film.h"
#include "studies/imaging/path_picture.h"

namespace glint {

/// The flawless part, rendered twice with half of the samples each.
struct FlawlessRendering {
  std::array<PathBatch, 2> halves;
  SurfaceImages surface;
  CoverageImages coverage;

  std::size_t bytes() const;
};

/// What the defects of a part add to the radiance, in the pixels where they add anything.
struct RenderedChanges {
  std::vector<std::size_t> pixels;
  /// Of both halves; channel c of group g in pixels[i]: at (g * channels + c) * pixels.size() + i.
  std::array<std::vector<float>, 2> values;

  std::size_t bytes() const;
};

/// Everything that tells the detail of one part from that of others.
std::string digest_of(const SurfaceDetail& detail);

struct LineStore {
  static constexpr CacheLimits kLimits = {.max_bytes = std::size_t{256} << 20U};  ///< of each kind

  template <class Value>
  static std::size_t bytes_of(const std::string& key, const Value& value) {
    return value.bytes() + key.size();
  }

  Cache<std::string, FlawlessRendering> flawless{kLimits, bytes_of<FlawlessRendering>};
  Cache<std::string, RenderedChanges> changes{kLimits, bytes_of<RenderedChanges>};
};

}  // namespace glint
