// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/unreached.h"

#include <optional>

#include <fmt/format.h>

namespace glint {
namespace {

/// The step of those that a search may use, and that are not left out, with the smallest bound of a
/// wish.
std::optional<std::size_t> closest_step(const LadderTask& task,
                                        const LadderChoice& choice,
                                        std::size_t wish) {
  std::optional<std::size_t> best;
  for (std::size_t step = 0; step < task.steps.size(); ++step) {
    const auto& bounds = choice.steps[step].bounds;
    const bool is_candidate =
        task.steps[step].is_for_search && choice.steps[step].skipped.empty() && !bounds.empty();
    if (is_candidate && (!best || bounds[wish].bound < choice.steps[*best].bounds[wish].bound)) {
      best = step;
    }
  }
  return best;
}

std::string unable_text(const LadderTask& task, const LadderChoice& choice) {
  return fmt::format("\"{}\", which is taken, cannot render every design of the trial",
                     task.steps[choice.step].name);
}

/// Each score is reached by some step, but no step reaches all of them.
std::vector<std::string> taken_bounds(const LadderTask& task, const LadderChoice& choice) {
  std::vector<std::string> texts;
  for (const ScoreBound& bound : choice.steps[choice.step].bounds) {
    if (bound.bound > bound.tolerance) {
      texts.push_back(
          fmt::format("{}: \"{}\", which is taken, reaches {:.3g} in place of {:.3g}; no way to "
                      "render reaches all scores at once",
                      bound.score,
                      task.steps[choice.step].name,
                      bound.bound,
                      bound.tolerance));
    }
  }
  return texts;
}

std::string unranked_text(const LadderTask& task, bool ranks_nothing) {
  const std::string& name = task.steps.back().name;
  return ranks_nothing ? fmt::format(
                             "the designs of the trial differ by less than the noise of \"{}\", "
                             "which ranks none of them; the dearest way that a search may use is "
                             "taken",
                             name)
                       : fmt::format(
                             "none of the ways to render that a search may use ranks the designs "
                             "as \"{}\" does; the dearest of them is taken",
                             name);
}

}  // namespace

std::vector<std::string> unreached_texts(const LadderTask& task,
                                         const LadderChoice& choice,
                                         bool ranks_nothing) {
  const StepReport& taken = choice.steps[choice.step];
  const bool is_unable = taken.is_tried && taken.bounds.empty();
  if (task.wish.is_auto) {
    return {is_unable ? unable_text(task, choice) : unranked_text(task, ranks_nothing)};
  }
  std::vector<std::string> texts;
  for (std::size_t wish = 0; wish < task.wish.wishes.size(); ++wish) {
    const std::optional<std::size_t> best = closest_step(task, choice, wish);
    const ScoreBound* bound = best ? &choice.steps[*best].bounds[wish] : nullptr;
    if (bound != nullptr && bound->bound > bound->tolerance) {
      texts.push_back(fmt::format("{}: {:.3g} is not reachable; \"{}\" reaches {:.3g}",
                                  bound->score,
                                  bound->tolerance,
                                  task.steps[*best].name,
                                  bound->bound));
    }
  }
  if (is_unable) {
    texts.push_back(unable_text(task, choice));
  }
  return texts.empty() ? taken_bounds(task, choice) : texts;
}

}  // namespace glint
