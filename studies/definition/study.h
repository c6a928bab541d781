// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study: a scene whose keys may be declared variables, with an objective, constraints, named
// prototypes and a budget. Everything is checked when it is read, and all problems are reported at
// once.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "optimizer/search/search.h"
#include "studies/definition/accuracy_settings.h"
#include "studies/definition/calibration_trial_settings.h"
#include "studies/definition/population_settings.h"
#include "studies/definition/scene.h"

namespace glint {

/// Format of study files. 2: [calibration] [cell] [reference] [validate], base_from_flange.
inline constexpr int kNewestSchema = 2;

/// Values put at dotted paths of a scene.
using Overrides = std::vector<std::pair<std::string, ConfigNode>>;

/// A lighting someone wants to see beside the search.
struct Prototype {
  std::string name;
  std::string title;
  Overrides overrides;
  Place place;  ///< of its table
};

struct Study {
  std::string name;   ///< of its folder, or of its file without extension
  std::string title;  ///< for people
  ConfigNode root;    ///< as written, with --set values
  SceneSettings scene;
  ConfigNode resolved;  ///< write_scene() of the scene
  SearchSpace space;    ///< may be empty: then there is nothing to search
  Goal goal;
  bool has_objective = false;
  SearchSettings search;
  bool has_needed_scores_only = false;  ///< search.scores: of designs that the search evaluates
  Budget budget;
  std::optional<AccuracySettings> accuracy;
  std::vector<Prototype> prototypes;
  std::optional<SortingSettings> sorting;                     ///< never beside variables
  std::optional<PodSettings> pod;                             ///< the same
  std::optional<CalibrationTrialSettings> calibration_trial;  ///< never beside any of them

  bool has_population() const { return sorting.has_value() || pod.has_value(); }

  bool has_search() const { return !space.variables.empty(); }
};

/// Whether the search takes derivatives of scores.
bool wants_derivatives(const Study& study);

/// A `--set key=value` argument.
struct KeyValue {
  std::string path;
  std::string value;
};

/// Reads and checks a study. @throws ConfigError with every problem, IoError
Study load_study(const std::filesystem::path& path,
                 const std::vector<KeyValue>& sets,
                 SceneUse use = SceneUse::kPictures);

/// All files that a study and its prototypes are read from, and folders of tools: its own and those
/// it includes, and those of its scenes.
std::vector<std::filesystem::path> input_files(const Study& study);

/// The study's scene with other values. @throws ConfigError naming path and what is allowed
SceneSettings scene_with(const Study& study, const Overrides& overrides);

/// The study's own scene and nothing to search: what a rendered folder describes.
Study scene_study(Study study);

/// An error of the scene with a prototype's values, with the places of the values or of the
/// prototype that cause it.
ConfigError prototype_error(const Prototype& prototype, const ConfigError& error);

/// What a point of the search space means: the active variables' values.
Overrides overrides_of(const Study& study, const Point& point);

/// The point that the study's own scene stands at, moved into the variables' limits.
Point baseline_point(const Study& study);

/// "40s", "30m", "8h", "1h30m" or a number of seconds; empty when it is none of these.
std::optional<double> parse_duration_s(const std::string& text);

}  // namespace glint
