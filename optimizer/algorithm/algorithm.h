// SPDX-License-Identifier: GPL-3.0-or-later
//
// Search algorithms behind ask and tell. All of them are deterministic: the same seed and the same
// told values give the same questions, bit for bit. That is what resuming by replay stands on.
//
// sobol, random   even or random sampling of the whole space
// direct_l        divides the box; best for one or two variables and under strong noise
// gp              Gaussian process; best under noise and for several objectives, where an
//                 evaluation costs more than some milliseconds
// cmaes           evolution strategy that learns a covariance; for noise and budgets of thousands
// nsga2, nspso    populations for several objectives; for budgets of thousands
// crs2, isres     populations; for budgets of thousands of evaluations
// mlsl            quasi-random starts, each followed by BOBYQA
// bobyqa          quadratic model, restarted; best when scores are smooth and free of noise
// cobyla          linear model, restarted; the local method that noise disturbs least
// sbplx           simplex, restarted; for kinks and steps
// slsqp           quadratic model with exact derivatives and limits, restarted
// mma             separable convex models with exact derivatives and limits, restarted; for dozens
// of
//                 variables
// lbfgs           quasi-Newton with exact derivatives, restarted; for goals without limits, which
// it
//                 can keep to at the cost of more evaluations
// auto            several objectives or noisy: gp; 1 or 2 float variables: direct_l; else bobyqa
//
// Why `auto` chooses so (four 6-D to 12-D test functions, multi-start): without noise BOBYQA leaves
// the smallest gap to the optimum at 300 and 1000 evaluations (7 and 4 %); at 5 and 20 % noise the
// Gaussian process does (`script/bench search`). Glint scores neighbouring
// designs with the same random numbers, so scores are smooth unless a study says otherwise. BOBYQA
// and COBYLA start from the best of a Sobol design, which keeps them from being worse than random
// sampling where the budget is small.
//
// NLopt's methods know only continuous variables. In a space with choices or integers a Sobol
// design over all variables comes first; then they search the continuous ones at the best designs
// found, and restarts try the neighbouring choices and integers.
//
// slsqp, mma and lbfgs need derivatives (needs_gradient()). They are told objective and limits
// apart, not the merit with its penalties, which has kinks at the limits.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "optimizer/algorithm/answer.h"
#include "optimizer/algorithm/exact_values.h"
#include "optimizer/problem/space.h"
#include "optimizer/problem/trial.h"

namespace glint {

/// How methods choose and search. A run keeps the rules that it began with: they stand in its log.
/// 1: under noise `auto` is cobyla; gp asks by ParEGO weights where there are several objectives.
/// 2: under noise `auto` is gp; gp asks by the expected gain of hypervolume, climbs the derivatives
/// of
///    what it promises, and logs the parameters of its models.
/// 3: gp knows scores that follow from a design alone, and takes derivatives.
/// 4: gp models the signed logarithm of limits.
/// 5: gp knows the standard errors of limits; a start point that is given twice is asked once.
/// 6: of each kind of light a design is among the finalists; of several objectives a gain of
///    hypervolume is one that is larger than its noise; a target is reached where gp expects so;
///    gp knows the intervals of scores that have no standard error, and of many designs keeps the
///    front.
/// 7: under noise the front of several objectives, and what is chosen of it, is of expected values;
///    gp is asked whether it expects the target only where that may be new.
/// 8: under noise limits are judged by how probably they hold, by what gp expects and in the race
///    by replicates; a target that is another than before is looked at at once.
inline constexpr int kSearchRules = 8;

/// Repeated points in a row after which a space counts as fully sampled.
inline constexpr int kMaxRepeats = 5000;

struct SearchSettings {
  std::string algorithm = "auto";  ///< one of algorithm_names()
  std::uint64_t seed = 1;
  int batch = 1;             ///< >= 1: designs asked before the first of them is told
  bool is_noisy = false;     ///< scores of one design vary from evaluation to evaluation
  bool derivatives = false;  ///< gp takes them as observations; of one objective
  int design = 0;            ///< size of the Sobol design; 0: see design_size()
  double tolerance = 1e-4;   ///< > 0: local searches end below this part of a variable's range
  double watchdog_s = 10.0;  ///< > 0: a method that does not ask within this is abandoned
  int rules = kSearchRules;  ///< 1 to kSearchRules
};

/// What a failed evaluation is told as, so that the method goes on sensibly.
enum class FailurePolicy {
  kNearest,  ///< the nearest evaluated design's merit: for methods that fit a model
  kWorst     ///< the worst merit so far: for all others
};

/// Asked for points, told merits (smaller is better) in the same order. With a batch of b the
/// caller asks up to b points before it tells them.
class Algorithm {
 public:
  Algorithm() = default;
  virtual ~Algorithm() = default;
  Algorithm(const Algorithm&) = delete;
  Algorithm& operator=(const Algorithm&) = delete;

  /// The next point, canonical in the space; may be one it asked before. Empty: every design of a
  /// finite space has been asked.
  virtual std::optional<Point> ask() = 0;
  /// What is known of the oldest point not told yet; derivatives by unit coordinate, one per
  /// variable of the space, when needs_gradient() and not failed. A failed one never counts as
  /// best.
  virtual void tell(const Point& point, const Answer& answer) = 0;

  /// The same without gradient.
  void tell(const Point& point, double merit, bool is_failed) {
    tell(point, Answer{.merit = merit, .is_failed = is_failed, .objective = {.value = merit}});
  }

  /// Replay only: the run of this number was abandoned within the next ask().
  virtual void abandon_run(int /*run*/) {}

  /// Whether asks can be repeated without computing them: the state follows from asked points,
  /// told answers and kModel events.
  virtual bool can_restore() const { return false; }

  /// Replay only, and only when can_restore(): stands for an ask() that gave this point.
  virtual void restore_ask(const Point& /*point*/) {}

  /// Replay only, the same: what the kModel event before the next ask held.
  virtual void restore_model(std::span<const double> /*parameters*/) {}

  /// What the objectives are expected to be without noise at each told point, in the order of
  /// telling; an empty row where it failed. Empty: there is no model.
  virtual std::vector<std::vector<Expectation>> expected_objectives() { return {}; }

  /// The same of the limits, in the order of Answer::limits and as models know them: log_limit() of
  /// them (by rules 4).
  virtual std::vector<std::vector<Expectation>> expected_limits() { return {}; }

  /// Restarts, abandoned runs, models and remarks since the last call, in order.
  std::vector<Event> take_events();

 protected:
  void add_event(EventKind kind, int run, std::string text);
  void add_model_event(std::vector<double> parameters);

 private:
  std::vector<Event> events_;
};

std::span<const std::string_view> algorithm_names();

/// Whether a method stands on derivatives: slsqp, mma, lbfgs.
bool needs_gradient(std::string_view algorithm);

/// Whether a method takes several objectives: auto, gp, nsga2, nspso, sobol, random.
bool takes_several_objectives(std::string_view algorithm);
/// Whether it needs them: nsga2, nspso.
bool needs_several_objectives(std::string_view algorithm);

/// max(8, 2 d + 2) for d variables, 3 with derivatives; with choices or integers also four per
/// combination of their values, up to 64. Rounded up to whole batches.
int design_size(const SearchSpace& space, const SearchSettings& settings);

/// The name that `auto` stands for in this space; other names stand for themselves.
/// With several objectives `auto` is gp.
std::string resolved_algorithm(const SearchSpace& space,
                               const SearchSettings& settings,
                               int num_objectives = 1);

FailurePolicy failure_policy(const SearchSpace& space,
                             const SearchSettings& settings,
                             int num_objectives = 1);

/// @param start_points  asked first, in order, made canonical
/// @param num_limits      limits in every answer: num_limits(goal)
/// @param num_objectives  objectives in every answer, >= 1; more than one only for methods that
///                        take them: gp, nsga2, nspso, sobol, random
/// @param reference       of several objectives: the worst values of interest, NaN where not
///                        given; smaller is better; empty: none is given
/// @param exact           what of it follows from a design alone; gp makes use of it from rules 3
/// on
/// @throws ConfigError for a wrong space, an unknown name, settings out of range, or a float with a
///                     step when the algorithm needs derivatives
std::unique_ptr<Algorithm> make_algorithm(const SearchSpace& space,
                                          const SearchSettings& settings,
                                          std::vector<Point> start_points,
                                          int num_limits = 0,
                                          int num_objectives = 1,
                                          std::vector<double> reference = {},
                                          ExactValues exact = {});

}  // namespace glint
