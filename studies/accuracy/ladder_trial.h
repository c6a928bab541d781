// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ladder of render settings tried on some designs before a search, and the rung that it gives.
// Who evaluates is the caller's affair: the choice follows from scores and counted work alone.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "metrics/scores.h"
#include "metrics/statistics/rank_agreement.h"
#include "optimizer/problem/goal.h"
#include "studies/definition/accuracy_settings.h"

namespace glint {

/// With fewer nothing can be judged.
inline constexpr std::size_t kMinDesigns = 3;

/// A way to render, as far as a choice needs to know it.
struct LadderStep {
  std::string name;
  double work = 0.0;          ///< of one evaluation, > 0
  int group = 0;              ///< steps of a group differ in their noise alone
  bool is_for_search = true;  ///< false: only compared with
  /// Within a group: samples or rays a pixel, or the inverse square of a direction error; 0: not
  /// known.
  double fineness = 0.0;
  bool is_noisy = false;  ///< its errors are noise, which falls as 1 / sqrt(fineness)
  /// Its scores are told less their mean errors against the top over the designs (half resolution).
  bool is_corrected = false;
};

struct LadderTask {
  std::vector<LadderStep> steps;    ///< by rising work; the last is the top
  std::size_t num_designs = 12;     ///< that are wanted
  std::size_t num_candidates = 48;  ///< that there are: the next takes the place of one that fails
  AccuracySettings wish;
  Goal goal;
  /// With "auto" the designs are ranked beside those of other ladders, by who calls: the cheapest
  /// step that renders all of them is taken.
  bool is_judged_jointly = false;
};

/// The scores of these candidates at a step, in their order; empty where one cannot be evaluated.
/// All steps and candidates have the same random numbers.
using EvaluateStep = std::function<std::vector<std::optional<Scores>>(
    std::size_t step, std::span<const std::size_t> candidates)>;

/// How far a score is from the truth, as far as the top, its noise and what noise does to it tell.
struct ScoreBound {
  std::string score;
  double tolerance = 0.0;  ///< in the score's own unit; 0: none is asked for
  double bias = 0.0;       ///< against the top, over the designs
  double spread = 0.0;     ///< the same: standard deviation
  double top_error = 0.0;  ///< the top's own standard error, the mean of the designs'; 0: has none
  /// The top's own bias at most. Noise makes h lower and contrast smaller: what the top would lose
  /// if the difference to a coarser step below it went on by the root of the samples. Without noise
  /// that difference itself.
  double top_bias = 0.0;
  double top_spread = 0.0;  ///< of that over the designs, beyond top_error
  double factor = 0.0;      ///< k of prediction_factor()
  /// Of the absolute error of one more design at the confidence: k hypot(spread, top_error,
  /// top_spread) and the larger of abs(bias) and abs(bias + top_bias).
  double bound = 0.0;
  /// The same with the factor of error_bound(): of that share of all designs, with the same
  /// confidence. What was not checked is within this one.
  double wide_bound = 0.0;
};

/// The bound for one design: the wider one where its own standard error is larger than those that
/// the trial has seen. @param scores  of the design, at the step
double bound_of(const ScoreBound& bound, const Scores& scores);

/// How a step orders the designs by one objective.
struct OrderOf {
  std::string objective;
  RankAgreement agreement;
};

struct StepReport {
  bool is_tried = false;
  bool serves = false;
  std::string skipped;             ///< why it was not tried
  std::vector<ScoreBound> bounds;  ///< of the scores wished for, else of objectives and limits
  std::vector<OrderOf> orders;     ///< of each objective
  Scores offsets;                  ///< of a corrected step: the mean errors that were taken out
};

struct LadderChoice {
  std::size_t step = 0;  ///< what the search is to use
  /// What the search is checked with while it goes on: the cheapest dearer step of the top's group;
  /// beside a corrected step one that is at least as fine, whose errors are then known, too. Empty:
  /// step is the top.
  std::optional<std::size_t> second;
  bool is_reached = false;           ///< it serves; else the dearest that a search may use is taken
  std::string problem;               ///< why nothing could be judged; empty: it could
  std::vector<std::size_t> designs;  ///< candidates that could be evaluated at the top
  std::size_t num_failed = 0;        ///< candidates that could not
  std::size_t num_alike = 0;  ///< candidates that all steps render alike: they were not compared
  std::vector<StepReport> steps;
  std::vector<Scores> scores;      ///< of the designs at the step; empty where it renders not all
  std::vector<Scores> top_scores;  ///< of the designs at the top
  std::vector<std::string> unreached;  ///< for each score the bound that is to be had
  double work = 0.0;                   ///< of all evaluations together
};

/// Evaluates the top and the dearest step of its group that is at most half as fine; then the steps
/// from the cheapest on until one serves.
///
/// With tolerances a step serves when the bound of each score is within it, the top too. With
/// "auto" it serves when it ranks the designs by what the search minimises as the top does
/// (is_ranking_right()): one objective with the penalty of its limits, each of several objectives.
/// Steps of a group whose cheapest differs beyond that from the last group's cheapest are left out:
/// more samples do not mend what is missing.
/// @param evaluate  what it throws ends the trial
LadderChoice try_ladder(const LadderTask& task, const EvaluateStep& evaluate);

}  // namespace glint
