// SPDX-License-Identifier: GPL-3.0-or-later
//
// A simulated line of parts under one tunnel along kept rays: mirror-like ones, whose scans cost
// what the defects change (docs/theory/simulated_line.md), or rough metal by blurred reflections.
#pragma once

#include <memory>

#include "studies/imaging/line_camera.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// @param traced  the flawless part, which fits into the tunnel
/// @param store   must outlive the line
std::unique_ptr<LineCamera> mirror_line(const SceneSettings& scene,
                                        std::shared_ptr<const TracedScene> traced,
                                        SceneStore& store);

}  // namespace glint
