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

constexpr double kShareOfWork = 0.1;
constexpr int kFirstNumber = 100000;  ///< in the database, after those of the ladder

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

std::vector<std::string> beyond_bounds(const ChosenAccuracy& chosen,
                                       const Scores& at_rung,
                                       const Scores& at_top) {
  std::vector<std::string> beyond;
  for (const ScoreBound& bound : chosen.choice.steps[chosen.choice.step].bounds) {
    const auto cheap = at_rung.find(bound.score);
    const auto dear = at_top.find(bound.score);
    const bool is_inside = cheap != at_rung.end() && dear != at_top.end() &&
                           std::abs(cheap->second - dear->second) <= bound.bound;
    if (!is_inside) {
      beyond.push_back(bound.score);
    }
  }
  return beyond;
}

class SearchCheck {
 public:
  SearchCheck(const AccuracyTask& task, const ChosenAccuracy& chosen)
      : task_(task), chosen_(chosen) {
    if (task.record != nullptr) {
      for (const Trial& trial : task.record->trials(TrialKind::kPart)) {
        if (trial.number >= kFirstNumber && trial.outcome) {
          known_[trial.number] = trial;
        }
      }
    }
  }

  CheckedDesign check(const Trial& trial, bool is_finalist) {
    CheckedDesign checked = {
        .trial = trial.number, .is_finalist = is_finalist, .at_top = top_of(trial), .beyond = {}};
    checked.beyond = beyond_bounds(chosen_, trial.outcome->scores, checked.at_top.scores);
    return checked;
  }

 private:
  Outcome top_of(const Trial& trial) {
    const auto found = known_.find(kFirstNumber + trial.number);
    if (found != known_.end() && found->second.point == trial.point) {
      return *found->second.outcome;
    }
    if (task_.interrupt != nullptr && *task_.interrupt > 0) {
      throw EvaluationAborted();
    }
    Outcome outcome = evaluate_at(
        task_.store, task_.study, overrides_of(task_.study, trial.point), chosen_.top());
    if (task_.record != nullptr) {
      task_.record->put_trial(
          {.kind = TrialKind::kPart,
           .number = kFirstNumber + trial.number,
           .name = fmt::format("{} | trial {}", chosen_.top().name, trial.number),
           .point = trial.point,
           .outcome = outcome});
    }
    return outcome;
  }

  const AccuracyTask& task_;
  const ChosenAccuracy& chosen_;
  std::map<int, Trial> known_;
};

}  // namespace

AccuracyCheck check_search(const AccuracyTask& task,
                           const ChosenAccuracy& chosen,
                           const std::vector<Trial>& trials) {
  AccuracyCheck result;
  if (!chosen.choice.problem.empty() || chosen.choice.step + 1 == chosen.ladder.size()) {
    return result;  // there is nothing to compare with
  }
  SearchCheck check(task, chosen);
  const double allowed = kShareOfWork * chosen.rung().work * static_cast<double>(trials.size());
  const Scores* best = nullptr;
  for (const auto& [trial, is_finalist] : interleaved(order_of(task.study, trials))) {
    const bool is_first = result.designs.empty();
    if (!is_first && result.work + chosen.top().work > allowed) {
      break;
    }
    result.designs.push_back(check.check(*trial, is_finalist));
    result.work += chosen.top().work;
  }
  for (const CheckedDesign& design : result.designs) {
    const Scores& scores = design.at_top.scores;
    const bool is_judgeable = design.is_finalist && !design.at_top.is_failed &&
                              problem_with(task.study.goal, scores).empty();
    if (is_judgeable && (best == nullptr || is_better(task.study.goal, scores, *best))) {
      best = &scores;
      result.winner = design.trial;
    }
  }
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
  search.is_feasible = is_feasible(study.goal, design->at_top.scores);
  return is_other;
}

Json check_json(const ChosenAccuracy& chosen, const AccuracyCheck& check, int evaluations) {
  Json designs = Json::array();
  int num_beyond = 0;
  for (const CheckedDesign& design : check.designs) {
    Json top = Json::object();
    for (const ScoreBound& bound : chosen.choice.steps[chosen.choice.step].bounds) {
      const auto found = design.at_top.scores.find(bound.score);
      top[bound.score] = found != design.at_top.scores.end() ? Json(found->second) : Json(nullptr);
    }
    num_beyond += design.beyond.empty() ? 0 : 1;
    designs.push_back({{"trial", design.trial},
                       {"finalist", design.is_finalist},
                       {"beyond", design.beyond},
                       {"top", top}});
  }
  const double search = chosen.rung().work * std::max(1, evaluations);
  const double share = check.work / search;
  return {{"checked", check.designs.size()},
          {"beyond", num_beyond},
          {"work", check.work},
          {"share", share},
          {"designs", designs},
          {"winner", check.winner ? Json(*check.winner) : Json(nullptr)},
          {"sentence",
           check.designs.empty()
               ? "No design of the search was checked: its rung is the top, or nothing could be "
                 "judged."
               : fmt::format("{} of the search {} evaluated at the top too ({:.0f} % of "
                             "its counted work): {} beyond the bounds.",
                             check.designs.size() == 1
                                 ? std::string("The winner")
                                 : fmt::format("{} designs", check.designs.size()),
                             check.designs.size() == 1 ? "was" : "were",
                             100.0 * share,
                             num_beyond == 0 ? "none" : std::to_string(num_beyond))}};
}

}  // namespace glint
