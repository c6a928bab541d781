// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files of a front's designs in the folder of a run.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/evaluation/evaluation.h"

namespace glint {

/// Where they are, in the folder of a run.
inline constexpr const char* kFrontFolder = "front";

/// Removes from run/front/ the designs that are no longer shown, and what an earlier search has
/// left in a folder that is now shown in another way.
/// @param front  of plan_front()
void remove_other_designs(const std::filesystem::path& run, const nlohmann::ordered_json& front);

/// Draws the lighting of a design that was evaluated, as SVG. @param scene  of a single view
using DrawLighting = std::function<std::string(
    const SceneSettings& scene, const Evaluation& evaluation, const std::string& title)>;

/// The mean image of a design, small, with the drawing of its lighting and its scene:
/// thumbnail.png, cross_section.svg, scene.toml. @throws IoError, ConfigError
void write_thumbnail(SceneStore& store,
                     const SceneSettings& scene,
                     const std::string& title,
                     const WantedScores& wanted,
                     const DrawLighting& drawing,
                     const std::filesystem::path& folder);

}  // namespace glint
