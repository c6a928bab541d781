// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint inspect` goes by: the [inspection] table from several places, and people's labels.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "metrics/inspection/grading.h"
#include "studies/definition/study.h"

namespace glint {

struct InspectionRules {
  InspectionSettings settings;
  bool has_limits = false;  ///< of the classes: one is above 0, or was written by the user
};

/// The table of a scene, below those of the files, in their order, below values of the command
/// line.
/// @param base   what keys are that none of these sets
/// @param scene  empty: none
/// @param files  TOML files with an [inspection] table; their other tables are not read
/// @param sets   paths begin with "inspection."
/// @throws ConfigError with every problem, IoError
InspectionRules read_inspection_rules(const InspectionSettings& base,
                                      const std::filesystem::path& scene,
                                      std::span<const std::filesystem::path> files,
                                      std::span<const KeyValue> sets);

/// The settings as an [inspection] table of a TOML file.
std::string inspection_toml(const InspectionSettings& settings);

/// Reads a CSV file of two columns: a part's name and its grade in any case; a first line that says
/// "part" is left out. @throws ConfigError with file and line, IoError
std::map<std::string, Grade> read_labels(const std::filesystem::path& file);

}  // namespace glint
