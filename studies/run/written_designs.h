// SPDX-License-Identifier: GPL-3.0-or-later
//
// The designs that a run writes in full, one after the other: their folders, scores with fresh
// seeds and in repeated scans, and how far the writing is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"
#include "studies/run/design_files.h"

namespace glint {

/// What all of them are written with.
struct WritingTask {
  SceneStore& store;
  const Study& study;
  const std::filesystem::path& out;    ///< folder of the run
  FreshOutcomes& fresh;                ///< gets what is scored again
  const nlohmann::ordered_json& race;  ///< race_finalists(), which judges limits; null: none
  int front_designs = 0;               ///< full_designs_of_front(), beside the others
  bool is_repeated = true;             ///< scored in repeated scans, too
};

class DesignWriter {
 public:
  DesignWriter(const WritingTask& task, Progress::Style progress);

  /// Writes a design into the folder `key` of the run and scores it again.
  /// @param head         of write_design(); its trial, where it has one, keeps what is scored again
  /// @param is_repeated  false: not in repeated scans
  /// @return the object of its scores.json
  /// @throws ConfigError with the place in the study's file; IoError
  nlohmann::ordered_json write(const std::string& key,
                               const SceneSettings& scene,
                               const nlohmann::ordered_json& head,
                               bool is_repeated = true);

  /// CPU seconds that scoring again has taken.
  double rescoring_cpu_s() const { return rescoring_cpu_s_; }

 private:
  DesignWatch watch_of(const std::string& key, const SceneSettings& scene);
  std::int64_t num_steps() const;
  void add_repeated(const SceneSettings& scene, int trial, nlohmann::ordered_json& design);

  WritingTask task_;
  Progress progress_;
  int num_written_ = 0;
  double rescoring_cpu_s_ = 0.0;
};

}  // namespace glint
