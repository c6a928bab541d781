// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/key_table.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "studies/definition/scene.h"
#include "studies/definition/study.h"
#include "studies/definition/study_tables.h"

namespace glint {
namespace {

constexpr std::array kGroups = {
    KeyGroup{"schema", "which version of the format the file is written in"},
    KeyGroup{"title", "what the study is called in its report"},
    KeyGroup{"include", "files that this one builds on"},
    KeyGroup{"part", "the part: a mesh file or a parametric shape, its unit and pose"},
    KeyGroup{"material", "how the part reflects"},
    KeyGroup{"camera", "pixels, focal length, working distance, distortion"},
    KeyGroup{"lens", "aperture and focus"},
    KeyGroup{"calibration", "how well the camera is known, and where it is on or beside a robot"},
    KeyGroup{"cell", "where the part is at the robot"},
    KeyGroup{"viewpoint", "[[viewpoint]]: where cameras stand, one table each"},
    KeyGroup{"viewpoints", "many cameras at once: on a sphere, along the surface, from a file"},
    KeyGroup{"sensor", "exposure, gain, blur, noise, bits"},
    KeyGroup{"scan", "how the tunnel moves between pictures, and how many are taken"},
    KeyGroup{"render", "how pictures are computed, and how finely"},
    KeyGroup{"lighting_use", "which of the lights shine"},
    KeyGroup{"lighting", "a table for each light: the fringe tunnel, rings, domes, bars ..."},
    KeyGroup{"defects", "a table for each group of defects: dents, bumps, scratches ..."},
    KeyGroup{"imprint", "what holds for all groups of defects"},
    KeyGroup{"metrics", "over which pixels scores are taken"},
    KeyGroup{"inspection", "how pictures are searched for defects, and parts graded"},
    KeyGroup{"reference", "real pictures to compare with"},
    KeyGroup{"validate",
             "designs to try out on the real cell, and up to which differences they agree"},
    KeyGroup{"coverage", "what it takes for a view to inspect a place of the surface"},
    KeyGroup{"cost", "what a scan takes and what its lighting costs"},
    KeyGroup{"variables", "the keys that a search may change, with their limits"},
    KeyGroup{"prototypes", "designs to be compared with the study's own"},
    KeyGroup{"objective", "the score that a search makes large or small; several: [[objective]]"},
    KeyGroup{"choice", "which of the designs of several objectives is the best"},
    KeyGroup{"constraints", "limits that scores of a design must keep"},
    KeyGroup{"manufacture", "how exactly keys can be built or set"},
    KeyGroup{"search", "how a search chooses designs"},
    KeyGroup{"budget", "when a search ends"},
    KeyGroup{"accuracy", "how exactly a search has to know the scores"},
    KeyGroup{"sorting", "a population of simulated parts, sorted into classes"},
    KeyGroup{"pod", "how often defects are found, against their size"},
    KeyGroup{"calibration_trial",
             "pictures of a board, rendered and calibrated as photographs are"},
};

void add_file_keys(std::vector<KeyRow>& rows) {
  rows.push_back({.path = "schema",
                  .kind = "integer",
                  .allowed = fmt::format("1 to {}", kNewestSchema),
                  .default_text = fmt::format("{}", kNewestSchema),
                  .doc = "version of the format of this file; 2 added [calibration] [cell] "
                         "[reference] [validate], and older files keep working",
                  .range = Range::between(1, kNewestSchema)});
  rows.push_back({.path = "title",
                  .kind = "text",
                  .allowed = "any",
                  .default_text = "none",
                  .doc = "of the report; without it the name of the file or its folder"});
  rows.push_back({.path = "include",
                  .kind = "texts",
                  .allowed = "names of TOML files, relative to this one",
                  .default_text = "[]",
                  .doc = "files whose keys hold where this one is silent; later files win"});
}

/// The type of a light's table is read before its other keys.
void add_light_types(std::vector<KeyRow>& rows) {
  std::vector<std::string> types = {"tunnel"};
  types.insert(types.end(), light_types().begin(), light_types().end());
  for (const std::string& type : types) {
    rows.push_back({.path = fmt::format("lighting.{}.type", type),
                    .kind = "choice",
                    .allowed = fmt::format("\"{}\"", fmt::join(types, "\", \"")),
                    .default_text = fmt::format("\"{}\"", type),
                    .doc = "kind of light; without it the table's name is its kind, and a table "
                           "of any other name is a tunnel",
                    .choices = types});
  }
}

}  // namespace

std::span<const KeyGroup> key_groups() {
  return kGroups;
}

std::vector<KeyRow> all_keys() {
  std::vector<KeyRow> rows;
  add_file_keys(rows);
  std::ranges::copy(scene_keys(), std::back_inserter(rows));
  add_light_types(rows);
  std::ranges::copy(study_keys(), std::back_inserter(rows));
  return rows;
}

std::vector<KeyRow> keys_of(DefectType type) {
  const std::string table = "defects.dent.";
  std::vector<KeyRow> rows;
  for (KeyRow& row : scene_keys()) {
    const std::string key =
        row.path.starts_with(table) ? row.path.substr(table.size()) : std::string();
    if (!key.empty() && uses_key(type, key)) {
      row.path = fmt::format("defects.{}.{}", type_name(type), key);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace glint
