// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint inspect`: the inspector on pictures of real or simulated parts.
#pragma once

#include <atomic>
#include <filesystem>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct InspectOptions {
  std::vector<std::filesystem::path> inputs;  ///< files of one part, folders, run directories
  std::filesystem::path out;
  bool is_each = false;                         ///< every picture is a part of its own
  std::filesystem::path mask;                   ///< where the part is; empty: none
  std::filesystem::path reference_mask;         ///< the same, in another place; empty: none
  std::vector<std::filesystem::path> settings;  ///< files with an [inspection] table
  std::vector<KeyValue> sets;
  std::vector<std::filesystem::path> flawless;  ///< inputs for threshold = "false_alarms"
  std::filesystem::path labels;                 ///< CSV of parts and grades; empty: none
  bool is_learning = false;                     ///< limits from the labels
  int threads = 1;
  Progress::Style progress = Progress::Style::kAuto;
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// Inspects parts and writes the files of docs/inspect.md; they appear when all are whole.
/// @return the object of result.json, with the report's full path; status "done" or "interrupted"
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json inspect_parts(const InspectOptions& options);

}  // namespace glint
