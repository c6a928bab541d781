// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places that a scene file gives: put onto the part's surface.
#pragma once

#include <string>
#include <vector>

#include "defects/definition/defect_settings.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_sampling.h"

namespace glint {

struct FixedPlace {
  SurfacePoint point;
  double off_mm = 0.0;  ///< how far it was moved onto the surface
};

/// The places of a group: at_mm on the nearest surface, else x_mm and y_mm seen from above.
/// @param table  "defects.dents", for messages
/// @throws ConfigError when a place is beside the part, or more than 1 mm and 1 % of the part's
///         diagonal off its surface
std::vector<FixedPlace> fixed_places(const Part& part,
                                     const Bvh& bvh,
                                     const std::string& table,
                                     const DefectGroup& group);

}  // namespace glint
