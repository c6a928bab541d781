// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --sensor`: the table [sensor] of a scene from pictures of even light.
#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json_fwd.hpp>

namespace glint {

struct SensorOptions {
  std::filesystem::path folder;  ///< with levels.csv or levels.txt
  std::filesystem::path out;     ///< empty: out/<name of the folder>/sensor
  std::optional<int> bits;       ///< of a code; not given: from the largest code of all pictures
  int threads = 1;
};

/// Writes sensor.toml for scenes, sensor.json, levels.csv, flat_field.exr, report.html, run.json.
/// @return what sensor.json holds, "report" and "folder"
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json calibrate_sensor(const SensorOptions& options);

}  // namespace glint
