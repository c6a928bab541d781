// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/search_review.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/log.h"
#include "core/rng.h"
#include "core/text.h"
#include "optimizer/algorithm/merit.h"

namespace glint {
namespace {

constexpr std::size_t kFinalistsInARow = 2;
constexpr std::uint64_t kDrawnChecks = 1ULL << 40;  ///< apart from the draws after the search

/// Which trial is checked next, as more and more of them are told.
class CheckQueue {
 public:
  explicit CheckQueue(const Study& study) : study_(study) {}

  void add(const Trial& trial) {
    if (!trial.outcome || trial.outcome->is_failed ||
        !problem_with(study_.goal, trial.outcome->scores).empty()) {
      return;
    }
    unchecked_.push_back(&trial);
    const bool is_record =
        !has_several_objectives(study_.goal) &&
        (best_ == nullptr || is_better(study_.goal, trial.outcome->scores, best_->outcome->scores));
    best_ = is_record ? &trial : best_;
  }

  /// And whether it is the best so far. nullptr: all are checked
  std::pair<const Trial*, bool> take() {
    if (unchecked_.empty()) {
      return {nullptr, false};
    }
    const auto best = std::ranges::find(unchecked_, best_);
    const bool takes_best =
        best != unchecked_.end() && count_ % (kFinalistsInARow + 1) < kFinalistsInARow;
    const auto taken = takes_best ? best : drawn();
    const Trial* trial = *taken;
    unchecked_.erase(taken);
    ++count_;
    return {trial, trial == best_};
  }

 private:
  std::vector<const Trial*>::iterator drawn() {
    Rng rng(study_.search.seed, Stream::kResampling, kDrawnChecks + count_);
    const auto at =
        static_cast<std::size_t>(rng.uniform() * static_cast<double>(unchecked_.size()));
    return unchecked_.begin() + static_cast<std::ptrdiff_t>(at);
  }

  const Study& study_;
  const Trial* best_ = nullptr;
  std::vector<const Trial*> unchecked_;
  std::size_t count_ = 0;
};

/// Whether designs of a part are evaluated again.
bool is_raised(const ChosenAccuracy& before, const ChosenAccuracy& after) {
  return before.rung().name != after.rung().name;
}

/// The rungs that rise, in quotes: "16 samples"; "16 samples" (lighting_use = ring).
std::string raised_names(const ChosenAccuracy& before, const ChosenAccuracy& after) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < after.parts().size(); ++i) {
    const ChosenAccuracy& part = after.parts()[i];
    if (is_raised(before.parts()[i], part)) {
      names.push_back(part.label.empty()
                          ? fmt::format("\"{}\"", part.rung().name)
                          : fmt::format("\"{}\" ({})", part.rung().name, part.label));
    }
  }
  return join(names, ", ");
}

/// @param evaluations  of the parts that rise; others are not evaluated again
std::string raised_sentence(const CheckedDesign& design,
                            const std::string& from,
                            const std::string& to,
                            int evaluations,
                            bool has_branches) {
  return fmt::format(
      "Trial {} differs between \"{}\" and \"{}\" by more than the bound ({}): all {} designs {}"
      "evaluated so far were evaluated again by {}",
      design.trial,
      from,
      design.rung,
      join(design.beyond, ", "),
      evaluations,
      has_branches ? "of these branches " : "",
      to);
}

/// Whether a check beyond the bound may raise the rung of a search, or of a branch.
bool may_rise(const ChosenAccuracy& part) {
  return part.stays.empty() && has_dearer_rung(part);
}

/// @param part  at its rung
std::string stays_sentence(const CheckedDesign& design, const ChosenAccuracy& part) {
  std::vector<std::string> dearer;
  for (std::size_t step = part.choice.step + 1; step < part.ladder.size(); ++step) {
    if (part.ladder[step].is_for_search) {
      dearer.push_back(fmt::format("\"{}\"", part.ladder[step].name));
    }
  }
  return fmt::format(
      "Trial {} differs between \"{}\" and \"{}\" by more than the bound ({}), and {} stays at "
      "the former: no dearer way that it may use ({}) renders every design of the trial.",
      design.trial,
      part.rung().name,
      design.rung,
      join(design.beyond, ", "),
      part.label.empty() ? "the search" : "the branch of " + part.label,
      join(dearer, ", "));
}

/// The steps of the branches; of a search without them none.
std::vector<double> steps_of(const ChosenAccuracy& chosen) {
  std::vector<double> steps;
  for (const ChosenAccuracy& part : chosen.branches) {
    steps.push_back(static_cast<double>(part.choice.step));
  }
  return steps;
}

constexpr std::size_t kEpochFigures = 3;  ///< of an epoch's event, before the steps of branches

/// Whether an epoch that was recorded begins with these rungs.
bool is_epoch_of(const Event& event, const ChosenAccuracy& raised, const Point& beyond) {
  const std::vector<double> steps = steps_of(raised);
  return event.objectives.size() == kEpochFigures + steps.size() &&
         static_cast<double>(raised.of(beyond).choice.step) == event.value &&
         std::equal(steps.begin(), steps.end(), event.objectives.begin() + kEpochFigures);
}

/// Of a rung's score against the top, over the designs of the trial, where the search's own scores
/// are corrected by it, too: what is left of both is within the bound.
double known_offset(const ChosenAccuracy& chosen,
                    const RenderRung& rung,
                    const std::string& score) {
  if (chosen.rung().offsets.empty()) {
    return 0.0;
  }
  const auto step = static_cast<std::size_t>(
      std::ranges::find(chosen.ladder, rung.name, &RenderRung::name) - chosen.ladder.begin());
  const std::vector<ScoreBound>& bounds = chosen.choice.steps[step].bounds;
  const auto found = std::ranges::find(bounds, score, &ScoreBound::score);
  return found != bounds.end() ? found->bias : 0.0;
}

}  // namespace

CheckedDesign compared(const ChosenAccuracy& chosen,
                       const Trial& trial,
                       bool is_finalist,
                       const RenderRung& rung,
                       const Outcome& dearer) {
  CheckedDesign checked = {.trial = trial.number,
                           .is_finalist = is_finalist,
                           .rung = rung.name,
                           .dearer = dearer,
                           .beyond = {},
                           .wider = {}};
  const Scores& scores = trial.outcome->scores;
  for (const ScoreBound& bound : chosen.choice.steps[chosen.choice.step].bounds) {
    const auto cheap = scores.find(bound.score);
    const auto dear = dearer.scores.find(bound.score);
    if (cheap == scores.end() || dear == dearer.scores.end()) {
      continue;  // it cannot be evaluated there, which says nothing of the error
    }
    const double allowed = bound_of(bound, scores);
    const double dearer_score = dear->second - known_offset(chosen, rung, bound.score);
    if (std::abs(cheap->second - dearer_score) > allowed) {
      checked.beyond.push_back(bound.score);
    }
    if (allowed > bound.bound) {
      checked.wider.push_back(bound.score);
    }
  }
  return checked;
}

const RenderRung* second_rung(const ChosenAccuracy& chosen) {
  if (!chosen.choice.problem.empty()) {
    return nullptr;
  }
  const std::optional<std::size_t> second = chosen.choice.second;
  return second && *second > chosen.choice.step ? &chosen.ladder[*second] : nullptr;
}

/// A branch under review, or the whole search.
struct SearchReview::Part {
  const ChosenAccuracy& chosen;
  std::size_t index;
  CheckQueue queue;
  double count = 0.0;  ///< of its trials
  /// Taken from the queue and not decided yet, as CheckQueue::take() gives it; nullptr: none.
  std::pair<const Trial*, bool> waiting = {nullptr, false};
};

SearchReview::SearchReview(const AccuracyTask& task, AccuracyRecord& record, ChosenAccuracy& chosen)
    : task_(task),
      record_(record),
      chosen_(chosen),
      has_sampled_checks_(record.begun_with_sampled_checks().value_or(true)) {}

double SearchReview::work() const {
  return std::accumulate(works_.begin(), works_.end(), 0.0);
}

void SearchReview::resume(const Storage& storage) {
  const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
  for (const Event& event : storage.events()) {
    if (event.kind != EventKind::kEpoch) {
      continue;
    }
    const auto beyond = std::ranges::find(trials, event.trial, &Trial::number);
    std::optional<ChosenAccuracy> raised;
    if (beyond != trials.end() && event.objectives.size() >= kEpochFigures) {
      raised = raise_accuracy(task_, record_, chosen_, *beyond, trials);
    }
    if (!raised || !is_epoch_of(event, *raised, beyond->point)) {
      throw ConfigError(fmt::format(
          "this study cannot be resumed: after trial {} its search took another way to render than "
          "it would take now; the program, a library or the machine changed since. Run into a new "
          "folder",
          event.trial));
    }
    ended_.push_back({.trial = event.trial,
                      .rung = chosen_.of(beyond->point).rung().name,
                      .evaluations = static_cast<int>(event.objectives[0]),
                      .check_work = event.objectives[1],
                      .search_work = event.objectives[2],
                      .sentence = event.text});
    chosen_ = std::move(*raised);
  }
}

/// Ends with the first design beyond the bound whose branch may rise.
void SearchReview::check_up_to(std::span<const Trial> told) {
  checked_.clear();
  undecided_.clear();
  works_.assign(chosen_.parts().size(), 0.0);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < chosen_.parts().size(); ++i) {
    parts.push_back({.chosen = chosen_.parts()[i], .index = i, .queue = CheckQueue(task_.study)});
  }
  for (const Trial& trial : told) {
    if (is_beyond_with(trial, parts[chosen_.index_of(trial.point)])) {
      return;
    }
  }
  for (const Part& part : parts) {
    if (part.waiting.first != nullptr) {
      undecided_.push_back(part.waiting.first->number);
    }
  }
}

/// Whether one of the checks that one more trial pays for ends the epoch.
bool SearchReview::is_beyond_with(const Trial& trial, Part& part) {
  const RenderRung* second = second_rung(part.chosen);
  if (second == nullptr) {
    return false;
  }
  part.queue.add(trial);
  part.count += 1.0;
  const double allowed =
      part.count < kUncheckedEvaluations ? 0.0 : kCheckShare * part.count * part.chosen.rung().work;
  while (const std::optional<CheckedDesign> decided = next_checked(part, *second, allowed)) {
    checked_.push_back(*decided);
    checked_.back().branch = part.index;
    if (may_rise(part.chosen) && !checked_.back().beyond.empty()) {
      return true;
    }
  }
  return false;
}

/// The next design that is decided by what its branch's checks may take. Nothing: all are, or more
/// trials have to pay for it.
std::optional<CheckedDesign> SearchReview::next_checked(Part& part,
                                                        const RenderRung& dearer,
                                                        double allowed) {
  double& work = works_[part.index];
  if (part.waiting.first == nullptr) {
    const std::optional<double> in_pixels =
        has_sampled_checks_ ? sampled_work(task_, part.chosen, dearer) : std::nullopt;
    if (work + in_pixels.value_or(dearer.work) > allowed) {
      return std::nullopt;
    }
    part.waiting = part.queue.take();
    if (part.waiting.first == nullptr) {
      return std::nullopt;
    }
    if (in_pixels) {
      if (std::optional<CheckedDesign> design = confirmed(part, dearer, *in_pixels)) {
        part.waiting = {nullptr, false};
        return design;
      }
    }
  }
  if (work + dearer.work > allowed) {
    return std::nullopt;
  }
  const auto [trial, is_finalist] = std::exchange(part.waiting, {nullptr, false});
  work += dearer.work;
  return compared(
      part.chosen, *trial, is_finalist, dearer, recorded_trial(task_, record_, *trial, dearer));
}

/// The design that waits, where random pixels confirm its bounds.
std::optional<CheckedDesign> SearchReview::confirmed(Part& part,
                                                     const RenderRung& dearer,
                                                     double work) {
  const auto [trial, is_finalist] = part.waiting;
  const auto sample = recorded_sample(task_, record_, part.chosen, *trial, dearer);
  if (!sample) {
    return std::nullopt;
  }
  works_[part.index] += work;
  const Scores& scores = trial->outcome->scores;
  if (!is_confirmed(part.chosen, scores, *sample, task_.study.accuracy->confidence)) {
    return std::nullopt;
  }
  Outcome estimated;
  for (const auto& [score, found] : sample->errors) {
    estimated.scores[score] = scores.at(score) + found.difference;
  }
  CheckedDesign design = compared(part.chosen, *trial, is_finalist, dearer, estimated);
  design.dearer = {};
  design.sampled = sample;
  return design;
}

std::optional<Event> SearchReview::review(std::span<const Trial> told, TimeLeft left) {
  try {
    for (;;) {
      check_up_to(told);
      const std::size_t branch = checked_.empty() ? 0 : checked_.back().branch;
      if (left == TimeLeft::kNone || checked_.empty() || checked_.back().beyond.empty() ||
          !may_rise(chosen_.parts()[branch])) {
        return std::nullopt;
      }
      std::optional<Event> epoch = raise(told);
      if (epoch || may_rise(chosen_.parts()[branch])) {  // the latter: interrupted
        return epoch;
      }
    }
  } catch (const EvaluationAborted&) {
    return std::nullopt;
  }
}

/// What is evaluated again, and what was checked of it, with the work of both.
EndedEpoch SearchReview::ended_by(const CheckedDesign& design,
                                  const ChosenAccuracy& raised,
                                  std::span<const Trial> told) const {
  const std::string& old = chosen_.parts()[design.branch].rung().name;
  EndedEpoch ended = {.trial = design.trial, .rung = old, .sentence = {}};
  for (std::size_t i = 0; i < chosen_.parts().size(); ++i) {
    const ChosenAccuracy& part = chosen_.parts()[i];
    if (!is_raised(part, raised.parts()[i])) {
      continue;
    }
    const auto count = std::ranges::count_if(
        told, [&](const Trial& trial) { return chosen_.index_of(trial.point) == i; });
    ended.evaluations += static_cast<int>(count);
    ended.search_work += part.rung().work * static_cast<double>(count);
    ended.check_work += works_[i];
  }
  ended.sentence = raised_sentence(
      design, old, raised_names(chosen_, raised), ended.evaluations, !chosen_.branches.empty());
  return ended;
}

/// Notes that the rung which was tried for a branch, or for the search, is none for its designs.
void SearchReview::stay(const CheckedDesign& design, const ChosenAccuracy& raised) {
  ChosenAccuracy& part = chosen_.split ? chosen_.branches[design.branch] : chosen_;
  part.stays = stays_sentence(design, part);
  part.choice.work = std::max(part.choice.work, raised.parts()[design.branch].choice.work);
  log(LogLevel::kWarning, "{}", part.stays);
}

std::optional<Event> SearchReview::raise(std::span<const Trial> told) {
  const CheckedDesign& design = checked_.back();
  const Trial& trial = *std::ranges::find(told, design.trial, &Trial::number);
  std::optional<ChosenAccuracy> raised = raise_accuracy(task_, record_, chosen_, trial, told);
  if (!raised || (task_.interrupt != nullptr && *task_.interrupt > 0)) {
    return std::nullopt;
  }
  const LadderChoice& risen = raised->parts()[design.branch].choice;
  if (risen.problem.empty() && risen.scores.empty()) {
    stay(design, *raised);
    return std::nullopt;
  }
  // Their outcomes are withdrawn from the search; those that were corrected by the trial of this
  // epoch are no others' business.
  for (const Trial& one : told) {
    const std::string kept_as = kept_name(chosen_.of(one.point).rung());
    record_.keep(kept_as, trial_name(one.number), one.point, *one.outcome);
  }
  ended_.push_back(ended_by(design, *raised, told));
  const EndedEpoch& ended = ended_.back();
  log(LogLevel::kWarning, "{}", ended.sentence);
  Event event = {
      .kind = EventKind::kEpoch,
      .trial = ended.trial,
      .value = static_cast<double>(raised->of(trial.point).choice.step),
      .text = ended.sentence,
      .objectives = {static_cast<double>(ended.evaluations), ended.check_work, ended.search_work}};
  const std::vector<double> steps = steps_of(*raised);
  event.objectives.insert(event.objectives.end(), steps.begin(), steps.end());
  chosen_ = std::move(*raised);
  checked_.clear();
  works_.clear();
  return event;
}

}  // namespace glint
