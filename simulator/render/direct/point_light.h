// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of points that camera rays met, with what stands in its way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulator/render/direct/direct_light.h"
#include "simulator/render/direct/render_direct.h"
#include "simulator/render/path_tracing/packet_stages.h"

namespace glint {

/// What all tiles of a picture share. Immutable.
class PointLight {
 public:
  PointLight(const PathTask& task, const DirectSettings& settings);

  /// Numbers of a point, as DirectLight::size().
  std::size_t size() const { return light_.size(); }

  /// The light of a lane that met the part, with the metal's plain colour.
  /// @return  places on lights that were looked at
  int at(const SurfaceLanes& surface,
         std::size_t lane,
         DirectLight::Scratch& scratch,
         std::span<float> radiance) const;

 private:
  void hide(const DirectPoint& point, bool by_part, const PlaceLanes& places, LitLanes& lit) const;

  const PathTask& task_;
  DirectLight light_;
  std::vector<std::uint8_t> hideable_;  ///< of each emitter
  bool has_hideable_ = false;
};

/// In the scene frame.
DirectPoint direct_point(const SurfaceLanes& surface, std::size_t lane);

}  // namespace glint
