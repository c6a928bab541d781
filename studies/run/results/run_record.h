// SPDX-License-Identifier: GPL-3.0-or-later
//
// What run.json tells of a run: program, machine, times, warnings.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/search/search.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// CPU seconds of a run, of all threads together.
struct RunCpu {
  double search_s = 0.0;
  double finish_s = 0.0;  ///< all that follows the search, a race of its finalists first
  double rescoring_s = 0.0;
  double populations_s = 0.0;
  double manufacture_s = 0.0;
  double front_s = 0.0;  ///< part of finish_s
};

struct RunRecord {
  const Study& study;
  const std::filesystem::path& out;  ///< the run's folder
  const SearchResult& search;        ///< as it is before any, where the study has none
  const SceneStore& store;
  int threads = 1;
  int jobs = 1;
  std::chrono::system_clock::time_point started;
  double seconds = 0.0;  ///< since then
  RunCpu cpu = {};
  bool has_front = false;
  std::optional<double> accuracy_cpu_s = {};  ///< of studies with [accuracy]
  std::vector<std::string> derivatives = {};  ///< derivative_remarks()
};

/// The object of run.json.
nlohmann::ordered_json run_record_json(const RunRecord& record);

}  // namespace glint
