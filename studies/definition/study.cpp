// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/definition/accuracy_table.h"
#include "studies/definition/manufacture.h"
#include "studies/definition/overrides.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/study_goal.h"
#include "studies/definition/study_tables.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Kind = ConfigNode::Kind;

const std::vector<std::string>& study_tables() {
  static const std::vector<std::string> names = {"schema",
                                                 "title",
                                                 "variables",
                                                 "prototypes",
                                                 "objective",
                                                 "choice",
                                                 "constraints",
                                                 "search",
                                                 "budget",
                                                 "sorting",
                                                 "pod",
                                                 "calibration_trial",
                                                 "manufacture",
                                                 "accuracy"};
  return names;
}

void check_tables(const ConfigNode& root, std::vector<Problem>& errors) {
  std::vector<std::string> known = scene_tables();
  known.insert(known.end(), study_tables().begin(), study_tables().end());
  for (const char* name : {"variables", "prototypes", "objective", "constraints", "choice"}) {
    const ConfigNode* table = root.find(name);
    const bool is_list =
        name == std::string_view("objective") && table != nullptr && table->is_array();
    if (table != nullptr && !table->is_table() && !is_list) {
      errors.push_back({.kind = Problem::Kind::kWrongType,
                        .place = table->place,
                        .key = name,
                        .text = fmt::format("must be a table, like [{}]", name)});
    }
  }
  for (std::size_t i = 0; i < root.names.size(); ++i) {
    if (std::ranges::find(known, root.names[i]) == known.end()) {
      errors.push_back({.kind = Problem::Kind::kUnknownKey,
                        .place = root.items[i].place,
                        .key = root.names[i],
                        .text = fmt::format("unknown table, the nearest known one is \"{}\"",
                                            nearest(root.names[i], known))});
    }
  }
}

ConfigNode value_node(const Variable& variable, double value, const ConfigNode& like) {
  ConfigNode node;
  switch (variable.kind) {
    case Variable::Kind::kFloat:
      node = ConfigNode::from_number(value);
      break;
    case Variable::Kind::kInteger:
      node = ConfigNode::from_integer(static_cast<std::int64_t>(std::llround(value)));
      break;
    case Variable::Kind::kChoice: {
      const std::string& choice = variable.choices[static_cast<std::size_t>(std::llround(value))];
      node = like.kind == Kind::kBoolean ? ConfigNode::from_boolean(choice == "true")
                                         : ConfigNode::from_text(choice);
      break;
    }
  }
  node.place = like.place;
  return node;
}

/// The study's scene with other values, of which only the tables they stand in are read again.
SceneSettings read_with(const Study& study,
                        const Overrides& overrides,
                        std::vector<Problem>& errors) {
  ConfigNode changed = ConfigNode::table();
  changed.place = study.root.place;
  for (const auto& [path, value] : overrides) {
    if (study.resolved.at_path(path) == nullptr) {
      throw ConfigError(unknown_path(study, path, value.place));
    }
    const std::string table = path.substr(0, path.find('.'));
    const ConfigNode* own = study.root.find(table);
    if (own != nullptr && changed.find(table) == nullptr) {
      changed.names.push_back(table);
      changed.items.push_back(*own);
    }
    put_override(changed, study.resolved, path, value);
  }
  SceneSettings scene = study.scene;
  reread_scene(study.root, changed, scene, errors);
  return scene;
}

/// A problem at the place of its key, or of the file where the key is not written.
Problem problem_of(const ConfigNode& root, const char* key, std::string text) {
  const ConfigNode* node = root.at_path(key);
  return {.kind = Problem::Kind::kRelation,
          .place = node != nullptr ? node->place : Place{.file = root.place.file},
          .key = key,
          .text = std::move(text)};
}

/// What a search needs and path-traced scenes do not have.
void check_derivatives(const Study& study, std::vector<Problem>& errors) {
  const bool is_asked = study.search.derivatives;
  const auto fail = [&](const std::string& why) {
    const std::string who =
        is_asked ? "asks for" : fmt::format("\"{}\" needs", study.search.algorithm);
    const char* allowed =
        is_asked ? "allowed is false" : "allowed are algorithms that do without, such as \"auto\"";
    errors.push_back(problem_of(study.root,
                                is_asked ? "search.derivatives" : "search.algorithm",
                                fmt::format("{} derivatives, which {}; {}", who, why, allowed)));
  };
  if (study.has_search() && study.scene.expose_to > 0.0 && wants_derivatives(study)) {
    fail("are not known where sensor.expose_to sets the exposure");
  }
  if (study.has_search() && needs_paths(study.scene) && wants_derivatives(study)) {
    fail("path-traced scenes do not have");
  }
  if (study.has_search() && is_blurred(study.scene) && wants_derivatives(study)) {
    fail("blurred reflections do not have");
  }
}

/// search.derivatives works with a single objective and the Gaussian process only.
void check_algorithm(const Study& study, std::vector<Problem>& errors) {
  check_derivatives(study, errors);
  const std::string& algorithm = study.search.algorithm;
  std::string text;
  if (study.search.derivatives && algorithm != "auto" && algorithm != "gp") {
    text = fmt::format(
        "is available only with search.algorithm = \"auto\" or \"gp\", not with \"{}\"{}; allowed "
        "is false",
        algorithm,
        needs_gradient(algorithm) ? ", which takes derivatives in any case" : "");
  } else if (study.search.derivatives && has_several_objectives(study.goal)) {
    text = "works with a single objective only, this study has several; allowed is false";
  }
  if (!text.empty()) {
    errors.push_back(problem_of(study.root, "search.derivatives", text));
  }
}

/// Whether a problem is one of this key, or of the array that holds it as a number.
bool is_of_key(const Problem& problem, const std::string& key) {
  const auto dot = key.rfind('.');
  const bool is_item = key.find_first_not_of("0123456789", dot + 1) == std::string::npos;
  return problem.key == key || (is_item && problem.key == key.substr(0, dot));
}

/// Both ends of every variable must be values the scene accepts.
void check_variable_limits(const Study& study, std::vector<Problem>& errors) {
  for (const Variable& variable : study.space.variables) {
    const ConfigNode* where = study.root.find("variables")->find(variable.name);
    if (variable.name.starts_with("viewpoint.") &&
        study.scene.viewpoint_set.source != ViewpointSource::kListed) {
      errors.push_back({.kind = Problem::Kind::kRelation,
                        .place = where->place,
                        .context = "variables",
                        .key = variable.name,
                        .text = "has no effect, as [viewpoints] defines the poses; allowed with "
                                "source = \"listed\""});
    }
    const auto count =
        variable.kind == Variable::Kind::kChoice ? variable.choices.size() : std::size_t{2};
    for (std::size_t i = 0; i < count; ++i) {
      const double value = variable.kind == Variable::Kind::kChoice ? static_cast<double>(i)
                           : i == 0                                 ? variable.low
                                                                    : variable.high;
      const ConfigNode node = value_node(variable, value, *study.resolved.at_path(variable.name));
      std::vector<Problem> problems;
      read_with(study, {{variable.name, node}}, problems);
      for (Problem& problem : problems) {
        // Conditions between keys depend on the other variables; a key's own range does not.
        if (problem.kind == Problem::Kind::kOutOfRange && is_of_key(problem, variable.name)) {
          problem.place = where->place;
          problem.context = "variables";
          problem.key = variable.name;
          errors.push_back(std::move(problem));
        }
      }
    }
  }
}

/// A prototype's name is the name of its folder beside baseline/ and winner/.
bool is_prototype_name(const std::string& name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !name.empty() && std::ranges::all_of(name, is_plain) && name != "baseline" &&
         name != "winner";
}

void read_prototypes(Study& study, std::vector<Problem>& errors) {
  const ConfigNode* prototypes = study.root.find("prototypes");
  if (prototypes == nullptr) {
    return;
  }
  for (std::size_t i = 0; i < prototypes->names.size(); ++i) {
    const ConfigNode& table = prototypes->items[i];
    const std::string path = "prototypes." + prototypes->names[i];
    if (!table.is_table()) {
      errors.push_back({.kind = Problem::Kind::kWrongType,
                        .place = table.place,
                        .key = path,
                        .text = "must be a table of \"path.to.key\" = value"});
      continue;
    }
    if (!is_prototype_name(prototypes->names[i])) {
      errors.push_back(
          {.place = table.place,
           .key = "prototypes",
           .text = fmt::format("\"{}\" is to be the name of a folder; allowed are letters, "
                               "digits, _ and -, but not baseline and winner",
                               prototypes->names[i])});
      continue;
    }
    Prototype prototype{.name = prototypes->names[i],
                        .title = prototypes->names[i],
                        .overrides = {},
                        .place = table.place};
    for (std::size_t k = 0; k < table.names.size(); ++k) {
      if (table.names[k] == "title") {
        prototype.title = table.items[k].text;
        if (table.items[k].kind != Kind::kText) {
          errors.push_back({.kind = Problem::Kind::kWrongType,
                            .place = table.items[k].place,
                            .key = path + ".title",
                            .text = "must be a text in quotes"});
        }
      } else {
        prototype.overrides.emplace_back(table.names[k], table.items[k]);
      }
    }
    try {
      scene_with(study, prototype.overrides);
    } catch (const ConfigError& error) {
      std::ranges::copy(in_context(error, path).problems(), std::back_inserter(errors));
    }
    study.prototypes.push_back(std::move(prototype));
  }
}

/// A file that describes nothing would be the default scene, which nobody asked for.
void check_holds_scene(const ConfigNode& root, std::vector<Problem>& errors) {
  const auto is_table = [](const std::string& name) { return name != "schema" && name != "title"; };
  if (std::ranges::none_of(root.names, is_table)) {
    errors.push_back({.place = {.file = root.place.file},
                      .text = fmt::format("describes no scene; it must hold at least one of the "
                                          "tables [{}]",
                                          fmt::join(scene_tables(), "] ["))});
  }
}

/// The files that values of a tree were written in: its own and those it includes.
void add_files_of(const ConfigNode& node, std::vector<fs::path>& files) {
  files.emplace_back(node.place.file);
  for (const ConfigNode& item : node.items) {
    add_files_of(item, files);
  }
}

/// What a scene's pictures and its defects are made of.
void add_files_of(const SceneSettings& scene, std::vector<fs::path>& files) {
  std::ranges::copy(input_files(scene), std::back_inserter(files));
  for (const auto& [name, group] : scene.defects) {
    files.push_back(group.region.file);
    files.push_back(group.tool_folder);
  }
}

}  // namespace

std::vector<fs::path> input_files(const Study& study) {
  std::vector<fs::path> files;
  add_files_of(study.root, files);
  add_files_of(study.scene, files);
  for (const Prototype& prototype : study.prototypes) {
    add_files_of(scene_with(study, prototype.overrides), files);
  }
  if (study.calibration_trial) {
    files.push_back(study.calibration_trial->board);
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  std::erase_if(files, [](const fs::path& file) { return file.empty(); });
  return files;
}

Study load_study(const fs::path& path, const std::vector<KeyValue>& sets, SceneUse use) {
  Study study;
  study.root = load_toml(path);
  study.root.place.file = path.string();
  for (const KeyValue& set : sets) {
    put_set(study.root, set.path, set.value);
  }
  const std::string stem = path.stem().string();
  const std::string folder = fs::absolute(path).parent_path().filename().string();
  study.name = stem == "study" || stem == "scene" ? folder : stem;
  std::vector<Problem> errors;
  check_tables(study.root, errors);
  check_holds_scene(study.root, errors);
  study.scene = read_scene(study.root, errors, use);
  throw_if_any_of_scene(study.root, errors);  // what follows builds on one that can be read
  study.resolved = write_scene(study.scene);
  read_study_tables(study, errors);
  throw_if_any(errors);
  check_goal(study, errors);
  check_algorithm(study, errors);
  check_variable_limits(study, errors);
  read_prototypes(study, errors);
  throw_if_any(errors);
  read_tolerances(study, errors);
  check_accuracy(study, errors);
  throw_if_any(errors);
  return study;
}

bool wants_derivatives(const Study& study) {
  return study.search.derivatives || needs_gradient(study.search.algorithm);
}

Study scene_study(Study study) {
  for (const char* table : {"variables",
                            "prototypes",
                            "objective",
                            "choice",
                            "constraints",
                            "sorting",
                            "pod",
                            "calibration_trial",
                            "manufacture",
                            "accuracy"}) {
    for (std::size_t i = study.root.names.size(); i-- > 0;) {
      if (study.root.names[i] == table) {
        study.root.names.erase(study.root.names.begin() + static_cast<std::ptrdiff_t>(i));
        study.root.items.erase(study.root.items.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
  }
  study.space = {};
  study.goal = {};
  study.has_objective = false;
  study.prototypes.clear();
  study.sorting.reset();
  study.pod.reset();
  study.calibration_trial.reset();
  study.accuracy.reset();
  return study;
}

ConfigError prototype_error(const Prototype& prototype, const ConfigError& error) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    problem.place = prototype.place;
    for (const auto& [path, value] : prototype.overrides) {
      if (path == problem.key) {
        problem.place = value.place;
      }
    }
  }
  return in_context(ConfigError(std::move(problems)), "prototypes." + prototype.name);
}

SceneSettings scene_with(const Study& study, const Overrides& overrides) {
  std::vector<Problem> errors;
  SceneSettings scene = read_with(study, overrides, errors);
  throw_if_any(errors);
  return scene;
}

Overrides overrides_of(const Study& study, const Point& point) {
  Overrides overrides;
  for (std::size_t i = 0; i < study.space.variables.size(); ++i) {
    const Variable& variable = study.space.variables[i];
    if (is_active(study.space, point, i)) {
      overrides.emplace_back(
          variable.name, value_node(variable, point[i], *study.resolved.at_path(variable.name)));
    }
  }
  return overrides;
}

Point baseline_point(const Study& study) {
  Point point;
  for (const Variable& variable : study.space.variables) {
    const ConfigNode& node = *study.resolved.at_path(variable.name);
    if (variable.kind == Variable::Kind::kChoice) {
      const std::string text =
          node.kind == Kind::kBoolean ? (node.boolean ? "true" : "false") : node.text;
      const auto found = std::ranges::find(variable.choices, text);
      point.push_back(found == variable.choices.end()
                          ? 0.0
                          : static_cast<double>(found - variable.choices.begin()));
    } else {
      point.push_back(node.number);
    }
  }
  return canonical(study.space, point);
}

std::optional<double> parse_duration_s(const std::string& text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  double total_s = 0.0;
  if (at == end) {
    return std::nullopt;
  }
  while (at != end) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || value < 0.0 || !std::isfinite(value)) {
      return std::nullopt;
    }
    const char unit = next == end ? 's' : *next;
    const double factor = unit == 's' ? 1.0 : unit == 'm' ? 60.0 : unit == 'h' ? 3600.0 : 0.0;
    if (factor == 0.0) {
      return std::nullopt;
    }
    total_s += value * factor;
    at = next == end ? end : next + 1;
  }
  return total_s;
}

}  // namespace glint
