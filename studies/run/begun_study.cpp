// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/begun_study.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"
#include "studies/definition/study_text.h"
#include "studies/run/run_texts.h"
#include "studies/run/warm_start.h"
#include "studies/tolerance/built_designs.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// Steps from another begin come to the same value but for its last digits.
constexpr double kSameStep = 1e-9;

/// How the limits and choices of variables differ from those of a run that has been begun.
struct SpaceChange {
  SearchSpace before;
  std::vector<std::string> wider;     ///< "lighting.ring.height_mm: max is 60, was 40"
  std::vector<std::string> problems;  ///< why it is not only wider
};

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

/// Whether a value is one that the variable can have.
bool is_allowed_value(const Variable& variable, double allowed, double value) {
  const double slack = variable.step > 0.0 ? kSameStep * (1.0 + std::abs(value)) : 0.0;
  return std::abs(allowed - value) <= slack;
}

/// The study as its run was begun; nothing where the folder does not tell.
std::optional<Study> begun_study(const StudyIdentity& recorded, const fs::path& run) {
  try {
    Study begun = load_study(run / "study.resolved.toml", {});
    return is_recorded_as(begun, recorded.config_hash, recorded.config_text)
               ? std::optional(std::move(begun))
               : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Whether the same variables are all that differs.
bool differs_in_space_alone(const Study& study, const Study& begun, const StudyIdentity& recorded) {
  Study same = study;
  ConfigNode* now = same.root.find("variables");
  const ConfigNode* before = begun.root.find("variables");
  const auto names_of = [](const SearchSpace& space) {
    std::vector<std::string> names;
    for (const Variable& variable : space.variables) {
      names.push_back(variable.name);
    }
    return names;
  };
  if (now == nullptr || before == nullptr || names_of(study.space) != names_of(begun.space)) {
    return false;
  }
  *now = *before;
  same.space = begun.space;
  return is_recorded_as(same, recorded.config_hash, recorded.config_text);
}

void compare_limits(const Variable& here, const Variable& there, SpaceChange& change) {
  const auto compare = [&](const char* end, double now, double before, bool is_narrower) {
    if (now != before) {
      const std::string text =
          fmt::format("{}: {} is {}, was {}", here.name, end, shortest(now), shortest(before));
      is_narrower ? change.problems.push_back(text + ", a narrower range")
                  : change.wider.push_back(text);
    }
  };
  compare("min", here.low, there.low, here.low > there.low);
  compare("max", here.high, there.high, here.high < there.high);
}

void compare_choices(const Variable& here, const Variable& there, SpaceChange& change) {
  const auto has = [](const Variable& variable, const std::string& choice) {
    return std::ranges::find(variable.choices, choice) != variable.choices.end();
  };
  for (const std::string& choice : there.choices) {
    if (!has(here, choice)) {
      change.problems.push_back(fmt::format("{}: {} is no choice any more", here.name, choice));
    }
  }
  for (const std::string& choice : here.choices) {
    if (!has(there, choice)) {
      change.wider.push_back(fmt::format("{}: {} is a choice", here.name, choice));
    }
  }
}

/// A condition may let in a new choice; whether trials are as active as before is seen by each.
void compare_conditions(const Variable& here, const Variable& there, SpaceChange& change) {
  if (here.when_value != there.when_value || here.when_others != there.when_others) {
    change.wider.push_back(here.name + ": is active with other values");
  }
}

void compare_variables(const Variable& here, const Variable& there, SpaceChange& change) {
  const bool is_alike = here.kind == there.kind && here.is_log == there.is_log &&
                        here.step == there.step && here.when_name == there.when_name;
  if (!is_alike) {
    change.problems.push_back(here.name + ": differs in more than limits and choices");
    return;
  }
  compare_conditions(here, there, change);
  if (here.kind == Variable::Kind::kChoice) {
    compare_choices(here, there, change);
  } else {
    compare_limits(here, there, change);
  }
}

std::vector<Point> points_here(const Study& study,
                               const SpaceChange& change,
                               const Storage& storage) {
  std::vector<Point> points;
  for (const Trial& trial : storage.trials(TrialKind::kSearch)) {
    const auto point = point_here(study.space, change.before, trial.point);
    if (!point) {
      throw ConfigError(fmt::format(
          "the wider space does not hold trial {} of the run that has been begun: steps count from "
          "min, and conditions must hold for it as they did; give another folder with --out",
          trial.number));
    }
    points.push_back(*point);
  }
  return points;
}

/// As whatever study it was recorded.
Storage open_recorded(const fs::path& database) {
  return Storage::open(database, Storage::read(database).identity());
}

/// With what a killed run left beside it.
void remove_database(const fs::path& database) {
  for (const char* end : {"-wal", "-shm", ""}) {
    fs::remove(database.string() + end);
  }
}

/// Nothing where anything else differs too.
std::optional<SpaceChange> space_change(const Study& study,
                                        const StudyIdentity& recorded,
                                        const fs::path& run) {
  const std::optional<Study> begun = begun_study(recorded, run);
  if (!begun || !study.has_search() || !begun->has_search() ||
      !differs_in_space_alone(study, *begun, recorded)) {
    return std::nullopt;
  }
  SpaceChange change = {.before = begun->space, .wider = {}, .problems = {}};
  for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
    compare_variables(study.space.variables[i], begun->space.variables[i], change);
  }
  return change.wider.empty() && change.problems.empty() ? std::nullopt : std::optional(change);
}

/// A database of a run, and its trials as points of the wider space.
struct WiderRecord {
  Storage storage;
  std::vector<Point> points;
};

/// Of all databases but for those that a killed run has widened. The study's is opened first, so
/// that no other program runs it, and changed last, so that a killed run does it again.
std::vector<WiderRecord> wider_records(const Study& study,
                                       const SpaceChange& change,
                                       const StudyIdentity& identity,
                                       const fs::path& run) {
  std::vector<WiderRecord> records;
  for (const char* name : {"study.sqlite", kTakenTrials, kAddedDesigns}) {
    if (!fs::exists(run / name)) {
      continue;
    }
    Storage storage = open_recorded(run / name);
    if (storage.identity().config_hash != identity.config_hash) {
      std::vector<Point> points = points_here(study, change, storage);
      records.push_back({std::move(storage), std::move(points)});
    }
  }
  std::ranges::reverse(records);
  return records;
}

void widen_space(const Study& study,
                 const SpaceChange& change,
                 const StudyIdentity& identity,
                 const fs::path& run) {
  std::vector<WiderRecord> records = wider_records(study, change, identity, run);
  remove_database(run / kBuiltTrials);
  const Event epoch = {.kind = EventKind::kEpoch,
                       .text = "a wider space: " + join(change.wider, "; ")};
  for (WiderRecord& record : records) {
    record.storage.become(identity, record.points, epoch);
  }
}

/// Why a run cannot go on in another space. [accuracy] has tried designs of the space as it was: a
/// wider one might ask for another way to render, and what is evaluated is of the first.
std::vector<std::string> problems_with(const Study& study, const SpaceChange& change) {
  std::vector<std::string> problems = change.problems;
  if (study.accuracy) {
    for (const std::string& wider : change.wider) {
      problems.push_back(wider +
                         ", and [accuracy] has chosen how to render for the space as it was");
    }
  }
  return problems;
}

std::string what_may_change(const Study& study) {
  const bool keeps_more = study.accuracy || study.sorting || study.pod;
  return keeps_more ? "title and [budget] may change"
                    : "title, [prototypes] and [budget] may change, and variables may get wider "
                      "limits and more choices";
}

}  // namespace

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
    if (active != was_active[i] ||
        (active && !is_allowed_value(here.variables[i], allowed[i], point[i]))) {
      return std::nullopt;
    }
  }
  return allowed;
}

std::string adopt_begun_study(const Study& study, StudyIdentity& identity, const fs::path& run) {
  const StudyIdentity recorded = Storage::read(run / "study.sqlite").identity();
  if (is_recorded_as(study, recorded.config_hash, recorded.config_text)) {
    identity.config_hash = recorded.config_hash;
    return "";
  }
  const std::optional<SpaceChange> change = space_change(study, recorded, run);
  const std::vector<std::string> problems =
      change ? problems_with(study, *change)
             : change_texts(changed_keys(study, recorded.config_text));
  if (change && problems.empty()) {
    widen_space(study, *change, identity, run);
    return join(change->wider, "; ");
  }
  throw ConfigError(
      fmt::format("{}: holds another study: {}; of a study that has been begun only {}: give "
                  "another folder with --out",
                  run.string(),
                  change ? join(problems, "; ") : changes_text(problems),
                  what_may_change(study)));
}

}  // namespace glint
