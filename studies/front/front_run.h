// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run does for its front once the search is over: pictures, and scores with fresh seeds, so
// that no number on the page is one that the search has picked for its noise.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"
#include "studies/front/front_files.h"
#include "studies/imaging/scene_store.h"

namespace glint {

struct FrontTask {
  const Study& study;  ///< with several objectives
  SceneStore& store;
  const Storage& storage;
  std::filesystem::path out;
  WantedScores wanted;  ///< of a candidate of the search
  /// Writes a design into the folder `key` of the run and scores it again, as a winner.
  /// @param is_repeated  scanned with other noise too, for want of standard errors of its own
  std::function<nlohmann::ordered_json(const std::string& key,
                                       const SceneSettings& scene,
                                       const nlohmann::ordered_json& head,
                                       bool is_repeated)>
      write = {};
  DrawLighting drawing = {};
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// What result.json tells of a search with several objectives: objectives, front, hypervolume,
/// reference, chosen; where the database alone does not tell it front_expected or front_likely,
/// kOfExpected of it. @param front  front_json(); null: there is one objective
void add_front_to_result(const nlohmann::ordered_json& front, nlohmann::ordered_json& result);

/// Writes the folders of the front's designs and adds to them, in `front` and in `result`, what
/// add_rescored() and judge_front() find (studies/front/front_designs.h). The chosen design has its
/// folder already. `probability_best` of both is that of add_probability_best(), prototypes
/// included. `front_rescored` of the result is that of judge_front() with `evaluations`: how many
/// the fresh scores took, which are not of the search's budget. Interrupted, `status` is so.
/// @param winner  the object of its scores.json
/// @param front   front_json()
/// @throws IoError, ConfigError
void write_front(const FrontTask& task,
                 const nlohmann::ordered_json& winner,
                 nlohmann::ordered_json& front,
                 nlohmann::ordered_json& result);

/// How many designs it writes in full, at most, beside the chosen one.
int full_designs_of_front(const nlohmann::ordered_json& front);

}  // namespace glint
