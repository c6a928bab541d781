// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_choice.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/accuracy/tried_designs.h"
#include "studies/definition/accuracy_table.h"

namespace glint {
namespace {

/// Whether the rung renders the scene as the point does.
bool is_rung_of(const RenderRung& rung, const FrontierPoint& point) {
  const ComparedMethod& method = point.method;
  if (!rung.is_for_search || rung.pixel_factor != point.reduction ||
      rung.is_noisy != method.is_noisy) {
    return false;
  }
  return rung.is_noisy ? rung.paths.samples == method.paths.samples &&
                             rung.paths.max_reflections == method.paths.max_reflections
                       : rung.render.method == method.render.method &&
                             rung.render.rays_per_axis == method.render.rays_per_axis;
}

/// The rung that was measured by the point; nullptr: it is none.
const RenderRung* rung_at(std::span<const RenderRung> ladder,
                          const FrontierPoint& point,
                          const Frontier& frontier) {
  const bool is_own_part =
      point.realisation.empty() && point.tessellation == frontier.points.front().tessellation;
  const auto found =
      std::ranges::find_if(ladder, [&](const RenderRung& rung) { return is_rung_of(rung, point); });
  return is_own_part && point.problem.empty() && found != ladder.end() ? &*found : nullptr;
}

bool is_close(const FrontierPoint& point) {
  return point.h_error_points <= kChoicePoints &&
         point.contrast_error_percent().value_or(0.0) <= kChoiceContrast;
}

const MethodRanking* row_of(const FrontierPoint& point, const DesignRanking& ranking) {
  const auto row = std::ranges::find(ranking.methods, point.label, &MethodRanking::label);
  return row != ranking.methods.end() ? &*row : nullptr;
}

/// A score that was not measured is not known to be right.
bool keeps(const ScoreWish& wish, const FrontierPoint& point, const FrontierReference& reference) {
  const auto score = point.scores.find(wish.score);
  const auto right = reference.scores.find(wish.score);
  if (score == point.scores.end() || right == reference.scores.end()) {
    return false;
  }
  const double scale = wish.is_relative ? std::abs(right->second.value) : 1.0;
  return score->second.error <= wish.tolerance * scale;
}

bool serves(const FrontierPoint& point,
            const std::vector<ScoreWish>& wishes,
            const Frontier& frontier) {
  if (!wishes.empty()) {
    return std::ranges::all_of(
        wishes, [&](const ScoreWish& wish) { return keeps(wish, point, frontier.reference); });
  }
  if (frontier.ranking) {
    const MethodRanking* row = row_of(point, *frontier.ranking);
    return row != nullptr && row->is_right;
  }
  return is_close(point);
}

/// "lighting_use = ring"; empty: the study has no branches, or the scene lies in none.
std::string own_branch(const Frontier& frontier) {
  return frontier.branch ? frontier.split->label(*frontier.branch) : std::string();
}

std::string rule_text(const std::vector<ScoreWish>& wishes, const Frontier& frontier) {
  const std::optional<DesignRanking>& ranking = frontier.ranking;
  if (!wishes.empty()) {
    std::vector<std::string> texts(wishes.size());
    std::ranges::transform(wishes, texts.begin(), wish_text);
    return "is within " + join(texts, ", ");
  }
  const std::string own = own_branch(frontier);
  return ranking ? fmt::format("puts {} designs{} into the order that {} gives",
                               ranking->designs,
                               own.empty() ? "" : " with " + own,
                               ranking->reference)
                 : fmt::format("is within {:g} point of h and {:g} % of every defect's contrast",
                               kChoicePoints,
                               kChoiceContrast);
}

/// How much its order says: few pairs that differ by more than noise are little evidence.
std::string pairs_text(const FrontierPoint& choice, const Frontier& frontier) {
  const MethodRanking* row =
      frontier.is_choice_by_order ? row_of(choice, *frontier.ranking) : nullptr;
  return row == nullptr ? ""
                        : fmt::format(", judged by {} pairs that differ by more than noise",
                                      row->agreement.pairs);
}

/// A run has a rung for each branch; this one is of the scene's.
std::string branch_text(const Frontier& frontier) {
  if (!frontier.branch) {
    return "";
  }
  return fmt::format(
      " It is that of designs with {}: a run chooses one for each of {} branches (by {}), of which "
      "--set gives the scene another one.",
      own_branch(frontier),
      frontier.split->values.size(),
      frontier.split->name);
}

}  // namespace

void find_branch(const Study& study, Frontier& frontier) {
  frontier.split = study.has_objective ? branch_split(study) : std::optional<BranchSplit>();
  frontier.branch = frontier.split ? branch_of(study, *frontier.split, {}) : std::nullopt;
}

std::vector<RenderRung> choice_ladder(const Study& study, const Frontier& frontier) {
  if (frontier.split) {
    return frontier.branch
               ? branch_ladder(study, tried_designs(study, *frontier.split)[*frontier.branch])
               : std::vector<RenderRung>();
  }
  return study.has_search() && study.has_objective
             ? search_ladder(study)
             : render_ladder(study.scene, kept_keys(study.root));
}

Goal choice_goal(const Study& study) {
  Goal goal = study.goal;
  for (const ScoreWish& wish : study.accuracy ? study.accuracy->wishes : std::vector<ScoreWish>()) {
    goal.constraints.push_back({.name = wish.score});
  }
  return goal;
}

void mark_choice(std::span<const RenderRung> ladder,
                 const std::optional<AccuracySettings>& accuracy,
                 Frontier& frontier) {
  if (!frontier.reference.method.is_noisy) {
    return;
  }
  const std::vector<ScoreWish> wishes = accuracy ? accuracy->wishes : std::vector<ScoreWish>();
  frontier.choice_rule = rule_text(wishes, frontier);
  frontier.is_choice_by_order = wishes.empty() && frontier.ranking.has_value();
  FrontierPoint* choice = nullptr;
  double min_work = 0.0;
  for (FrontierPoint& point : frontier.points) {
    const RenderRung* rung = rung_at(ladder, point, frontier);
    if (rung != nullptr && serves(point, wishes, frontier) &&
        (choice == nullptr || rung->work < min_work)) {
      choice = &point;
      min_work = rung->work;
    }
  }
  if (choice != nullptr) {
    choice->is_chosen = true;
  }
}

void mark_choice(const Study& study, Frontier& frontier) {
  if (frontier.reference.method.is_noisy) {
    mark_choice(choice_ladder(study, frontier), study.accuracy, frontier);
  }
}

std::string choice_sentence(const Frontier& frontier) {
  if (frontier.split && !frontier.branch) {
    return fmt::format(
        "A run chooses a rung for each of {} branches (by {}), and the scene lies in none of them: "
        "there is no automatic choice; --set gives it the values of a branch.",
        frontier.split->values.size(),
        frontier.split->name);
  }
  const auto choice = std::ranges::find_if(frontier.points, &FrontierPoint::is_chosen);
  return choice == frontier.points.end()
             ? fmt::format(
                   "No rung of the ladder that was measured {}: there is no automatic "
                   "choice.{}",
                   frontier.choice_rule,
                   branch_text(frontier))
             : fmt::format(
                   "The automatic choice is {}, of the rungs that were measured the one of "
                   "least counted work that {}{}.{}",
                   choice->label,
                   frontier.choice_rule,
                   pairs_text(*choice, frontier),
                   branch_text(frontier));
}

}  // namespace glint
