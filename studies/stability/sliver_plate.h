// SPDX-License-Identifier: GPL-3.0-or-later
//
// A plate as programs of design write plates: a mesh with triangles that are hardly wider than
// nothing, and whose corners lie on its faces as far as digits hold.
#pragma once

#include <string>

#include "studies/stability/stability_cell.h"

namespace glint::stability {

/// The plate as an OBJ file, closed and turned about x by 33 degrees, so that digits are lost. Its
/// upper and lower face have four rows of triangles that are 95 mm long where the plate is 190.
/// @param sliver_mm  > 0; the width of these rows
std::string sliver_plate_obj(const PartSettings& plate, double sliver_mm);

/// Evaluates a scene whose plate is such a mesh. The outcome's scene has the plate itself, for the
/// reference. @throws ConfigError, IoError
Outcome evaluated_with_slivers(SceneStore& store, const ConfigNode& root, double sliver_mm);

}  // namespace glint::stability
