// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/rung_choice.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

std::vector<double> differences(const std::vector<double>& scores, const std::vector<double>& top) {
  GLINT_CHECK(scores.size() == top.size(), "every rung has the same designs");
  std::vector<double> errors(scores.size());
  std::ranges::transform(scores, top, errors.begin(), std::minus<>());
  return errors;
}

std::vector<ErrorBound> bounds_of(const TriedRung& rung, const TriedRung& top, double confidence) {
  GLINT_CHECK(rung.scores.size() == top.scores.size(), "every rung has the same scores");
  GLINT_CHECK(rung.work > 0.0, "a rung takes work");
  std::vector<ErrorBound> bounds;
  for (std::size_t score = 0; score < top.scores.size(); ++score) {
    const std::vector<double> errors = differences(rung.scores[score], top.scores[score]);
    bounds.push_back(error_bound(errors, confidence, confidence));
  }
  return bounds;
}

bool is_inside(const std::vector<ErrorBound>& bounds, std::span<const ScoreTolerance> tolerances) {
  return std::ranges::equal(bounds, tolerances, [](const ErrorBound& bound, const auto& allowed) {
    return bound.bound <= allowed.tolerance;
  });
}

/// The cheapest rung that serves, the first of equally cheap ones.
template <typename Serves>
std::optional<std::size_t> cheapest(std::span<const TriedRung> ladder, const Serves& serves) {
  std::optional<std::size_t> best;
  for (std::size_t rung = 0; rung < ladder.size(); ++rung) {
    if (serves(rung) && (!best || ladder[rung].work < ladder[*best].work)) {
      best = rung;
    }
  }
  return best;
}

}  // namespace

RungChoice choose_by_tolerance(std::span<const TriedRung> ladder,
                               std::span<const ScoreTolerance> tolerances,
                               double confidence) {
  GLINT_CHECK(!ladder.empty(), "a ladder has rungs");
  GLINT_CHECK(tolerances.size() == ladder.back().scores.size(), "one tolerance for each score");
  RungChoice choice;
  for (const TriedRung& rung : ladder) {
    choice.bounds.push_back(bounds_of(rung, ladder.back(), confidence));
  }
  choice.rung = cheapest(
      ladder, [&](std::size_t rung) { return is_inside(choice.bounds[rung], tolerances); });
  return choice;
}

std::vector<std::string> unreached_tolerances(std::span<const TriedRung> ladder,
                                              std::span<const ScoreTolerance> tolerances,
                                              const RungChoice& choice) {
  GLINT_CHECK(choice.bounds.size() == ladder.size(), "the choice is of this ladder");
  std::vector<std::string> lines;
  for (std::size_t score = 0; ladder.size() > 1 && score < tolerances.size(); ++score) {
    std::size_t best = 0;
    for (std::size_t rung = 1; rung + 1 < ladder.size(); ++rung) {
      best = choice.bounds[rung][score].bound < choice.bounds[best][score].bound ? rung : best;
    }
    const double reached = choice.bounds[best][score].bound;
    if (reached > tolerances[score].tolerance) {
      lines.push_back(fmt::format("{}: {:.3g} is not reachable below '{}'; '{}' reaches {:.3g}",
                                  tolerances[score].score,
                                  tolerances[score].tolerance,
                                  ladder.back().name,
                                  ladder[best].name,
                                  reached));
    }
  }
  return lines;
}

OrderChoice choose_by_order(std::span<const TriedRung> ladder, std::span<const double> top_errors) {
  GLINT_CHECK(!ladder.empty(), "a ladder has rungs");
  OrderChoice choice;
  for (const TriedRung& rung : ladder) {
    GLINT_CHECK(rung.scores.size() == 1, "designs are put in order by one figure");
    choice.agreements.push_back(
        rank_agreement(rung.scores.front(), ladder.back().scores.front(), top_errors));
  }
  const std::size_t top = ladder.size() - 1;
  choice.rung = *cheapest(ladder, [&](std::size_t rung) {
    return rung == top || is_ranking_right(choice.agreements[rung]);
  });
  return choice;
}

}  // namespace glint
