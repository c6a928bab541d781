// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/definition/accuracy_table.h"
#include "studies/definition/study_goal.h"

namespace glint {
namespace {

using Kind = ConfigNode::Kind;

/// Dotted paths of all plain values below a node.
void collect_paths(const ConfigNode& node, const std::string& path, std::vector<std::string>& out) {
  if (!node.is_table() && !node.is_array()) {
    out.push_back(path);
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string name = node.is_table() ? node.names[i] : fmt::format("{}", i);
    collect_paths(node.items[i], path.empty() ? name : fmt::format("{}.{}", path, name), out);
  }
}

void visit_search(KeyVisitor& keys, SearchSettings& s, bool& has_needed_scores_only) {
  constexpr std::array<std::string_view, 2> kScores = {"all", "needed"};
  std::vector<std::string_view> names(algorithm_names().begin(), algorithm_names().end());
  const auto position = std::ranges::find(names, std::string_view(s.algorithm));
  int index = position == names.end() ? 0 : static_cast<int>(position - names.begin());
  keys.choice_index("algorithm", index, names, "how designs are chosen; docs/theory/search.md");
  s.algorithm = names[static_cast<std::size_t>(index)];
  int seed = static_cast<int>(s.seed);
  keys.integer("seed", seed, Range::at_least(0), "of the search; noise has its own in [sensor]");
  s.seed = static_cast<std::uint64_t>(seed);
  keys.integer(
      "batch",
      s.batch,
      Range::between(1, 1024),
      "designs asked before the first of them is told; results depend on it, not on --jobs");
  keys.integer("design",
               s.design,
               Range::between(0, 100000),
               "size of the Sobol design before the local search; 0 = chosen by the program");
  keys.boolean("noisy", s.is_noisy, "scores of one design vary from evaluation to evaluation");
  if (keys.is_given("scores") || has_needed_scores_only) {
    int scores = has_needed_scores_only ? 1 : 0;
    keys.choice_index("scores",
                      scores,
                      kScores,
                      "of a design in the search: all, or without changes of defects where neither "
                      "objective nor constraint needs them, so that the flawless part is not "
                      "rendered");
    has_needed_scores_only = scores == 1;
  }
  if (keys.is_given("derivatives") || s.derivatives) {
    keys.boolean("derivatives",
                 s.derivatives,
                 "the Gaussian process also learns from derivatives, where they are known");
  }
}

void visit_budget(KeyVisitor& keys, Budget& b) {
  keys.integer("evaluations", b.evaluations, Range::between(0, 100000000), "0 = no limit");
  std::string text = b.wall_clock_s > 0.0 ? shortest(b.wall_clock_s) + "s" : "0s";
  keys.text("wall_clock", text, R"(like "40s", "30m", "8h"; "0s" = no limit)");
  const auto seconds = parse_duration_s(text);
  keys.require(seconds.has_value(),
               "wall_clock",
               fmt::format(R"(is "{}", must be a duration like "40s", "30m" or "8h")", text));
  b.wall_clock_s = seconds.value_or(0.0);
  keys.integer("stall",
               b.stall,
               Range::between(0, 100000000),
               "evaluations without a design that is better by more than the objective's noise; 0 "
               "= no limit");
  if (keys.is_given("race") || b.race) {
    int race = b.race.value_or(0);
    keys.integer("race",
                 race,
                 Range::between(0, 64),
                 "best designs that are evaluated again with fresh random numbers after the "
                 "search, so that the winner is not the luckiest; 0 = none; without it 2 to 8 of a "
                 "search that is noisy");
    b.race = race;
  }
  double target = b.target.value_or(0.0);
  if (keys.is_given("target") || b.target) {
    keys.number("target", target, Range{}, "value of the objective that is good enough");
    b.target = target;
  }
  keys.require(b.evaluations > 0 || b.wall_clock_s > 0.0 || b.stall > 0 || b.target,
               "evaluations",
               "no limit is set: give evaluations, wall_clock, stall or target");
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \"");
  const auto last = text.find_last_not_of(" \"");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

/// The values of "[a, b]"; none when it is written otherwise.
std::vector<std::string> listed_values(const std::string& text) {
  const std::string list = trimmed(text);
  if (list.size() < 3 || list.front() != '[' || list.back() != ']') {
    return {};
  }
  std::vector<std::string> values;
  for (const std::string& item : split(list.substr(1, list.size() - 2), ',')) {
    values.push_back(trimmed(item));
  }
  return std::ranges::any_of(values, &std::string::empty) ? std::vector<std::string>() : values;
}

/// Reads `when = "path == value"` or `when = "path in [value, value]"`.
void read_condition(const ConfigNode& node, Variable& variable, std::vector<Problem>& errors) {
  const auto equals = node.text.find("==");
  const auto in = node.text.find(" in ");
  std::vector<std::string> values;
  if (node.kind == ConfigNode::Kind::kText && equals != std::string::npos) {
    variable.when_name = trimmed(node.text.substr(0, equals));
    values = {trimmed(node.text.substr(equals + 2))};
  } else if (node.kind == ConfigNode::Kind::kText && in != std::string::npos) {
    variable.when_name = trimmed(node.text.substr(0, in));
    values = listed_values(node.text.substr(in + 4));
  }
  if (values.empty()) {
    errors.push_back({.place = node.place,
                      .context = "variables",
                      .key = variable.name,
                      .text = R"(when must be "path == value" or "path in [value, value]")"});
    return;
  }
  variable.when_value = values.front();
  variable.when_others.assign(values.begin() + 1, values.end());
}

class VariableReader {
 public:
  VariableReader(const Study& study, std::vector<Problem>& errors)
      : study_(study), errors_(errors) {}

  std::optional<Variable> read(const std::string& path, const ConfigNode& table) {
    const ConfigNode* key = study_.resolved.at_path(path);
    if (key == nullptr) {
      errors_.push_back(unknown_path(study_, path, table.place));
      return std::nullopt;
    }
    if (!table.is_table() || key->is_table() || key->is_array()) {
      fail(table, path, "must be { min = .., max = .. } or { choices = [..] } of one value");
      return std::nullopt;
    }
    Variable variable{.name = path};
    variable.kind = key->kind == Kind::kInteger  ? Variable::Kind::kInteger
                    : key->kind == Kind::kNumber ? Variable::Kind::kFloat
                                                 : Variable::Kind::kChoice;
    const bool is_read = variable.kind == Variable::Kind::kChoice
                             ? read_choices(path, table, *key, variable)
                             : read_range(path, table, variable);
    return is_read ? std::optional(variable) : std::nullopt;
  }

 private:
  void fail(const ConfigNode& where, const std::string& path, const std::string& message) {
    errors_.push_back({.place = where.place, .context = "variables", .key = path, .text = message});
  }

  bool read_range(const std::string& path, const ConfigNode& table, Variable& variable) {
    bool is_good = true;
    bool has_min = false;
    bool has_max = false;
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      const std::string& name = table.names[i];
      const ConfigNode& item = table.items[i];
      if (name == "when") {
        read_condition(item, variable, errors_);
      } else if (name == "log" && item.kind == Kind::kBoolean) {
        variable.is_log = item.boolean;
      } else if ((name == "min" || name == "max" || name == "step") && item.is_number()) {
        (name == "min"   ? variable.low
         : name == "max" ? variable.high
                         : variable.step) = item.number;
        has_min = has_min || name == "min";
        has_max = has_max || name == "max";
      } else {
        fail(
            item, path, fmt::format("{} is not allowed here; min, max, step, log, when are", name));
        is_good = false;
      }
    }
    if (!has_min || !has_max) {
      if (is_good) {
        fail(table, path, "needs min and max");
      }
      return false;
    }
    if (variable.low > variable.high) {
      fail(table,
           path,
           fmt::format("min {} is above max {}", shortest(variable.low), shortest(variable.high)));
      return false;
    }
    return is_good;
  }

  bool read_choices(const std::string& path,
                    const ConfigNode& table,
                    const ConfigNode& key,
                    Variable& variable) {
    if (const ConfigNode* when = table.find("when")) {
      read_condition(*when, variable, errors_);
    }
    const ConfigNode* choices = table.find("choices");
    if (choices == nullptr || !choices->is_array() || choices->items.empty()) {
      if (key.kind == Kind::kBoolean && choices == nullptr) {
        variable.choices = {"false", "true"};
        return true;
      }
      fail(table, path, "needs choices = [\"..\", ..]");
      return false;
    }
    if (choices->items.size() == 1) {
      fail(*choices, path, "has a single choice; give two or more, or set the key itself");
      return false;
    }
    for (const ConfigNode& choice : choices->items) {
      if (choice.kind != key.kind) {
        fail(choice, path, "a choice must be of the key's own kind");
        return false;
      }
      variable.choices.push_back(choice.kind == Kind::kBoolean ? (choice.boolean ? "true" : "false")
                                                               : choice.text);
    }
    return true;
  }

  const Study& study_;
  std::vector<Problem>& errors_;
};

/// What is wrong with the space as a whole, at the condition or the table of the variable at fault.
Problem problem_of_space(const Study& study, const ConfigNode& table, const Problem& problem) {
  Problem placed = {
      .place = table.place, .context = "variables", .key = problem.key, .text = problem.text};
  for (const Variable& variable : study.space.variables) {
    const ConfigNode* node = table.find(variable.name);
    if (problem.key != fmt::format("variable \"{}\"", variable.name) || node == nullptr) {
      continue;
    }
    const ConfigNode* when = node->find("when");
    placed.place = when != nullptr ? when->place : node->place;
    placed.key = variable.name;
  }
  return placed;
}

void read_variables(Study& study, std::vector<Problem>& errors) {
  const ConfigNode* table = study.root.find("variables");
  if (table == nullptr) {
    return;
  }
  const std::size_t before = errors.size();
  VariableReader reader(study, errors);
  for (std::size_t i = 0; i < table->names.size(); ++i) {
    if (auto variable = reader.read(table->names[i], table->items[i])) {
      study.space.variables.push_back(std::move(*variable));
    }
  }
  if (errors.size() == before && !study.space.variables.empty()) {
    try {
      check(study.space);
    } catch (const ConfigError& error) {
      for (const Problem& problem : error.problems()) {
        errors.push_back(problem_of_space(study, *table, problem));
      }
    }
  }
}

/// A study either searches designs or inspects a population with the designs it names.
void read_populations(Study& study, std::vector<Problem>& errors) {
  study.sorting = read_sorting(study.root, study.scene.defects, errors);
  study.pod = read_pod(study.root, study.scene.defects, errors);
  for (const char* name : {"sorting", "pod"}) {
    const ConfigNode* table = study.root.find(name);
    if (table != nullptr && study.root.find("variables") != nullptr) {
      errors.push_back(
          {.kind = Problem::Kind::kRelation,
           .place = table->place,
           .key = name,
           .text = "cannot be combined with [variables]: a study either searches or inspects a "
                   "population; name the designs to be compared as [prototypes]"});
    }
  }
}

/// Nothing is searched or inspected where a calibration is tried out.
void read_trial(Study& study, std::vector<Problem>& errors) {
  study.calibration_trial = read_calibration_trial(study.root, study.scene, errors);
  for (const char* name : {"variables", "prototypes", "sorting", "pod"}) {
    const ConfigNode* table = study.root.find(name);
    if (study.calibration_trial && table != nullptr) {
      errors.push_back({.kind = Problem::Kind::kRelation,
                        .place = table->place,
                        .key = name,
                        .text = "cannot be combined with [calibration_trial], which has no "
                                "designs"});
    }
  }
}

}  // namespace

void read_study_tables(Study& study, std::vector<Problem>& errors) {
  study.title = study.name;
  if (const ConfigNode* title = study.root.find("title")) {
    if (title->kind != Kind::kText) {
      errors.push_back({.kind = Problem::Kind::kWrongType,
                        .place = title->place,
                        .key = "title",
                        .text = "must be a text in quotes"});
    }
    study.title = title->text;
  }
  if (const ConfigNode* schema = study.root.find("schema")) {
    if (schema->kind != Kind::kInteger || schema->integer < 1 || schema->integer > kNewestSchema) {
      errors.push_back({.place = schema->place,
                        .key = "schema",
                        .text = fmt::format("this program reads schema 1 to {}", kNewestSchema)});
    }
  }
  read_variables(study, errors);
  KeyReader search(study.root.find("search"), "search", errors);
  visit_search(search, study.search, study.has_needed_scores_only);
  search.take("derivatives");  // known also where it is not given
  search.report_unknown();
  KeyReader budget(study.root.find("budget"), "budget", errors);
  visit_budget(budget, study.budget);
  budget.take("race");  // known also where they are not given
  budget.take("target");
  budget.report_unknown();
  read_goal(study, errors);
  read_populations(study, errors);
  read_trial(study, errors);
  study.accuracy = read_accuracy(study.root, study.scene, errors);
}

void write_study_tables(const Study& study, ConfigNode& root) {
  const auto add = [&](const char* name, const auto& visit) {
    ConfigNode table = ConfigNode::table();
    KeyWriter writer(table);
    visit(writer);
    root.names.emplace_back(name);
    root.items.push_back(std::move(table));
  };
  add("search", [&](KeyVisitor& keys) {
    SearchSettings settings = study.search;
    bool has_needed_scores_only = study.has_needed_scores_only;
    visit_search(keys, settings, has_needed_scores_only);
  });
  add("budget", [&](KeyVisitor& keys) {
    Budget budget = study.budget;
    visit_budget(keys, budget);
  });
  if (study.accuracy) {
    root.names.emplace_back("accuracy");
    root.items.push_back(write_accuracy(*study.accuracy, study.root));
  }
  if (study.sorting) {
    root.names.emplace_back("sorting");
    root.items.push_back(write_sorting(*study.sorting));
  }
  if (study.pod) {
    root.names.emplace_back("pod");
    root.items.push_back(write_pod(*study.pod));
  }
  if (study.calibration_trial) {
    root.names.emplace_back("calibration_trial");
    root.items.push_back(write_calibration_trial(*study.calibration_trial));
  }
}

std::vector<KeyRow> study_keys() {
  std::vector<KeyRow> rows;
  SearchSettings search;
  search.derivatives = true;
  KeyLister search_lister("search", rows);
  bool has_needed_scores_only = true;  // else the key is not listed
  visit_search(search_lister, search, has_needed_scores_only);
  rows.back().default_text = "false";
  rows[rows.size() - 2].default_text = "\"all\"";
  Budget budget;
  budget.target = 0.0;
  budget.race = 0;
  KeyLister budget_lister("budget", rows);
  visit_budget(budget_lister, budget);
  rows[rows.size() - 2].default_text = "none";
  std::ranges::copy(accuracy_keys(), std::back_inserter(rows));
  const std::vector<KeyRow> populations = population_keys();
  rows.insert(rows.end(), populations.begin(), populations.end());
  std::ranges::copy(calibration_trial_keys(), std::back_inserter(rows));
  const auto add = [&](const char* path, const char* kind, const char* allowed, const char* doc) {
    rows.push_back(
        {.path = path, .kind = kind, .allowed = allowed, .default_text = "none", .doc = doc});
  };
  add("variables.\"path.to.key\"",
      "table",
      R"({ min, max, step, log } or { choices }, and when = "path == value" or "path in [..]")",
      "a numeric, boolean or choice key of the scene that the search may change");
  add("prototypes.<name>.\"path.to.key\"",
      "any",
      "a value of that key",
      "a named design that is scored alongside the search");
  std::ranges::copy(goal_keys(), std::back_inserter(rows));
  add("manufacture.\"path.to.key\"",
      "table",
      "{ plus_minus } > 0, in the key's unit",
      "how exactly a key can be built: the scores' spread at the winner, 64 evaluations");
  return rows;
}

Problem unknown_path(const Study& study, const std::string& path, const Place& place) {
  std::vector<std::string> paths;
  collect_paths(study.resolved, "", paths);
  return {.kind = Problem::Kind::kUnknownKey,
          .place = place,
          .key = path,
          .text = fmt::format("the scene has no such key, the nearest one is \"{}\"",
                              nearest(path, paths))};
}

}  // namespace glint
