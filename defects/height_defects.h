// SPDX-License-Identifier: GPL-3.0-or-later
//
// Defects given as height on the surface: Gaussian dents and bumps, and line scratches. They act on
// the normal, and on the position where wanted: for defects much smaller than the viewing distance
// the normal is what matters (docs/theory/parts.md).
#pragma once

#include <string>
#include <vector>

#include "core/keys.h"
#include "simulator/geometry/surface_detail.h"

namespace glint {

/// Keys of [defects.<name>]: equal defects at several places of the part.
struct DefectGroup {
  enum class Type { kDent, kBump, kScratch };

  Type type = Type::kDent;
  std::vector<double> x_mm = {0.0};  ///< places in the part's frame, seen from above
  std::vector<double> y_mm = {0.0};
  double height_mm = 2e-3;   ///< depth of a dent or scratch, height of a bump, > 0
  double diameter_mm = 0.8;  ///< dent, bump: 4 sigma
  double length_mm = 3.0;    ///< scratch
  double width_mm = 0.3;     ///< scratch: 4 sigma of its cross-section
  double angle_rad = 0.0;    ///< scratch: from the x axis
  bool moves_position = false;
};

void visit_keys(KeyVisitor& keys, DefectGroup& group);

/// The type a table of that name has when it gives none ("dents" -> dent), kDent otherwise.
DefectGroup::Type type_from_name(const std::string& name);

/// The group's defects on the part; ids count from first_id, labels are "<name>_1", "<name>_2", ...
/// @throws ConfigError when a place is beside the part.
std::vector<HeightFeature> make_features(const std::string& name,
                                         const DefectGroup& group,
                                         const Part& part,
                                         const Bvh& bvh,
                                         int first_id);

}  // namespace glint
