// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/budget_note.h"

#include <vector>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

/// Of the chosen rung's evaluations as many as fit, those of another by the ratio of their work.
double fitting(const ChosenAccuracy& chosen, std::size_t step, int possible) {
  return possible * chosen.rung().work / chosen.ladder[step].work;
}

/// Of the rungs below the chosen one that are not left out and whose errors are known. Empty: not
/// one lets so many be made
std::optional<std::size_t> affordable_step(const ChosenAccuracy& chosen, int wanted, int possible) {
  for (std::size_t step = chosen.choice.step; step-- > 0;) {
    const StepReport& report = chosen.choice.steps[step];
    if (!report.bounds.empty() && report.skipped.empty() && chosen.ladder[step].is_for_search &&
        fitting(chosen, step, possible) >= wanted) {
      return step;
    }
  }
  return std::nullopt;
}

std::string errors_text(const StepReport& step) {
  std::vector<std::string> parts;
  for (const ScoreBound& bound : step.bounds) {
    parts.push_back(fmt::format("{} within {:.3g}", bound.score, bound.bound));
  }
  return join(parts, ", ");
}

}  // namespace

std::string budget_note(const Study& study, const ChosenAccuracy& chosen, int possible) {
  const int wanted = study.budget.evaluations > 0 ? study.budget.evaluations : kMinEvaluations;
  if (possible >= wanted) {
    return "";
  }
  const std::string told = fmt::format(
      "What is asked for is not reachable within the budget: by \"{}\" about {} of {} evaluations "
      "fit into {:g} s",
      chosen.rungs().name(),
      possible,
      wanted,
      study.budget.wall_clock_s);
  if (chosen.split) {
    return told + ".";
  }
  const std::optional<std::size_t> step = affordable_step(chosen, wanted, possible);
  return step
             ? fmt::format("{}; all of them would by \"{}\", which is exact to {}.",
                           told,
                           chosen.ladder[*step].name,
                           errors_text(chosen.choice.steps[*step]))
             : fmt::format("{}, and no cheaper way that was tried lets all of them be made.", told);
}

}  // namespace glint
