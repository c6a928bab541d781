// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was simulated, in the words of a page: part, surface, camera, light, scan, defects.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// The size of a scene's part before its pose and how many triangles it has:
/// { "name", "size_mm": [x, y, z], "triangles": number }, for result.json.
nlohmann::ordered_json part_json(const Part& part);

/// Writes a shaded picture of the part as the scene's camera sees it, without its lighting.
/// @throws ConfigError beginning with the key at fault, IoError
void write_part_picture(SceneStore& store,
                        const SceneSettings& scene,
                        const std::filesystem::path& file);

/// Lines for the page, [ [ name, text ] ].
/// @param part   part_json(); null: not known
/// @param study  name of the study file; empty: not known
nlohmann::ordered_json scene_facts(const SceneSettings& scene,
                                   const nlohmann::ordered_json& part,
                                   const std::string& study);

/// The name of a study's file, without its folder; of a study from no file its own name.
std::string study_file(const Study& study);

/// The table of the defects of a design's defects.json: { head, rows, more }.
nlohmann::ordered_json defect_table(const nlohmann::ordered_json& defects);

/// "2 mm wide, 40 um deep", "5 mm long, 0.2 mm wide, 10 um high", of an entry of defects.json.
std::string defect_size_text(const nlohmann::ordered_json& defect);

/// The frame about a defect of defects.json in the part's picture, [left, top, width, height]: half
/// as large again as the defect. Older runs tell only the window of its scores, which is larger.
nlohmann::ordered_json marked_px(const nlohmann::ordered_json& defect);

}  // namespace glint
