// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accuracy_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "core/text.h"
#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// Trials of the search that can be compared, each once, in the order of looking at them.
struct CheckOrder {
  std::vector<const Trial*> finalists;  ///< newest first
  std::vector<const Trial*> others;     ///< shuffled
};

CheckOrder order_of(const Study& study, const std::vector<Trial>& trials) {
  CheckOrder order;
  const Trial* best = nullptr;
  for (const Trial& trial : trials) {
    if (!trial.outcome || trial.outcome->is_failed ||
        !problem_with(study.goal, trial.outcome->scores).empty()) {
      continue;
    }
    const bool is_record =
        !has_several_objectives(study.goal) &&
        (best == nullptr || is_better(study.goal, trial.outcome->scores, best->outcome->scores));
    if (is_record) {
      best = &trial;
    }
    (is_record ? order.finalists : order.others).push_back(&trial);
  }
  std::ranges::reverse(order.finalists);
  Rng rng(study.search.seed, Stream::kResampling, trials.size());
  for (std::size_t i = order.others.size(); i > 1; --i) {
    std::swap(order.others[i - 1], order.others[rng.next_u32() % i]);
  }
  return order;
}

/// Two finalists, one other, two finalists ...; what is left when one kind has run out.
std::vector<std::pair<const Trial*, bool>> interleaved(const CheckOrder& order) {
  std::vector<std::pair<const Trial*, bool>> list;
  std::size_t finalist = 0;
  std::size_t other = 0;
  while (finalist < order.finalists.size() || other < order.others.size()) {
    for (int k = 0; k < 2 && finalist < order.finalists.size(); ++k) {
      list.emplace_back(order.finalists[finalist++], true);
    }
    if (other < order.others.size()) {
      list.emplace_back(order.others[other++], false);
    }
  }
  return list;
}

std::optional<int> best_at_top(const Study& study, const std::vector<CheckedDesign>& designs) {
  const CheckedDesign* best = nullptr;
  for (const CheckedDesign& design : designs) {
    const Scores& scores = design.dearer.scores;
    const bool is_judgeable =
        design.is_finalist && !design.dearer.is_failed && problem_with(study.goal, scores).empty();
    if (is_judgeable && (best == nullptr || is_better(study.goal, scores, best->dearer.scores))) {
      best = &design;
    }
  }
  return best != nullptr ? std::optional(best->trial) : std::nullopt;
}

int count_beyond(const std::vector<CheckedDesign>& designs) {
  return static_cast<int>(std::ranges::count_if(
      designs, [](const CheckedDesign& design) { return !design.beyond.empty(); }));
}

int count_wider(const AccuracyCheck& check) {
  const auto is_wider = [](const CheckedDesign& design) { return !design.wider.empty(); };
  return static_cast<int>(std::ranges::count_if(check.during, is_wider) +
                          std::ranges::count_if(check.designs, is_wider));
}

std::string number_text(int number) {
  return number == 0 ? "none" : std::to_string(number);
}

/// The value of a design's branch, where there are some. @param json  of the design
void add_branch(const ChosenAccuracy& chosen, const CheckedDesign& design, Json& json) {
  if (chosen.split) {
    json["branch"] = chosen.split->values[design.branch];
  }
}

/// What random pixels told, where they decided.
void add_sample(const CheckedDesign& design, Json& json) {
  if (!design.sampled) {
    return;
  }
  json["pixels"] = design.sampled->pixels;
  json["differences"] = Json::object();
  for (const auto& [score, found] : design.sampled->errors) {
    json["differences"][score] = {{"value", found.difference}, {"error", found.error}};
  }
}

Json during_json(const ChosenAccuracy& chosen, const AccuracyCheck& check) {
  Json designs = Json::array();
  for (const CheckedDesign& design : check.during) {
    designs.push_back({{"trial", design.trial},
                       {"finalist", design.is_finalist},
                       {"rung", design.rung},
                       {"beyond", design.beyond},
                       {"wider", design.wider}});
    add_sample(design, designs.back());
    add_branch(chosen, design, designs.back());
  }
  Json json = {{"checked", check.during.size()},
               {"beyond", count_beyond(check.during)},
               {"work", check.during_work},
               {"designs", designs}};
  if (!check.undecided.empty()) {
    json["undecided"] = check.undecided;
  }
  return json;
}

Json epochs_json(const AccuracyCheck& check) {
  Json epochs = Json::array();
  for (const EndedEpoch& epoch : check.ended) {
    epochs.push_back({{"trial", epoch.trial},
                      {"rung", epoch.rung},
                      {"evaluations", epoch.evaluations},
                      {"check_work", epoch.check_work},
                      {"search_work", epoch.search_work},
                      {"sentence", epoch.sentence}});
  }
  return epochs;
}

/// "The winner was evaluated at the top too: beyond the bounds none."
std::string top_text(const AccuracyCheck& check) {
  const std::size_t count = check.designs.size();
  return fmt::format("{} evaluated at the top too, {} beyond the bounds.",
                     count == 1 ? std::string("The winner was")
                                : fmt::format("After the search {} designs were", count),
                     number_text(count_beyond(check.designs)));
}

/// By which designs were checked, each once.
std::vector<std::string> rungs_of(const std::vector<CheckedDesign>& designs) {
  std::vector<std::string> rungs;
  for (const CheckedDesign& design : designs) {
    if (std::ranges::find(rungs, design.rung) == rungs.end()) {
      rungs.push_back(design.rung);
    }
  }
  return rungs;
}

/// ", 12 of them in random pixels alone"; empty: all of them as a whole.
std::string sampled_text(const std::vector<CheckedDesign>& designs) {
  const auto count = static_cast<std::size_t>(std::ranges::count_if(
      designs, [](const CheckedDesign& design) { return design.sampled.has_value(); }));
  if (count == 0) {
    return "";
  }
  return count == designs.size() ? std::string(" in random pixels")
                                 : fmt::format(", {} of them in random pixels alone", count);
}

/// "Random pixels left evaluation 71 in doubt, ..."
std::string undecided_text(const std::vector<int>& trials) {
  std::vector<std::string> numbers;
  for (const int trial : trials) {
    numbers.push_back(std::to_string(trial));
  }
  return fmt::format(
      "Random pixels left evaluation{} {} in doubt, whose whole picture was more than checks may "
      "take: the wide bounds are what can be relied on there.",
      numbers.size() == 1 ? "" : "s",
      join(numbers, ", "));
}

/// "While it went on, 2 designs were evaluated by "16 samples" too, none beyond the bounds."
std::string during_text(const std::vector<CheckedDesign>& designs) {
  return fmt::format(
      "While it went on, {} design{} evaluated by \"{}\" too{}, {} beyond the bounds.",
      designs.size(),
      designs.size() == 1 ? " was" : "s were",
      join(rungs_of(designs), "\" or \""),
      sampled_text(designs),
      number_text(count_beyond(designs)));
}

std::string check_text(const AccuracyCheck& check, double share) {
  std::vector<std::string> parts;
  for (const EndedEpoch& epoch : check.ended) {
    parts.push_back(epoch.sentence + ".");
  }
  if (!check.during.empty()) {
    parts.push_back(during_text(check.during));
  }
  if (!check.undecided.empty()) {
    parts.push_back(undecided_text(check.undecided));
  }
  if (!check.designs.empty()) {
    parts.push_back(top_text(check));
  }
  if (parts.empty()) {
    return "No design of the search was checked, as there is no dearer way to compare with, or "
           "nothing could be judged: the wide bounds are what can be relied on.";
  }
  if (const int wider = count_wider(check); wider > 0) {
    parts.push_back(fmt::format(
        "Of these {} noisier than those of the trial, so that bounds of their own hold.",
        wider == 1 ? std::string("one is") : fmt::format("{} are", wider)));
  }
  parts.push_back(
      fmt::format("Checking took {:.1f} % of the search's counted work.", 100.0 * share));
  if (count_beyond(check.during) + count_beyond(check.designs) > 0) {
    parts.emplace_back(
        "The bounds do not hold here: ask for less, or for a confidence closer to 1.");
  }
  return join(parts, " ");
}

/// Who had the last word; empty: the check.
std::string race_text(const AccuracyCheck& check) {
  return check.raced ? fmt::format(
                           " The winner was decided after that by a race of the finalists with "
                           "fresh random numbers, rendered as [render] says: evaluation {}.",
                           *check.raced)
                     : std::string();
}

/// Whether a dearer rung than that of the search or branch is there to compare with.
bool can_be_compared(const ChosenAccuracy& part) {
  return part.choice.problem.empty() && part.choice.step + 1 < part.ladder.size();
}

/// What checks may take: kCheckShare of the counted work of all trials at their rungs.
double allowed_work(const ChosenAccuracy& chosen, const std::vector<Trial>& trials) {
  double work = 0.0;
  for (std::size_t i = 0; i < chosen.parts().size(); ++i) {
    const auto count = std::ranges::count_if(
        trials, [&](const Trial& trial) { return chosen.index_of(trial.point) == i; });
    work += kCheckShare * chosen.parts()[i].rung().work * static_cast<double>(count);
  }
  return work;
}

}  // namespace

AccuracyCheck check_search(const AccuracyTask& task,
                           AccuracyRecord& record,
                           const ChosenAccuracy& chosen,
                           const std::vector<Trial>& trials,
                           const SearchReview& review) {
  AccuracyCheck result = {.during = review.checked(),
                          .during_work = review.work(),
                          .undecided = review.undecided(),
                          .ended = review.ended()};
  if (std::ranges::none_of(chosen.parts(), can_be_compared)) {
    return result;
  }
  const double allowed = allowed_work(chosen, trials) - review.work();
  for (const auto& [trial, is_finalist] : interleaved(order_of(task.study, trials))) {
    const ChosenAccuracy& part = chosen.of(trial->point);
    const bool is_there = part.choice.step + 1 == part.ladder.size();
    if (is_there && !is_finalist) {
      continue;
    }
    const double work = is_there ? 0.0 : part.top().work;
    if (!result.designs.empty() && result.work + work > allowed) {
      break;
    }
    const Outcome top =
        is_there ? *trial->outcome : recorded_trial(task, record, *trial, part.top());
    (result.designs.empty() ? result.finalist_work : result.work) += work;
    result.designs.push_back(compared(part, *trial, is_finalist, part.top(), top));
    result.designs.back().branch = chosen.index_of(trial->point);
  }
  std::erase_if(result.undecided, [&](int trial) {  // evaluated at the top since
    return std::ranges::find(result.designs, trial, &CheckedDesign::trial) != result.designs.end();
  });
  result.winner = best_at_top(task.study, result.designs);
  return result;
}

bool adopt_winner(const Study& study,
                  const AccuracyCheck& check,
                  const std::vector<Trial>& trials,
                  SearchResult& search) {
  if (!check.winner || !search.best) {
    return false;
  }
  const bool is_other = *check.winner != search.best->number;
  const auto trial = std::ranges::find(trials, *check.winner, &Trial::number);
  const auto design = std::ranges::find(check.designs, *check.winner, &CheckedDesign::trial);
  search.best = *trial;
  if (is_other || !search.judged_limits) {
    search.is_feasible = is_feasible(study.goal, design->dearer.scores);
    search.judged_limits.reset();
  }
  return is_other;
}

Json check_json(const ChosenAccuracy& chosen, const AccuracyCheck& check, int evaluations) {
  Json designs = Json::array();
  for (const CheckedDesign& design : check.designs) {
    Json top = Json::object();
    const LadderChoice& choice = chosen.parts()[design.branch].choice;
    for (const ScoreBound& bound : choice.steps[choice.step].bounds) {
      const auto found = design.dearer.scores.find(bound.score);
      top[bound.score] = found != design.dearer.scores.end() ? Json(found->second) : Json(nullptr);
    }
    designs.push_back({{"trial", design.trial},
                       {"finalist", design.is_finalist},
                       {"beyond", design.beyond},
                       {"wider", design.wider},
                       {"top", top}});
    add_branch(chosen, design, designs.back());
  }
  double work = check.work + check.during_work;
  double search = chosen.evaluation_work() * std::max(1, evaluations);
  for (const EndedEpoch& epoch : check.ended) {
    work += epoch.check_work;
    search += epoch.search_work;
  }
  return {{"checked", check.designs.size()},
          {"beyond", count_beyond(check.designs)},
          {"work", work},
          {"share", work / search},
          {"finalist_work", check.finalist_work},
          {"designs", designs},
          {"winner", check.winner ? Json(*check.winner) : Json(nullptr)},
          {"raced", check.raced ? Json(*check.raced) : Json(nullptr)},
          {"during", during_json(chosen, check)},
          {"epochs", epochs_json(check)},
          {"sentence", check_text(check, work / search) + race_text(check)}};
}

}  // namespace glint
