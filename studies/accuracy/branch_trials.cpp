// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/branch_trials.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/accuracy/design_trial.h"
#include "studies/accuracy/search_figures.h"
#include "studies/accuracy/tried_designs.h"

namespace glint {
namespace {

constexpr const char* kUnranked =
    "none of the ways to render that a search may use ranks the designs of all branches together "
    "as the tops of their ladders do; the dearest of them are taken";

bool is_top_taken(const ChosenAccuracy& part) {
  return part.choice.step + 1 == part.ladder.size();
}

/// Of the rungs above the one that is taken, the first that a search may use. There is one
std::size_t dearer_step(const ChosenAccuracy& part) {
  std::size_t step = part.choice.step + 1;
  while (!part.ladder[step].is_for_search) {
    ++step;
  }
  return step;
}

std::vector<OrderOf> orders_of(const Goal& goal,
                               const std::vector<Scores>& designs,
                               const std::vector<Scores>& tops) {
  const std::vector<Objective> objectives = objectives_of(goal);
  const auto mine = search_figures(goal, designs);
  const auto others = search_figures(goal, tops);
  const auto errors = search_figure_errors(goal, tops);
  std::vector<OrderOf> orders;
  for (std::size_t k = 0; k < objectives.size(); ++k) {
    orders.push_back({objectives[k].name, rank_agreement(mine[k], others[k], errors[k])});
  }
  return orders;
}

/// The trials of all branches as they go on.
class BranchTrials {
 public:
  BranchTrials(const AccuracyTask& task, AccuracyRecord& record, ChosenAccuracy chosen)
      : task_(task),
        record_(record),
        designs_(tried_designs(task.study, *chosen.split)),
        lowest_(designs_.size(), 0),
        is_highest_(designs_.size(), false),
        chosen_(std::move(chosen)) {}

  ChosenAccuracy choose() {
    begun_ = record_.begun_rung();
    const BranchSplit& split = *chosen_.split;
    for (std::size_t branch = 0; branch < designs_.size(); ++branch) {
      ChosenAccuracy part;
      part.ladder = branch_ladder(task_.study, designs_[branch]);
      part.label = split.label(branch);
      part.share = 1.0 / static_cast<double>(designs_.size());
      chosen_.branches.push_back(std::move(part));
      try_from(branch, 0);
    }
    rank_together();
    return std::move(chosen_);
  }

  ChosenAccuracy raise(const Trial& beyond) {
    for (std::size_t branch = 0; branch < designs_.size(); ++branch) {
      lowest_[branch] = chosen_.branches[branch].choice.step;
    }
    const std::size_t raised = chosen_.index_of(beyond.point);
    ++lowest_[raised];
    chosen_.branches[raised] = untried_again(chosen_.branches[raised], beyond);
    try_from(raised, lowest_[raised]);
    rank_together();
    return std::move(chosen_);
  }

 private:
  /// @param first_step  of the branch's search
  void try_from(std::size_t branch, std::size_t first_step) {
    ChosenAccuracy& part = chosen_.branches[branch];
    const double work = part.choice.work;
    part = tried(task_,
                 record_,
                 untried(part),
                 {.designs = designs_[branch],
                  .first_step = first_step,
                  .begun = begun_,
                  .is_judged_jointly = task_.study.accuracy->is_auto});
    part.choice.work = std::max(work, part.choice.work);  // of all that was evaluated
  }

  void rank_together() {
    if (!task_.study.accuracy->is_auto) {
      return;
    }
    while (!is_ranked() && !is_lost()) {
      const std::optional<std::size_t> branch = cheapest_to_raise();
      if (!branch) {
        break;
      }
      rise(*branch);
    }
    if (is_ranked()) {
      lower_all();
    }
    tell(is_ranked());
  }

  /// To the next rung that renders all designs of the branch. Where there is none the branch stays
  /// where it is, and does not rise again.
  void rise(std::size_t branch) {
    ChosenAccuracy before = chosen_.branches[branch];
    try_from(branch, dearer_step(before));
    LadderChoice& risen = chosen_.branches[branch].choice;
    if (!risen.scores.empty()) {
      return;
    }
    before.choice.work = risen.work;
    const auto above = static_cast<std::ptrdiff_t>(before.choice.step) + 1;
    std::copy(risen.steps.begin() + above, risen.steps.end(), before.choice.steps.begin() + above);
    chosen_.branches[branch] = std::move(before);
    is_highest_[branch] = true;
  }

  /// Whether the designs of all branches that can be judged are ranked as their tops rank them.
  bool is_ranked() {
    std::vector<Scores> designs;
    std::vector<Scores> tops;
    bool is_at_top = true;
    for (const ChosenAccuracy& part : chosen_.branches) {
      if (part.choice.problem.empty()) {
        std::ranges::copy(part.choice.scores, std::back_inserter(designs));
        std::ranges::copy(part.choice.top_scores, std::back_inserter(tops));
        is_at_top = is_at_top && is_top_taken(part);
      }
    }
    chosen_.orders.clear();
    if (designs.empty() || is_lost()) {
      return !is_lost();  // of branches that cannot be judged nothing is asked
    }
    chosen_.orders = orders_of(task_.study.goal, designs, tops);
    return is_at_top || std::ranges::all_of(chosen_.orders, [](const OrderOf& order) {
             return is_ranking_right(order.agreement);
           });
  }

  /// Whether some branch has no rung that renders all its designs.
  bool is_lost() const {
    return std::ranges::any_of(chosen_.branches, [](const ChosenAccuracy& part) {
      return part.choice.problem.empty() && part.choice.scores.empty();
    });
  }

  std::optional<std::size_t> cheapest_to_raise() const {
    std::optional<std::size_t> cheapest;
    double least = 0.0;
    for (std::size_t branch = 0; branch < chosen_.branches.size(); ++branch) {
      const ChosenAccuracy& part = chosen_.branches[branch];
      if (!part.choice.problem.empty() || is_highest_[branch] || !has_dearer_rung(part)) {
        continue;
      }
      const double work = part.ladder[dearer_step(part)].work;
      if (!cheapest || work < least) {
        cheapest = branch;
        least = work;
      }
    }
    return cheapest;
  }

  void lower_all() {
    std::vector<std::size_t> order(chosen_.branches.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t branch) {
      return chosen_.branches[branch].rung().work;
    });
    for (const std::size_t branch : order) {
      if (chosen_.branches[branch].choice.problem.empty()) {
        lower(branch);
      }
    }
  }

  /// To the cheapest rung by which the ranking stays right. All of them have been evaluated.
  void lower(std::size_t branch) {
    const std::size_t highest = chosen_.branches[branch].choice.step;
    for (std::size_t step = lowest_[branch]; step < highest; ++step) {
      try_from(branch, step);
      if (is_ranked()) {
        return;
      }
    }
    if (lowest_[branch] < highest) {
      try_from(branch, highest);
    }
  }

  /// Why the branches together do not rank rightly.
  std::string unranked_reason() const {
    std::vector<std::string> lost;
    for (const ChosenAccuracy& part : chosen_.branches) {
      if (part.choice.problem.empty() && part.choice.scores.empty()) {
        lost.push_back(part.label);
      }
    }
    return lost.empty() ? std::string(kUnranked)
                        : fmt::format(
                              "no way to render that a search may use renders all designs with {}; "
                              "it takes the dearest, and the others their cheapest, whose order "
                              "was not judged",
                              join(lost, " or "));
  }

  /// A rung serves with those of the other branches.
  void tell(bool is_right) {
    const std::vector<std::string> unreached =
        is_right ? std::vector<std::string>() : std::vector<std::string>{unranked_reason()};
    for (ChosenAccuracy& part : chosen_.branches) {
      LadderChoice& choice = part.choice;
      if (!choice.problem.empty()) {
        continue;
      }
      choice.is_reached = is_right;
      choice.unreached = unreached;
      for (std::size_t step = 0; step <= choice.step; ++step) {
        choice.steps[step].serves = is_right && step == choice.step;
      }
    }
  }

  const AccuracyTask& task_;
  AccuracyRecord& record_;
  std::vector<TrialDesigns> designs_;  ///< of each branch
  std::vector<std::size_t> lowest_;    ///< of each branch: the first step of its search
  std::vector<bool> is_highest_;       ///< of each branch: no dearer rung renders all its designs
  std::optional<std::string> begun_;
  ChosenAccuracy chosen_;
};

/// What is known of a trial at the rung of its branch.
/// @param is_kept  the branch has it from before
std::optional<Outcome> known_of(const AccuracyTask& task,
                                const AccuracyRecord& record,
                                const RenderRung& rung,
                                bool is_kept,
                                const Trial& trial) {
  const std::string name = trial_name(trial.number);
  const Outcome* known = record.find(is_kept ? kept_name(rung) : rung.name, name);
  if (known == nullptr) {
    return is_kept ? trial.outcome : std::nullopt;
  }
  return is_kept ? *known : as_searched(task.study, rung, trial.point, *known);
}

}  // namespace

ChosenAccuracy choose_branches(const AccuracyTask& task,
                               AccuracyRecord& record,
                               const BranchSplit& split) {
  ChosenAccuracy chosen;
  chosen.split = split;
  return BranchTrials(task, record, std::move(chosen)).choose();
}

ChosenAccuracy raise_branches(const AccuracyTask& task,
                              AccuracyRecord& record,
                              const ChosenAccuracy& before,
                              const Trial& beyond,
                              std::span<const Trial> archived) {
  ChosenAccuracy raised = BranchTrials(task, record, before).raise(beyond);
  for (const Trial& trial : archived) {
    const std::size_t branch = raised.index_of(trial.point);
    ChosenAccuracy& part = raised.branches[branch];
    const bool is_kept = part.rung().name == before.branches[branch].rung().name;
    if (auto known = known_of(task, record, part.rung(), is_kept, trial)) {
      part.known[trial.point] = std::move(*known);
    }
  }
  return raised;
}

}  // namespace glint
