// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs as they will be built: moved within the tolerances of [manufacture], evaluated as a
// search would with the noise of the search, and kept, so that none is evaluated twice.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "optimizer/robust/robust_optimum.h"
#include "optimizer/storage/storage.h"
#include "studies/definition/ladder/branch_split.h"
#include "studies/definition/manufacture.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// Designs that are built of each one.
inline constexpr int kToleranceDesigns = 64;
/// The one that is built exactly.
inline constexpr int kExact = -1;
/// Evaluations after a search, at most: built ones of the winner and of all candidates, and two
/// exact ones.
inline constexpr int kMaxBuiltDesigns = kToleranceDesigns * (1 + kRobustCandidates) + 2;
/// In the folder of a run: a database of trials as study.sqlite, whose points are the variables of
/// the design and then what building adds to each key of [manufacture].
inline constexpr const char* kBuiltTrials = "manufacture.sqlite";

class BuiltDesigns {
 public:
  /// @param rungs      what the search was rendered by; empty: as the study's file says
  /// @param jobs       built designs at once, >= 1
  /// @param interrupt  nullptr, or how often the user interrupted
  /// @throws IoError
  BuiltDesigns(SceneStore& store,
               const Study& study,
               const StudyIdentity& identity,
               const std::filesystem::path& run,
               std::optional<SearchRungs> rungs = {},
               int jobs = 1,
               const std::atomic<int>* interrupt = nullptr);

  /// See BuildDesigns. @param first  kExact with a count of 1, or from 0 on
  std::vector<BuiltScores> build(const std::vector<Point>& designs, int first, int count);

  const std::vector<Tolerance>& tolerances() const { return tolerances_; }

  /// What building adds to the variables (RobustTask::offsets).
  std::vector<Point> variable_offsets() const;

 private:
  /// To each key with a tolerance, evenly within it; whole numbers to integers.
  std::vector<double> added(int built) const;
  void ask(const std::vector<Point>& points);
  void evaluate_all(const std::vector<Point>& points);
  Outcome outcome_of(const Point& point) const;
  std::optional<Scores> scores_of(const Point& point) const;

  SceneStore& store_;
  const Study& study_;
  std::optional<SearchRungs> rungs_;
  int jobs_;
  const std::atomic<int>* interrupt_;
  std::vector<Tolerance> tolerances_;
  Storage storage_;
  std::map<Point, Trial> known_;
};

}  // namespace glint
