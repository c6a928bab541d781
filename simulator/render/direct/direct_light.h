// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a point of rough metal shows of area lights, without noise: the integral over each luminous
// surface of reflectance times radiance, by product rules of Gauss-Legendre on panels of the
// surface's own coordinates. Panels are cut, and places on them counted, by how near the lobe and
// the light are (panel_smoothness.h), so a small or far light takes a few places and a narrow lobe
// that meets a large one takes many there and few elsewhere. The BRDF is the path tracer's kernel.
// docs/theory/direct_light.md
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "simulator/light/area/lights.h"
#include "simulator/material/local.h"
#include "simulator/render/direct/panel_smoothness.h"
#include "simulator/render/direct/place_kernels.h"

namespace glint {

/// A point of metal and where it is seen from.
struct DirectPoint {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  ShadingFrame frame;
  LocalDirection to_viewer;                         ///< unit, in that frame
  Eigen::Vector3d side = Eigen::Vector3d::UnitZ();  ///< unit; light from behind it is blocked
};

/// Whether something stands between a point and sixteen places on lights: clears the solid angle of
/// those that are hidden.
using ShadowTest =
    std::function<void(const DirectPoint& point, const PlaceLanes& places, LitLanes& lit)>;

/// The same for all points. Immutable; metal and lights must outlive it.
class DirectLight {
 public:
  /// Work memory of one thread.
  struct Scratch {
    std::vector<PlaceLanes> places;
    std::vector<double> sums;
  };

  /// @param channels   1 or 3
  /// @param tolerance  of the radiance, for each panel of a light; > 0
  /// @throws ConfigError  as lights_without_direct_sum() says
  DirectLight(const Lights& lights, const ConductorNumbers& metal, int channels, double tolerance);

  /// Numbers of a point: its radiance by light group at factor 1, and channel.
  std::size_t size() const { return lights_.groups.size() * static_cast<std::size_t>(channels_); }

  /// @param radiance  size() of them; 0 where the viewer sees the surface's back
  /// @param shadows   empty: nothing stands in the way
  /// @return          how many places on lights were looked at
  int at(const DirectPoint& point,
         const ShadowTest& shadows,
         Scratch& scratch,
         std::span<float> radiance) const;

  /// The places on lights that are looked at, sixteen to a packet; the last one is filled up by
  /// such of no area. @return their number
  /// @param is_shadowed  more of them, as a shadow's edge may run between
  int choose_places(const DirectPoint& point,
                    bool is_shadowed,
                    std::vector<PlaceLanes>& places) const;

 private:
  int place_emitter(const LocalEmitter& emitter,
                    const PanelView& view,
                    int index,
                    int first,
                    float log2_tolerance,
                    std::vector<PlaceLanes>& places) const;

  void add_packet(const PlaceLanes& places, const LitLanes& lit, std::vector<double>& sums) const;

  const Lights& lights_;
  const ConductorNumbers& metal_;
  int channels_;
  float log2_tolerance_;
  bool has_lobes_ = false;  ///< some light is not Lambertian
};

/// The surface as seen from the origin of that frame.
LocalEmitter local_emitter(const Emitter& emitter, const DirectPoint& point);

/// Why direct light of these lights cannot be summed; empty: it can.
std::string lights_without_direct_sum(const Lights& lights);

}  // namespace glint
