// SPDX-License-Identifier: GPL-3.0-or-later
//
// The fringe tunnel as a light for the path tracer: one picture of all phases of its stripes gives
// every frame of a scan.
//
// The tunnel exists twice on purpose. A mirror needs a single ray for each place of a pixel, so
// simulator/light/tunnel intersects cached rays with the cross-section in closed form and a scan is
// integrated in milliseconds; but that has no answer for light from all directions. Rough and
// coated metal gather such light, which needs a light that can be sampled and hit like any other:
// that is this file, made from the same TunnelSettings. Tests compare both on pictures of a mirror
// (tests/simulator/render/path_tracing/tunnel_frames_test.cpp).
//
// The wall shines evenly; what arrives is sorted by the phase of the place it comes from (its
// pattern coordinate within a period) into bins, each a light group. Moving the tunnel changes
// only which phases are bright:
//
//     frame k = sum over bins of tunnel_frame_factors()[k][bin] * picture of that bin.
//
// Where the light of dark stripes depends on the place (simulator/light/tunnel/dark_radiance.h)
// every bin is there twice, once with the radiance of the darkest place and once with that of the
// brightest, and light from a place between them goes to either as often as its radiance lies near.
//
// Bins end where an edge of a stripe stands in one of the frames, so this is exact: twice as many
// bins as positions at most, as many when step = period / positions and positions * duty is a whole
// number. Scans that would need more than kMaxTunnelBins have that many of equal width, with
// the bright share of each as its factor: edges of stripes are then blurred over 1 / 96 period.
//
// Not as level 0 has it: the tunnel's ends stand where they are in the middle of the scan, at all
// positions (there they move by half the way of the scan, about half a period); the wall is a
// polygon whose sides leave the curve by 1 / 320 of a period at most, or 1 / 2000 of its size where
// that is less; camera rays that miss the part see the wall. docs/theory/lights.md
#pragma once

#include <string>
#include <vector>

#include "simulator/light/area/lights.h"
#include "simulator/light/tunnel/tunnel.h"

namespace glint {

inline constexpr int kMaxTunnelBins = 96;

/// A tunnel and the scan it makes: it stands at k * step_mm along x in frame k.
struct TunnelLight {
  std::string name;  ///< of its table below [lighting]; groups are "<name>.<bin>"
  TunnelSettings settings;
  int positions = 1;     ///< > 0
  double step_mm = 0.0;  ///< scan_step_mm()
  /// Directions are drawn towards a wall that fills less than this share of the upper half of all
  /// directions, seen from the middle of its base. What fills more is found by the directions that
  /// the material draws: as good for very rough metal in the same time, twice as good for smooth.
  double drawn_below = 0.6;
};

/// For each frame the factors of the tunnel's groups, in their order: 1 for bright phases, the dark
/// radiance for dark ones: the lowest for all bins and then, where there is more than one, the
/// highest for all bins.
std::vector<std::vector<double>> tunnel_frame_factors(const TunnelLight& light);

/// Adds the wall's emitters and its groups behind those that are there; the tree is left alone. A
/// group's own factor is its mean over the frames, so totals are the mean of the scan.
/// @throws ConfigError "lighting.<name>.<key>: ..." for led_ripple and end_falloff, which move with
/// the tunnel and so are no matter of phases, and for a wall that is all slot
void add_tunnel(const TunnelLight& light, Lights& lights);

}  // namespace glint
