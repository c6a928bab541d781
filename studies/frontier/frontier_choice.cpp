// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_choice.h"

#include <algorithm>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr int kMaxReduction = 2;  ///< that a ladder has

/// What a ladder of the scene may hold.
bool is_rung(const FrontierPoint& point, const Frontier& frontier) {
  return point.problem.empty() && point.realisation.empty() && point.reduction <= kMaxReduction &&
         point.tessellation == frontier.points.front().tessellation;
}

bool is_close(const FrontierPoint& point) {
  return point.h_error_points <= kChoicePoints &&
         point.contrast_error_percent().value_or(0.0) <= kChoiceContrast;
}

bool ranks_rightly(const FrontierPoint& point, const DesignRanking& ranking) {
  const auto row = std::ranges::find(ranking.methods, point.label, &MethodRanking::label);
  return row != ranking.methods.end() && row->is_right;
}

/// How much its order says: few pairs that differ by more than noise are little evidence.
std::string pairs_text(const FrontierPoint& choice, const Frontier& frontier) {
  if (!frontier.ranking) {
    return "";
  }
  const auto row =
      std::ranges::find(frontier.ranking->methods, choice.label, &MethodRanking::label);
  return fmt::format(", judged by {} pairs that differ by more than noise", row->agreement.pairs);
}

}  // namespace

void mark_choice(Frontier& frontier) {
  if (!frontier.reference.method.follows_paths) {
    return;
  }
  FrontierPoint* choice = nullptr;
  for (FrontierPoint& point : frontier.points) {
    const bool serves =
        is_rung(point, frontier) &&
        (frontier.ranking ? ranks_rightly(point, *frontier.ranking) : is_close(point));
    if (serves && (choice == nullptr || point.cpu_s < choice->cpu_s)) {
      choice = &point;
    }
  }
  if (choice != nullptr) {
    choice->is_chosen = true;
  }
}

std::string choice_sentence(const Frontier& frontier) {
  const auto choice = std::ranges::find_if(frontier.points, &FrontierPoint::is_chosen);
  const std::string rule =
      frontier.ranking
          ? fmt::format("puts {} designs into the order that {} gives",
                        frontier.ranking->designs,
                        frontier.ranking->reference)
          : fmt::format("is within {:g} point of h and {:g} % of every defect's contrast",
                        kChoicePoints,
                        kChoiceContrast);
  return choice == frontier.points.end()
             ? fmt::format("No rung that was measured {}: there is no automatic choice.", rule)
             : fmt::format("The automatic choice is {}, the cheapest rung that {}{}.",
                           choice->label,
                           rule,
                           pairs_text(*choice, frontier));
}

}  // namespace glint
