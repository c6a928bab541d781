// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the pictures of a scene come about.
#pragma once

#include <string_view>

#include "core/config/keys.h"

namespace glint {

/// Keys of [render].
struct RenderSettings {
  /// How pictures come about; see docs/theory/footprints.md.
  enum class Method {
    kAuto,        ///< closed where it holds and no pictures are asked for, else integrated
    kSampled,     ///< the plain way: rays_per_axis^2 point samples a pixel
    kIntegrated,  ///< one ray a pixel, its footprint integrated in closed form
    kClosed,      ///< mean of a scan by closed forms, integrated frames only where they do not hold
    kPaths,       ///< by path tracing: any light and material (path_tracing/)
    kBlurred,     ///< rough metal under a tunnel, its lobe summed around kept rays (blurred/)
    kDirect       ///< rough metal in the direct light of lamps, summed over them (direct/)
  };

  Method method = Method::kAuto;
  int rays_per_axis = 2;                  ///< sampled, blurred, direct: on a regular grid
  double max_direction_error_rad = 2e-4;  ///< not sampled: of rays taken as linear across a cell
  int max_bounces = 4;                    ///< reflections on the part before a ray is given up
  double reflectance = 1.0;               ///< no key: of the mirror-like part, per reflection
};

/// Names of RenderSettings::Method in order.
std::string_view method_name(RenderSettings::Method method);

void visit_keys(KeyVisitor& keys, RenderSettings& settings);

}  // namespace glint
