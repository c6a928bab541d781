// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/warm_start.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "core/log.h"
#include "core/text.h"
#include "optimizer/algorithm/merit.h"
#include "studies/definition/study_text.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

ConfigError refusal(const fs::path& run, const std::string& reason) {
  return ConfigError(fmt::format("--from {}: {}", run.string(), reason));
}

/// Tables that may differ without changing what a score means.
bool changes_no_score(const std::string& change) {
  return std::ranges::any_of(
      std::vector<std::string>{
          "variables", "search", "prototypes", "constraints", "manufacture", "schema"},
      [&](const std::string& table) {
        return change.starts_with(table + ".") || change.starts_with(table + " ");
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
  std::vector<std::string> changes = changed_keys(study, resolved_text(there));
  std::erase_if(changes, changes_no_score);
  if (!changes.empty()) {
    throw refusal(run,
                  "its scores have another meaning: " + join(changes, "; ") +
                      "; only limits of variables, [constraints], [prototypes], [search] and "
                      "[budget] may differ");
  }
}

/// The value of the same variable; nothing where it cannot have it.
std::optional<double> value_here(const Variable& here, const Variable& there, double value) {
  if (here.kind != Variable::Kind::kChoice || there.kind != Variable::Kind::kChoice) {
    return here.kind == there.kind ? std::optional(value) : std::nullopt;
  }
  const auto found =
      std::ranges::find(here.choices, there.choices[static_cast<std::size_t>(value)]);
  return found == here.choices.end()
             ? std::nullopt
             : std::optional(static_cast<double>(found - here.choices.begin()));
}

/// The point of this study's space that is the same design.
std::optional<Point> point_here(const SearchSpace& here,
                                const SearchSpace& there,
                                const Point& at) {
  Point point;
  std::vector<bool> was_active;
  for (const Variable& variable : here.variables) {
    const auto other = std::ranges::find(there.variables, variable.name, &Variable::name);
    const auto index = static_cast<std::size_t>(other - there.variables.begin());
    was_active.push_back(is_active(there, at, index));
    const auto value = value_here(variable, *other, at[index]);
    if (!value && was_active.back()) {
      return std::nullopt;
    }
    point.push_back(value.value_or(0.0));
  }
  const Point allowed = canonical(here, point);
  for (std::size_t i = 0; i < point.size(); ++i) {
    const bool active = is_active(here, allowed, i);
    if (active != was_active[i] || (active && allowed[i] != point[i])) {
      return std::nullopt;
    }
  }
  return allowed;
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
  if (config_hash(with_title_of(earlier, recorded.config_text)) != recorded.config_hash) {
    throw refusal(run, "the files of its part have changed since, or an older program wrote it");
  }
  return earlier;
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
  return taken;
}

void keep_taken(const Study& study,
                const TakenTrials& taken,
                const fs::path& out,
                Storage& storage) {
  if (taken.from.empty()) {
    return;
  }
  if (!storage.events().empty()) {
    throw ConfigError(
        fmt::format("--from {}: the run in {} has begun without; give another folder with --out",
                    taken.from.string(),
                    out.string()));
  }
  const fs::path unfinished = out / (std::string(kTakenTrials) + ".part");
  fs::remove(unfinished);
  {
    Storage copy = Storage::open(unfinished, identity_of(study));
    std::vector<Event> asks;
    for (const Trial& trial : taken.trials) {
      asks.push_back({.kind = EventKind::kAsk, .trial = trial.number});
    }
    copy.append(asks, taken.trials);
    for (const Trial& trial : taken.trials) {
      copy.record(TrialKind::kSearch, trial.number, *trial.outcome);
    }
  }
  fs::rename(unfinished, out / kTakenTrials);
  const std::string note = fmt::format("begins with {} of the {} trials of {}",
                                       taken.trials.size(),
                                       taken.found,
                                       taken.from.filename().string());
  storage.append(std::vector<Event>{{.kind = EventKind::kNote, .text = note}});
  log(LogLevel::kInfo, "{}; they count as evaluations", note);
}

TakenTrials trials_to_take(const Study& study, const fs::path& from, const fs::path& out) {
  return from.empty() || fs::exists(out / kTakenTrials) ? TakenTrials{} : trials_from(study, from);
}

std::map<Point, Outcome> begin_with_taken(const fs::path& out, SearchTask& task) {
  std::map<Point, Outcome> outcomes;
  if (fs::exists(out / kTakenTrials)) {
    for (const Trial& trial : Storage::read(out / kTakenTrials).trials(TrialKind::kSearch)) {
      task.start_points.push_back(trial.point);
      outcomes[trial.point] = *trial.outcome;
    }
  }
  return outcomes;
}

}  // namespace glint
