// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/warm_start.h"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "core/log.h"
#include "core/text.h"
#include "optimizer/algorithm/merit.h"
#include "studies/definition/study_text.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/run/begun_study.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

ConfigError refusal(const fs::path& run, const std::string& reason) {
  return ConfigError(fmt::format("--from {}: {}", run.string(), reason));
}

/// "objective.0.reference" and the like.
bool is_of_choice(const std::string& path) {
  return path.starts_with("objective.") &&
         std::ranges::any_of(std::vector<std::string>{".reference", ".aspiration", ".weight"},
                             [&](const std::string& key) { return path.ends_with(key); });
}

/// What may differ without changing what a score means.
bool changes_no_score(const ChangedKey& change) {
  return is_of_choice(change.path) ||
         std::ranges::any_of(std::vector<std::string>{"variables",
                                                      "search",
                                                      "prototypes",
                                                      "constraints",
                                                      "manufacture",
                                                      "choice",
                                                      "schema"},
                             [&](const std::string& table) {
                               return change.path == table || change.path.starts_with(table + ".");
                             });
}

void check_variables(const Study& study, const Study& earlier, const fs::path& run) {
  const auto lacks = [](const SearchSpace& space, const std::string& name) {
    return std::ranges::count(space.variables, name, &Variable::name) == 0;
  };
  for (const Variable& variable : study.space.variables) {
    if (lacks(earlier.space, variable.name)) {
      throw refusal(run, variable.name + " is a variable here, but not there");
    }
  }
  for (const Variable& variable : earlier.space.variables) {
    if (lacks(study.space, variable.name)) {
      throw refusal(run, variable.name + " is a variable there, but not here");
    }
  }
}

/// With the same values of the variables both scenes must be the same. Variables under a condition
/// must stand at the same value of their own, which holds where they are inactive.
void check_meaning(const Study& study, const Study& earlier, const fs::path& run) {
  Overrides values;
  for (const Variable& variable : study.space.variables) {
    if (variable.when_name.empty()) {
      values.emplace_back(variable.name, *study.resolved.at_path(variable.name));
    }
  }
  Study there = earlier;
  there.resolved = write_scene(scene_with(earlier, values));
  std::vector<ChangedKey> changes = changed_keys(study, resolved_text(there));
  std::erase_if(changes, changes_no_score);
  if (!changes.empty()) {
    throw refusal(run,
                  "its scores have another meaning: " + join(change_texts(changes), "; ") +
                      "; only limits of variables, reference, aspiration and weight of objectives, "
                      "[choice], [constraints], [prototypes], [manufacture], [search] and [budget] "
                      "may differ");
  }
}

StudyIdentity identity_of(const Study& study) {
  return {.config_hash = config_hash(study),
          .config_text = resolved_text(study),
          .code_version = "",
          .seed = study.search.seed};
}

Study earlier_study(const fs::path& run, const Storage& storage) {
  Study earlier = load_study(run / "study.resolved.toml", {});
  const StudyIdentity recorded = storage.identity();
  if (!is_recorded_as(earlier, recorded.config_hash, recorded.config_text)) {
    throw refusal(run, "the files of its part have changed since, or an older program wrote it");
  }
  return earlier;
}

/// They count as evaluations, and the search must have room for one of its own.
void check_budget(const Study& study, const TakenTrials& taken) {
  const Point baseline = canonical(study.space, baseline_point(study));
  const bool has_baseline =
      std::ranges::find(taken.trials, baseline, &Trial::point) != taken.trials.end();
  const std::size_t first = taken.trials.size() + (has_baseline ? 0 : 1);
  const int allowed = study.budget.evaluations;
  if (allowed > 0 && static_cast<std::size_t>(allowed) <= first) {
    throw refusal(taken.from,
                  fmt::format("its {} trials count as evaluations: with budget.evaluations = {} "
                              "nothing new would be searched; give at least {}",
                              taken.trials.size(),
                              allowed,
                              first + 1));
  }
}

/// Also of "out/gear/" and ".".
std::string folder_name(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

/// What keep_taken() has noted of where the trials are from, seen from the run's folder; empty: a
/// program before did not.
std::string recorded_source(const fs::path& out) {
  const std::vector<Event> events = Storage::read(out / kTakenTrials).events();
  const auto note = std::ranges::find(events, EventKind::kNote, &Event::kind);
  return note != events.end() ? note->text : std::string();
}

/// A recorded folder that is gone counts as renamed or moved, as sources of results do.
void check_begun_with(const fs::path& from, const fs::path& out) {
  const std::string recorded = recorded_source(out);
  std::error_code ignored;
  if (recorded.empty() || recorded == source_seen_from(out, from) ||
      !fs::exists(out / recorded, ignored) || fs::equivalent(out / recorded, from, ignored)) {
    return;
  }
  throw refusal(from,
                fmt::format("the run in {} has begun with the trials of {}; give another folder "
                            "with --out",
                            out.string(),
                            (out / recorded).lexically_normal().string()));
}

std::string note_of(const TakenTrials& taken) {
  const std::string note = fmt::format("begins with {} of the {} trials of {}",
                                       taken.trials.size(),
                                       taken.found,
                                       folder_name(taken.from));
  return taken.made_by.empty() ? note : note + ", which Glint " + taken.made_by + " evaluated";
}

}  // namespace

TakenTrials trials_from(const Study& study, const fs::path& run) {
  if (!study.has_search() || wants_derivatives(study)) {
    throw refusal(run, "needs a search whose algorithm does without derivatives");
  }
  const Storage storage = Storage::read(run / "study.sqlite");
  const Study earlier = earlier_study(run, storage);
  check_variables(study, earlier, run);
  check_meaning(study, earlier, run);
  TakenTrials taken = {.trials = {}, .from = run};
  if (const std::string version = storage.identity().code_version; version != program_version()) {
    taken.made_by = version;
  }
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    if (!trial.outcome) {
      continue;
    }
    ++taken.found;
    const auto point = point_here(study.space, earlier.space, trial.point);
    if (point && !trial.outcome->is_failed &&
        problem_with(study.goal, trial.outcome->scores).empty()) {
      Trial mine = {.number = static_cast<int>(taken.trials.size()) + 1,
                    .point = *point,
                    .outcome = trial.outcome};
      mine.outcome->gradients.clear();
      taken.trials.push_back(std::move(mine));
    }
  }
  if (taken.trials.empty()) {
    throw refusal(run,
                  fmt::format("none of its {} trials is a design of this study with all scores",
                              taken.found));
  }
  check_budget(study, taken);
  return taken;
}

void keep_taken(const Study& study,
                const TakenTrials& taken,
                const fs::path& out,
                Storage& storage) {
  if (taken.from.empty()) {
    return;
  }
  const fs::path unfinished = out / (std::string(kTakenTrials) + ".part");
  fs::remove(unfinished);
  {
    Storage copy = Storage::open(unfinished, identity_of(study));
    std::vector<Event> events = {
        {.kind = EventKind::kNote, .text = source_seen_from(out, taken.from)}};
    for (const Trial& trial : taken.trials) {
      events.push_back({.kind = EventKind::kAsk, .trial = trial.number});
    }
    copy.append(events, taken.trials);
    for (const Trial& trial : taken.trials) {
      copy.record(TrialKind::kSearch, trial.number, *trial.outcome);
    }
  }
  fs::rename(unfinished, out / kTakenTrials);
  const std::string note = note_of(taken);
  storage.append(std::vector<Event>{{.kind = EventKind::kNote, .text = note}});
  log(LogLevel::kInfo, "{}; they count as evaluations", note);
  if (!taken.made_by.empty()) {
    log(LogLevel::kWarning,
        "--from {}: this is Glint {}, which may score the same designs otherwise",
        taken.from.string(),
        program_version());
  }
}

TakenTrials trials_to_take(const Study& study, const fs::path& from, const fs::path& out) {
  if (from.empty()) {
    return {};
  }
  if (fs::exists(out / kTakenTrials)) {
    check_begun_with(from, out);
    return {};
  }
  const fs::path database = out / "study.sqlite";
  if (fs::exists(database) && !Storage::read(database).events().empty()) {
    throw refusal(from,
                  fmt::format("the run in {} has begun without; give another folder with --out",
                              out.string()));
  }
  return trials_from(study, from);
}

std::map<Point, Outcome> begin_with_taken(const fs::path& out, SearchTask& task) {
  std::map<Point, Outcome> outcomes;
  if (fs::exists(out / kTakenTrials)) {
    task.is_start_known = true;
    for (const Trial& trial : Storage::read(out / kTakenTrials).trials(TrialKind::kSearch)) {
      task.start_points.push_back(trial.point);
      outcomes[trial.point] = *trial.outcome;
    }
  }
  return outcomes;
}

}  // namespace glint
