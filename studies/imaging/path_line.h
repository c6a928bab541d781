// SPDX-License-Identifier: GPL-3.0-or-later
//
// A simulated line whose parts are path-traced: any material under any lights. The flawless part is
// rendered once for a lighting; of a part with defects only windows about them are, with the same
// random numbers, so that whatever the defects leave alone cancels to the last bit
// (docs/theory/simulated_line.md). Where direct light is summed, the same, but that nothing is
// noisy.
#pragma once

#include <memory>

#include "studies/imaging/line_camera.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// @param scene   that the path tracer is for; it looks from scene.viewpoint()
/// @param traced  the flawless part
/// @param store   must outlive the line; keeps what was rendered at power 1
/// @throws ConfigError beginning with the key at fault, IoError
std::unique_ptr<LineCamera> path_line(const SceneSettings& scene,
                                      std::shared_ptr<const TracedScene> traced,
                                      SceneStore& store);

}  // namespace glint
