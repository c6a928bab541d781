// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table [accuracy], read and written (docs/accuracy.md):
//
//   tolerance   "auto", or { score = how wrong it may be }: a number > 0 in the score's own unit,
//   as
//               [constraints] and result.json have it; "2 %" of its value; "0.1 points": hundredths
//   confidence  of the bounds, in [0.5, 1)
//   keep        keys of [render] that stay as they are; without it those that the file gives;
//               "camera.width_px": no rung renders fewer pixels than the camera has;
//               "render.paths.max_reflections": no rung of paths has fewer reflections
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/config/key_writer.h"
#include "studies/definition/study.h"

namespace glint {

/// Keys of [render] that a ladder keeps.
struct KeptKeys {
  bool method = false;               ///< render.method
  bool rays_per_axis = false;        ///< render.rays_per_axis
  bool max_direction_error = false;  ///< render.max_direction_error_mrad
  bool samples = false;              ///< render.paths.samples: no rung of a search has more
  bool resolution = false;           ///< camera.width_px, where it is named: every file gives it
  bool reflections = false;          ///< render.paths.max_reflections, where it is named

  bool operator==(const KeptKeys&) const = default;
};

/// Paths of the keys of [render] that KeptKeys knows, in its order.
const std::vector<std::string>& ladder_keys();

/// Those of ladder_keys() that a file gives. @param root  as written
KeptKeys keys_in_file(const ConfigNode& root);

/// Empty without the table.
/// @param scene   of the study, which has the scores that are named
/// @param errors  grows by all problems found, those of unknown keys and of scores together
std::optional<AccuracySettings> read_accuracy(const ConfigNode& root,
                                              const SceneSettings& scene,
                                              std::vector<Problem>& errors);

/// What the table needs of the rest of a study: a search, and no [render] key that it varies.
/// @param errors  grows by what is missing
void check_accuracy(const Study& study, std::vector<Problem>& errors);

/// The table with every key present. @param root  of the study, for the keys that are kept
ConfigNode write_accuracy(const AccuracySettings& settings, const ConfigNode& root);

std::vector<KeyRow> accuracy_keys();

/// The keys that the study's ladder keeps.
KeptKeys kept_keys(const ConfigNode& root);

/// Paths of the keys that are kept.
std::vector<std::string> names_of(const KeptKeys& kept);

/// "0.1 points of homogeneity.h_rms (0.001)", "2 % of defects.min_cnr".
std::string wish_text(const ScoreWish& wish);

}  // namespace glint
