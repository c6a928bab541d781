// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accurate_search.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/log.h"
#include "studies/accuracy/accuracy_report.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/accuracy/sampled_check.h"
#include "studies/definition/ladder/unmodelled.h"
#include "studies/imaging/path_lights.h"

namespace glint {
namespace {

bool has_asked(const Storage& search) {
  const std::vector<Event> events = search.events();
  return std::ranges::find(events, EventKind::kAsk, &Event::kind) != events.end();
}

/// As the search's storage has the rung of an accuracy record's outcome. Empty: those scores are
/// not as a search takes them, with half resolution's mean errors still in them.
std::string searched_rung(const std::vector<RenderRung>& ladder, const std::string& recorded) {
  if (recorded.ends_with(kCorrected)) {
    return recorded.substr(0, recorded.size() - kCorrected.size());
  }
  const auto found = std::ranges::find(ladder, recorded, &RenderRung::name);
  return found != ladder.end() && found->pixel_factor == 1 ? recorded : std::string();
}

/// Keeps checks, finalists at the top and withdrawn outcomes in the search's storage as they are
/// made, and those of an earlier run that are missing there: it was killed between the two
/// databases, or was that of a program that did not.
void keep_in_search(const Study& study,
                    const ChosenAccuracy& chosen,
                    Storage& storage,
                    AccuracyRecord& record) {
  std::vector<RenderRung> ladder;
  for (const ChosenAccuracy& part : chosen.parts()) {
    std::ranges::copy(part.ladder, std::back_inserter(ladder));
  }
  record.follow(
      [&study, &storage, ladder](const std::string& recorded, int trial, const Outcome& outcome) {
        if (const std::string rung = searched_rung(ladder, recorded); !rung.empty()) {
          storage.record_missing(std::vector<Replicate>{
              labelled(searched_label(study, rung), TrialKind::kSearch, trial, outcome)});
        }
      });
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
    const bool has_sampled_checks =
        std::ranges::any_of(found.chosen->parts(),
                            [&](const ChosenAccuracy& part) { return may_be_sampled(task, part); });
    record.begin_search(found.chosen->rungs().name(), found.chosen->rules(), has_sampled_checks);
    keep_in_search(task.study, *found.chosen, storage, record);
    SearchReview review(task, record, *found.chosen);
    review.resume(storage);
    found.cpu_s = process_cpu_s() - start;
    log(LogLevel::kInfo, "the search is rendered by: {}", found.chosen->rungs().name());
    result = search(*found.chosen, [&](std::span<const Trial> told, TimeLeft left) {
      const double review_start = process_cpu_s();
      std::optional<Event> event = review.review(told, left);
      found.cpu_s += process_cpu_s() - review_start;
      return event;
    });
    if (result.termination == Termination::kInterrupted) {
      return result;
    }
    const double search_end = process_cpu_s();
    const std::vector<Trial> trials = storage.trials(TrialKind::kSearch);
    count_designs(*found.chosen, trials);
    found.check = check_search(task, record, *found.chosen, trials, review);
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
