// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/budget_note.h"

#include <optional>
#include <vector>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

/// Steps of the search, or of each of its branches.
using PartSteps = std::vector<std::size_t>;

double evaluation_work_at(const ChosenAccuracy& chosen, const PartSteps& steps) {
  double work = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const ChosenAccuracy& part = chosen.parts()[i];
    work += part.share * part.ladder[steps[i]].work;
  }
  return work;
}

/// Of the rungs below a step the next one that is not left out and whose errors are known.
std::optional<std::size_t> cheaper_step(const ChosenAccuracy& part, std::size_t step) {
  while (step-- > 0) {
    const StepReport& report = part.choice.steps[step];
    if (!report.bounds.empty() && report.skipped.empty() && part.ladder[step].is_for_search) {
      return step;
    }
  }
  return std::nullopt;
}

/// One step down in the branch that saves the most work by it. @return whether there is one
bool go_down(const ChosenAccuracy& chosen, PartSteps& steps) {
  const double before = evaluation_work_at(chosen, steps);
  std::optional<PartSteps> best;
  double least = before;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto cheaper = cheaper_step(chosen.parts()[i], steps[i]);
    PartSteps next = steps;
    next[i] = cheaper.value_or(steps[i]);
    if (const double work = evaluation_work_at(chosen, next); work < least) {
      least = work;
      best = next;
    }
  }
  steps = best.value_or(steps);
  return best.has_value();
}

/// The steps below the chosen ones by which as many evaluations can be made, of the chosen ones as
/// many as fit, those of others by the ratio of their work. Empty: not one lets so many be made
std::optional<PartSteps> affordable_steps(const ChosenAccuracy& chosen, int wanted, int possible) {
  PartSteps steps;
  for (const ChosenAccuracy& part : chosen.parts()) {
    steps.push_back(part.choice.step);
  }
  while (possible * chosen.evaluation_work() / evaluation_work_at(chosen, steps) < wanted) {
    if (!go_down(chosen, steps)) {
      return std::nullopt;
    }
  }
  return steps;
}

std::string errors_text(const StepReport& step) {
  std::vector<std::string> parts;
  for (const ScoreBound& bound : step.bounds) {
    parts.push_back(fmt::format("{} within {:.3g}", bound.score, bound.bound));
  }
  return join(parts, ", ");
}

/// Those that differ from the chosen ones, each with its errors.
std::string cheaper_text(const ChosenAccuracy& chosen, const PartSteps& steps) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const ChosenAccuracy& part = chosen.parts()[i];
    if (steps[i] != part.choice.step) {
      parts.push_back(fmt::format("\"{}\"{}, which is exact to {}",
                                  part.ladder[steps[i]].name,
                                  part.label.empty() ? "" : " for " + part.label,
                                  errors_text(part.choice.steps[steps[i]])));
    }
  }
  return join(parts, "; and by ");
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
  const std::optional<PartSteps> steps = affordable_steps(chosen, wanted, possible);
  return steps
             ? fmt::format("{}; all of them would by {}.", told, cheaper_text(chosen, *steps))
             : fmt::format("{}, and no cheaper way that was tried lets all of them be made.", told);
}

}  // namespace glint
