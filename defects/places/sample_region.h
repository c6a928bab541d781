// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where random defects of a group may lie: the allowed part of the surface, and points on it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/rng.h"
#include "defects/definition/defect_settings.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_sampling.h"

namespace glint {

class PlaceRegion {
 public:
  /// Boxes and spheres cut their triangles, so that a small region on a large triangle is drawn
  /// from as easily as any other.
  /// @param table  "defects.dents", for messages
  /// @param whole  of the whole part; shared by the groups that may lie anywhere
  /// @throws ConfigError beginning with the key at fault when nothing of the part is allowed, or
  ///         the painted file does not have the part's triangles; IoError when it cannot be read
  PlaceRegion(const Part& part,
              const std::string& table,
              const DefectRegion& region,
              std::shared_ptr<const AreaSampler> whole);

  /// A point of the smooth surface, uniform over the allowed area. Empty when none was found:
  /// almost nothing of the allowed triangles is in the region.
  std::optional<SurfacePoint> draw(const Part& part, Rng& rng) const;

  /// Whether a point of the smooth surface is allowed as far as box, sphere and facing say.
  bool contains(const Part& part, const SurfacePoint& point) const;

 private:
  DefectRegion region_;
  std::shared_ptr<const AreaSampler> sampler_;
};

}  // namespace glint
