// SPDX-License-Identifier: GPL-3.0-or-later
//
// From named scores to the one finite number an algorithm minimises.
//
// merit = objective (negated when maximised) + scale * sum of weight * log(1 + violation), where a
// violation is how far a score is outside its limit, as a part of the limit. The logarithm has
// derivative 1 at the limit, so the border is as steep as without it, while designs far outside do
// not drown the model of a local method. With several objectives their place is taken by the mean
// of each one's value in parts of its own spread, and the scale is kPenaltyFactor; only the choice
// of the designs that a large model keeps depends on it.
//
// The scale is kPenaltyFactor times the spread (largest minus smallest objective) of the first
// evaluations told, as many as the initial design has; then it stays. It depends on nothing but
// told outcomes in their order, so a replay finds the same one. See docs/theory/search.md.
//
// Gradient methods are told objective and limits apart, with their derivatives by the unit
// coordinates, wherever an outcome holds derivatives.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "optimizer/algorithm/algorithm.h"
#include "optimizer/algorithm/answer.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"

namespace glint {

/// Why these scores cannot be judged (a missing score, a NaN, an infinite objective); empty when
/// they can.
std::string problem_with(const Goal& goal, const Scores& scores);

/// Why a gradient method cannot go on from this judgeable outcome: no derivative of the objective,
/// or of a score outside its limits, by a variable that is continuous and active at this point.
/// Empty when it can.
std::string problem_with_gradients(const SearchSpace& space,
                                   const Goal& goal,
                                   const Point& point,
                                   const Outcome& outcome);

/// Why a method that takes derivatives where they are known learns nothing from those of this
/// judgeable outcome: none of the goal's scores has one by a variable that is continuous and active
/// at this point. Empty when one has, and where there is no such variable.
std::string problem_without_derivatives(const SearchSpace& space,
                                        const Goal& goal,
                                        const Point& point,
                                        const Outcome& outcome);

/// Limits of all constraints: a min and a max count apart.
int num_limits(const Goal& goal);

/// What algorithms are told of a score's limits, first of min, then of max: (excess beyond the
/// limit) / |limit| + MeritFunction::kLimitMargin, at most 1e6 in size; NaN of NaN.
std::vector<double> limit_values(const Constraint& constraint, double score);

/// The score that limit_values() makes of this value of its entry `limit`, which is within the size
/// of 1e6.
double score_at_limit(const Constraint& constraint, std::size_t limit, double value);

/// How far a score is outside its limits, as a part of the limit (of 1 where the limit is 0);
/// 0 inside, at most 1e6.
double violation(const Constraint& constraint, double score);
/// The weighted sum over all constraints; 0 exactly when feasible.
double violation(const Goal& goal, const Scores& scores);
bool is_feasible(const Goal& goal, const Scores& scores);

/// All objectives, smaller is better: those of maximised scores are negated.
std::vector<double> minimised_objectives(const Goal& goal, const Scores& scores);

/// A feasible outcome beats an infeasible one; two feasible ones compare by objective (of several
/// by dominance: nowhere worse and somewhere better), two infeasible ones by violation. Equal:
/// false. Both must be judgeable.
bool is_better(const Goal& goal, const Scores& a, const Scores& b);

/// Half the width of the objective's interval: half of "<objective>.high" - "<objective>.low",
/// where both are among the scores and finite, and twice "<objective>.error", the standard error of
/// path-traced scores; root of the sum of squares where there are both, 0 where there is neither.
/// An objective that is itself a bound has the interval of its score.
double objective_noise(const Objective& objective, const Scores& scores);

/// Half the width of the interval of the difference of two objectives, as if their noise were
/// independent: sqrt(noise_a^2 + noise_b^2). Designs that share their random numbers differ by less
/// noise, so what is beyond it is beyond noise in any case.
double difference_noise(const Objective& objective, const Scores& a, const Scores& b);

/// is_better(), and of two feasible designs by more than the noise of their difference; of several
/// objectives: some one leads by more than its noise. The same as is_better() for one objective's
/// scores without intervals.
bool is_surely_better(const Goal& goal, const Scores& a, const Scores& b);

/// Keeps what has been told and turns the next outcome into a finite merit.
class MeritFunction {
 public:
  static constexpr double kPenaltyFactor = 3.0;
  /// Told for failures before anything has succeeded.
  static constexpr double kUnknownMerit = 1e6;
  /// How far inside a limit (as a part of it) methods that are told limits should end: they stop
  /// within rounding of their border, on either side of it.
  static constexpr double kLimitMargin = 1e-6;

  /// @param num_scale  outcomes that fix the penalty's scale, >= 1
  /// @param holds_unknown  a limit whose derivatives are not known, beside others that are, is told
  ///                       as constant and kept, as methods need it that stand on derivatives
  /// @param takes_intervals  a score without a standard error has half of objective_noise()
  MeritFunction(SearchSpace space,
                Goal goal,
                FailurePolicy policy,
                int num_scale,
                bool holds_unknown = true,
                bool takes_intervals = true);

  /// What to tell of the next outcome in the order of telling. Its limits are, for each constraint,
  /// first of min, then of max: (excess beyond the limit) / |limit| + kLimitMargin, with the
  /// score's standard error in the same unit.
  Answer next(const Point& point, const Outcome& outcome);

  double penalty_scale() const;

 private:
  struct Told {
    std::vector<double> unit;
    double merit = 0.0;
  };

  void widen_spread(const std::vector<double>& objectives);
  double spread(std::size_t objective) const;
  /// What the penalty is added to. @param objectives  of the goal, minimised
  double combined(const std::vector<double>& objectives) const;
  /// NaN where it is not known.
  double standard_error(const Scores& scores, const std::string& name) const;
  /// Of all objectives; empty where none is known.
  std::vector<double> standard_errors(const Scores& scores) const;
  void add_limits(const Point& point, const Outcome& outcome, Answer& answer) const;
  double failed_merit(const std::vector<double>& unit) const;

  SearchSpace space_;
  Goal goal_;
  FailurePolicy policy_;
  int num_scale_;
  bool holds_unknown_;
  bool takes_intervals_;
  int num_told_ = 0;
  std::vector<double> smallest_;  ///< one per objective; empty: none was told
  std::vector<double> largest_;
  std::vector<Told> told_;  ///< successes only
};

}  // namespace glint
