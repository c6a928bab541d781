// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/ladder_trial.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/error.h"
#include "metrics/statistics/error_bound.h"
#include "optimizer/algorithm/merit.h"
#include "studies/accuracy/search_figures.h"
#include "studies/accuracy/unreached.h"

namespace glint {
namespace {

std::vector<std::string> names_of_goal(const Goal& goal) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) {
      names.push_back(name);
    }
  };
  for (const Objective& objective : objectives_of(goal)) {
    add(objective.name);
  }
  for (const Constraint& constraint : goal.constraints) {
    add(constraint.name);
  }
  return names;
}

std::vector<double> values_of(const std::string& score, std::span<const Scores> designs) {
  std::vector<double> values(designs.size());
  std::ranges::transform(
      designs, values.begin(), [&](const Scores& scores) { return scores.at(score); });
  return values;
}

double mean_absolute(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += std::abs(value);
  }
  return sum / static_cast<double>(values.size());
}

/// How far the top itself may be off, over the designs.
struct TopOffset {
  double mean = 0.0;
  double spread = 0.0;
};

/// The trial as it goes on.
class LadderTrial {
 public:
  LadderTrial(const LadderTask& task, const EvaluateStep& evaluate)
      : task_(task), evaluate_(evaluate), scores_(task.steps.size()), offsets_(task.steps.size()) {
    choice_.steps.resize(task.steps.size());
    judged_ = names_of_goal(task.goal);
    if (!task.wish.is_auto) {
      judged_.clear();
      std::ranges::transform(task.wish.wishes, std::back_inserter(judged_), &ScoreWish::score);
    }
  }

  LadderChoice run() {
    choice_.step = dearest_for_search();
    evaluate_top();
    if (choice_.designs.size() < kMinDesigns) {
      choice_.problem = fmt::format("{} of {} designs can be evaluated by \"{}\", {} are needed",
                                    choice_.designs.size(),
                                    choice_.designs.size() + choice_.num_failed,
                                    task_.steps.back().name,
                                    kMinDesigns);
      return choice_;
    }
    evaluate_below_top();
    if (!below_top_ && task_.steps[top()].is_noisy && task_.steps[top()].fineness > 0.0) {
      choice_.problem = fmt::format(
          "how far \"{}\" itself is off cannot be estimated: no setting of its kind with at most "
          "half "
          "its samples renders every design",
          task_.steps[top()].name);
      return choice_;
    }
    leave_out_groups();
    climb();
    find_second();
    choice_.scores = scores_[choice_.step];
    choice_.top_scores = scores_[top()];
    if (!choice_.is_reached) {
      choice_.unreached = unreached_texts(task_, choice_, task_.wish.is_auto && ranks_nothing());
    }
    return choice_;
  }

 private:
  std::size_t top() const { return task_.steps.size() - 1; }

  /// Of the top's kind, which renders whatever the top does; any other where it has none.
  std::size_t dearest_for_search() const {
    const auto dearest = [&](auto is_wanted) {
      std::size_t step = task_.steps.size();
      while (step > 0 && !is_wanted(task_.steps[step - 1])) {
        --step;
      }
      return step;
    };
    const auto is_for_search = [](const LadderStep& step) { return step.is_for_search; };
    const std::size_t of_kind = dearest([&](const LadderStep& step) {
      return step.is_for_search && step.is_noisy == task_.steps[top()].is_noisy;
    });
    return std::max<std::size_t>(1, of_kind > 0 ? of_kind : dearest(is_for_search)) - 1;
  }

  /// Whether the scores hold everything that is judged.
  bool is_whole(const std::optional<Scores>& scores) const {
    return scores && problem_with(task_.goal, *scores).empty() &&
           std::ranges::all_of(judged_, [&](const std::string& name) {
             const auto found = scores->find(name);
             return found != scores->end() && std::isfinite(found->second);
           });
  }

  std::vector<std::optional<Scores>> scores_at(std::size_t step,
                                               std::span<const std::size_t> candidates) {
    choice_.work += task_.steps[step].work * static_cast<double>(candidates.size());
    std::vector<std::optional<Scores>> found = evaluate_(step, candidates);
    GLINT_CHECK(found.size() == candidates.size(), "scores of each candidate");
    return found;
  }

  /// As many designs as are wanted, of the first candidates that can be evaluated.
  void evaluate_top() {
    std::size_t next = 0;
    while (choice_.designs.size() < task_.num_designs && next < task_.num_candidates) {
      const std::size_t count =
          std::min(task_.num_designs - choice_.designs.size(), task_.num_candidates - next);
      std::vector<std::size_t> candidates(count);
      std::iota(candidates.begin(), candidates.end(), next);
      next += count;
      const auto found = scores_at(top(), candidates);
      for (std::size_t i = 0; i < count; ++i) {
        if (is_whole(found[i])) {
          choice_.designs.push_back(candidates[i]);
          scores_[top()].push_back(*found[i]);
        } else {
          ++choice_.num_failed;
        }
      }
    }
    choice_.steps[top()].is_tried = true;
  }

  /// @return whether the step has scores of every design
  bool evaluate_step(std::size_t step) {
    if (!choice_.steps[step].is_tried) {
      choice_.steps[step].is_tried = true;
      const auto found = scores_at(step, choice_.designs);
      if (std::ranges::all_of(found, [&](const auto& scores) { return is_whole(scores); })) {
        for (const std::optional<Scores>& scores : found) {
          scores_[step].push_back(*scores);
        }
        if (task_.steps[step].is_corrected) {
          correct(step);
        }
      }
    }
    return !scores_[step].empty();
  }

  /// A control variate of coefficient 1: what the step's scores are off by on average is known from
  /// the top's, and the bound is that of what is left.
  void correct(std::size_t step) {
    std::vector<std::string> names = names_of_goal(task_.goal);
    names.insert(names.end(), judged_.begin(), judged_.end());
    for (const std::string& name : names) {
      double sum = 0.0;
      for (std::size_t i = 0; i < scores_[step].size(); ++i) {
        sum += scores_[step][i].at(name) - scores_[top()][i].at(name);
      }
      offsets_[step][name] = sum / static_cast<double>(scores_[step].size());
    }
    for (Scores& scores : scores_[step]) {
      for (const auto& [name, offset] : offsets_[step]) {
        scores.at(name) -= offset;
      }
    }
  }

  /// The dearest step that is at most half as fine as the top, of its group, and renders all
  /// designs.
  void evaluate_below_top() {
    for (std::size_t step = top(); step-- > 0;) {
      const LadderStep& below = task_.steps[step];
      if (below.group == task_.steps[top()].group && below.fineness > 0.0 &&
          below.fineness <= 0.5 * task_.steps[top()].fineness) {
        if (evaluate_step(step)) {
          below_top_ = step;
          return;
        }
      }
    }
  }

  /// From n to N samples a score that noise of a standard deviation of 1 / sqrt(n) makes wrong
  /// loses the difference; from N on it would lose sqrt(n) / (sqrt(N) - sqrt(n)) of it once more.
  /// Biases that fall faster, as 1 / n, lose less.
  TopOffset top_offset(const std::string& score) const {
    if (!below_top_) {
      return {};
    }
    const LadderStep& dearest = task_.steps[top()];
    const double root = std::sqrt(task_.steps[*below_top_].fineness);
    const double factor = dearest.is_noisy ? root / (std::sqrt(dearest.fineness) - root) : 1.0;
    const std::vector<double> below = values_of(score, scores_[*below_top_]);
    const std::vector<double> dear = values_of(score, scores_[top()]);
    std::vector<double> steps(below.size());
    std::ranges::transform(below, dear, steps.begin(), std::minus<>());
    const ErrorBound seen = error_bound(steps, task_.wish.confidence, task_.wish.confidence);
    const double noise = mean_error(score, scores_[top()]);
    const double rest = seen.spread * seen.spread - noise * noise;
    return {.mean = factor * seen.bias, .spread = factor * std::sqrt(std::max(0.0, rest))};
  }

  /// @param factor  of a tolerance interval
  static ScoreBound with_bounds(ScoreBound bound, double factor) {
    const double bias = std::max(std::abs(bound.bias), std::abs(bound.bias + bound.top_bias));
    const double spread = std::hypot(bound.spread, bound.top_error, bound.top_spread);
    bound.bound = bias + bound.factor * spread;
    bound.wide_bound = bias + factor * spread;
    return bound;
  }

  std::vector<ScoreBound> bounds_against(std::size_t step, std::size_t reference) const {
    const double confidence = task_.wish.confidence;
    std::vector<ScoreBound> bounds;
    for (std::size_t i = 0; i < judged_.size(); ++i) {
      const std::vector<double> mine = values_of(judged_[i], scores_[step]);
      const std::vector<double> others = values_of(judged_[i], scores_[reference]);
      std::vector<double> errors(mine.size());
      std::ranges::transform(mine, others, errors.begin(), std::minus<>());
      const ErrorBound seen = error_bound(errors, confidence, confidence);
      // Two steps of as many samples share their noise; the top's is its own.
      const double top_error =
          reference == top() ? mean_error(judged_[i], scores_[reference]) : 0.0;
      const TopOffset offset = reference == top() ? top_offset(judged_[i]) : TopOffset{};
      const ScoreBound bound = {.score = judged_[i],
                                .tolerance = tolerance_of(i, others),
                                .bias = seen.bias,
                                .spread = seen.spread,
                                .top_error = top_error,
                                .top_bias = offset.mean,
                                .top_spread = offset.spread,
                                .factor = prediction_factor(errors.size(), confidence)};
      bounds.push_back(with_bounds(bound, tolerance_factor(errors.size(), confidence, confidence)));
    }
    return bounds;
  }

  double tolerance_of(std::size_t judged, std::span<const double> reference) const {
    if (task_.wish.is_auto) {
      return 0.0;
    }
    const ScoreWish& wish = task_.wish.wishes[judged];
    return wish.is_relative ? wish.tolerance * mean_absolute(reference) : wish.tolerance;
  }

  static double mean_error(const std::string& score, std::span<const Scores> designs) {
    double sum = 0.0;
    for (const Scores& scores : designs) {
      const auto found = scores.find(error_name(score));
      sum += found != scores.end() && std::isfinite(found->second) ? found->second : 0.0;
    }
    return sum / static_cast<double>(designs.size());
  }

  std::vector<OrderOf> orders_against(std::size_t step, std::size_t reference) const {
    const std::vector<Objective> objectives = objectives_of(task_.goal);
    const auto mine = search_figures(task_.goal, scores_[step]);
    const auto others = search_figures(task_.goal, scores_[reference]);
    const auto errors = search_figure_errors(task_.goal, scores_[reference]);
    std::vector<OrderOf> orders;
    for (std::size_t k = 0; k < objectives.size(); ++k) {
      orders.push_back({objectives[k].name, rank_agreement(mine[k], others[k], errors[k])});
    }
    return orders;
  }

  /// Designs that the top cannot tell apart show nothing; those of few samples do not count against
  /// a step either.
  bool is_right(const RankAgreement& agreement, std::size_t reference) const {
    return is_ranking_right(agreement) || (reference != top() && agreement.pairs == 0);
  }

  /// What is known of a step beside another one, and whether that is enough.
  StepReport compared(std::size_t step, std::size_t reference) const {
    StepReport report = {.is_tried = true};
    if (scores_[step].empty() || scores_[reference].empty()) {
      return report;
    }
    report.bounds = bounds_against(step, reference);
    report.orders = orders_against(step, reference);
    report.serves = task_.wish.is_auto
                        ? step == reference || (task_.is_judged_jointly && reference == top()) ||
                              std::ranges::all_of(report.orders,
                                                  [&](const OrderOf& order) {
                                                    return is_right(order.agreement, reference);
                                                  })
                        : std::ranges::all_of(report.bounds, [](const ScoreBound& bound) {
                            return bound.bound <= bound.tolerance;
                          });
    return report;
  }

  std::size_t first_of(int group) const {
    return static_cast<std::size_t>(std::ranges::find(task_.steps, group, &LadderStep::group) -
                                    task_.steps.begin());
  }

  /// Steps without noise, and corrected ones, are compared with the top alone: against few samples
  /// they would be blamed for the noise of these.
  void leave_out_groups() {
    const int last = task_.steps.back().group;
    const std::size_t reference = first_of(last);
    std::vector<int> groups;
    for (const LadderStep& step : task_.steps) {
      const bool is_comparable =
          step.group != last && !step.is_corrected && step.is_noisy == task_.steps[top()].is_noisy;
      if (is_comparable && std::ranges::find(groups, step.group) == groups.end()) {
        groups.push_back(step.group);
      }
    }
    for (const int group : groups) {
      const std::size_t first = first_of(group);
      if (!evaluate_step(first) || !evaluate_step(reference) || compared(first, reference).serves) {
        continue;
      }
      for (std::size_t step = 0; step < task_.steps.size(); ++step) {
        if (task_.steps[step].group == group) {
          choice_.steps[step].skipped = fmt::format(R"("{}" differs from "{}" by too much)",
                                                    task_.steps[first].name,
                                                    task_.steps[reference].name);
        }
      }
    }
  }

  void climb() {
    for (std::size_t step = 0; step < task_.steps.size(); ++step) {
      StepReport& report = choice_.steps[step];
      if (choice_.is_reached && !report.is_tried) {
        report.skipped = report.skipped.empty() ? "a cheaper one serves" : report.skipped;
        continue;
      }
      if (report.skipped.empty() || report.is_tried) {
        evaluate_step(step);
        const std::string skipped = report.skipped;
        report = compared(step, top());
        report.offsets = offsets_[step];
        report.skipped = scores_[step].empty() ? "cannot render every design" : skipped;
      }
      const bool is_allowed = report.skipped.empty() && task_.steps[step].is_for_search;
      if (report.serves && is_allowed && !choice_.is_reached) {
        choice_.step = step;
        choice_.is_reached = true;
      }
    }
  }

  void find_second() {
    const LadderStep& taken = task_.steps[choice_.step];
    for (std::size_t step = choice_.step + 1; step < task_.steps.size(); ++step) {
      const LadderStep& dearer = task_.steps[step];
      const bool is_fine = !taken.is_corrected || dearer.fineness >= taken.fineness;
      if (dearer.group == task_.steps[top()].group && is_fine) {
        choice_.second = step;
        break;
      }
    }
    if (taken.is_corrected && choice_.second && evaluate_step(*choice_.second)) {
      const std::string skipped = choice_.steps[*choice_.second].skipped;
      choice_.steps[*choice_.second] = compared(*choice_.second, top());
      choice_.steps[*choice_.second].skipped = skipped;
    }
  }

  bool ranks_nothing() const {
    return std::ranges::any_of(orders_against(top(), top()),
                               [](const OrderOf& order) { return order.agreement.pairs == 0; });
  }

  const LadderTask& task_;
  const EvaluateStep& evaluate_;
  std::vector<std::string> judged_;
  std::vector<std::vector<Scores>> scores_;  ///< [step][design]; empty: not tried, or not whole
  std::vector<Scores> offsets_;              ///< [step]; of corrected steps
  std::optional<std::size_t> below_top_;     ///< step
  LadderChoice choice_;
};

}  // namespace

double bound_of(const ScoreBound& bound, const Scores& scores) {
  const auto found = scores.find(error_name(bound.score));
  const bool has_error = found != scores.end() && std::isfinite(found->second);
  return std::max(bound.bound, has_error ? bound.factor * found->second : 0.0);
}

LadderChoice try_ladder(const LadderTask& task, const EvaluateStep& evaluate) {
  GLINT_CHECK(!task.steps.empty(), "a ladder has steps");
  return LadderTrial(task, evaluate).run();
}

}  // namespace glint
