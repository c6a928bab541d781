// SPDX-License-Identifier: GPL-3.0-or-later
//
// All designs of a run scored again with what a refit has found: did the winner change?
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/pose.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/light_changes.h"

namespace glint {

/// What a refit changes in every design.
struct DesignRefit {
  SceneChange change;              ///< lights of a name that a design does not have are left out
  RigidTransform scene_from_part;  ///< motion of the part about the scene's origin
};

/// The scene of a design with the refit put in: exposure, roughness, blur, lights, the part's pose.
SceneSettings refitted_scene(const SceneSettings& scene, const DesignRefit& refit);

/// @param designs  folders of the run
/// @return { objective, designs: [ { name, before, after } ], winner_before, winner_after, changed
///         }; a score that cannot be had is null; null without an objective, and with several,
///         which order no designs
nlohmann::ordered_json rescore_designs(SceneStore& store,
                                       const Study& study,
                                       const std::filesystem::path& run,
                                       const std::vector<std::string>& designs,
                                       const DesignRefit& refit);

}  // namespace glint
