// SPDX-License-Identifier: GPL-3.0-or-later
//
// Results that appear in their folder together, with the run.json that tells whose they are.
#pragma once

#include <chrono>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "studies/output/output_folder.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {

/// Ask check_result_folder() and check_inputs_kept() before.
class ResultWriter {
 public:
  /// @throws IoError
  ResultWriter(const std::filesystem::path& out, ResultKind kind);

  /// Where the files are written.
  const std::filesystem::path& path() const { return stage_.path(); }

  /// Writes run.json (provenance, the verb, the time since `start`, what is given) and moves all
  /// files to their folder. Without it nothing is left behind. @throws IoError
  void finish(const nlohmann::ordered_json& given, std::chrono::steady_clock::time_point start);

 private:
  ResultKind kind_;
  OutputFolder folder_;
  StagedFolder stage_;
};

}  // namespace glint
