// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accurate_search.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/log.h"
#include "studies/accuracy/accuracy_report.h"
#include "studies/definition/ladder/unmodelled.h"
#include "studies/imaging/path_lights.h"

namespace glint {
namespace {

bool has_asked(const Storage& search) {
  const std::vector<Event> events = search.events();
  return std::ranges::find(events, EventKind::kAsk, &Event::kind) != events.end();
}

Replicate replicate_of(const Study& study, int trial, const std::string& rung, Outcome outcome) {
  return {.number = trial,
          .rung = rung,
          .seed = static_cast<std::uint64_t>(study.scene.paths.seed),
          .outcome = std::move(outcome)};
}

/// Of the search's trials as its rung gave them.
std::vector<Replicate> replicates_of(const Study& study,
                                     std::span<const Trial> trials,
                                     const std::string& rung) {
  std::vector<Replicate> replicates;
  for (const Trial& trial : trials) {
    if (trial.outcome) {
      replicates.push_back(replicate_of(study, trial.number, rung, *trial.outcome));
    }
  }
  return replicates;
}

/// Of those that were checked, as the dearer rungs gave them.
std::vector<Replicate> replicates_of(const Study& study, const AccuracyCheck& check) {
  std::vector<Replicate> replicates;
  for (const auto* designs : {&check.during, &check.designs}) {
    for (const CheckedDesign& design : *designs) {
      replicates.push_back(replicate_of(study, design.trial, design.rung, design.dearer));
    }
  }
  return replicates;
}

}  // namespace

SearchResult search_accurately(const AccuracyTask& task,
                               Storage& storage,
                               const ChosenSearch& search,
                               AccurateSearch& found) {
  SearchResult result = {.termination = Termination::kInterrupted};
  try {
    const double start = process_cpu_s();
    AccuracyRecord record(task.record);
    record.check_rules(has_asked(storage));
    found.chosen = choose_accuracy(task, record);
    record.begin_search(found.chosen->rung().name);
    SearchReview review(task, record, *found.chosen);
    review.resume(storage);
    found.cpu_s = process_cpu_s() - start;
    log(LogLevel::kInfo, "the search is rendered by: {}", found.chosen->rung().name);
    result = search(*found.chosen, [&](std::span<const Trial> told) {
      const double review_start = process_cpu_s();
      const std::string rung = found.chosen->rung().name;
      std::optional<Event> event = review.review(told);
      if (event) {
        storage.record(replicates_of(task.study, told, rung));
      }
      found.cpu_s += process_cpu_s() - review_start;
      return event;
    });
    if (result.termination == Termination::kInterrupted) {
      return result;
    }
    const double search_end = process_cpu_s();
    const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
    found.check = check_search(task, record, *found.chosen, trials, review);
    storage.record(replicates_of(task.study, trials, found.chosen->rung().name));
    storage.record(replicates_of(task.study, *found.check));
    found.cpu_s += process_cpu_s() - search_end;
    if (adopt_winner(task.study, *found.check, trials, result)) {
      log(LogLevel::kInfo, "trial {} is the best of the finalists", result.best->number);
    }
  } catch (const EvaluationAborted&) {  // what was found so far is what there is
    result.termination = Termination::kInterrupted;
  }
  return result;
}

nlohmann::ordered_json accurate_search_json(SceneStore& store,
                                            const Study& study,
                                            const AccurateSearch& found,
                                            int evaluations) {
  const Eigen::Vector3d size_mm = store.build(study.scene)->part.box_in_part_mm.size_mm();
  double earlier_work = 0.0;
  for (const EndedEpoch& epoch : found.check ? found.check->ended : std::vector<EndedEpoch>()) {
    earlier_work += epoch.search_work;
  }
  nlohmann::ordered_json json =
      accuracy_json(study,
                    *found.chosen,
                    evaluations,
                    unmodelled_notes(study.scene, size_mm, load_light_mesh),
                    earlier_work);
  if (found.check) {
    json["check"] = check_json(*found.chosen, *found.check, evaluations);
  }
  return json;
}

}  // namespace glint
