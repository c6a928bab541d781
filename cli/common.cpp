// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/file.h"
#include "studies/output/run_folder.h"

namespace glint {

std::vector<KeyValue> key_values(const std::vector<std::string>& sets) {
  std::vector<KeyValue> values;
  for (const std::string& set : sets) {
    const auto equals = set.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw ConfigError(fmt::format("--set {}: must be key=value", set));
    }
    values.push_back({.path = set.substr(0, equals), .value = set.substr(equals + 1)});
  }
  return values;
}

ConfigError with_option_names(const ConfigError& error) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    for (const char* option : {"unit", "crease_deg"}) {
      if (problem.key == fmt::format("part.{}", option)) {
        problem.key = fmt::format("--{}", option);
      }
    }
  }
  return ConfigError(std::move(problems));
}

Study load_study(const StudyArguments& arguments, SceneUse use) {
  std::vector<KeyValue> sets = key_values(arguments.sets);
  if (arguments.seed) {
    sets.push_back({.path = "search.seed", .value = fmt::format("{}", *arguments.seed)});
  }
  Study study = load_study(arguments.study, sets, use);
  if (!arguments.budget.empty()) {
    const auto seconds = parse_duration_s(arguments.budget);
    if (!seconds || *seconds <= 0.0) {
      throw ConfigError(
          fmt::format("--budget {}: must be a duration like 40s, 30m or 8h", arguments.budget));
    }
    study.budget.wall_clock_s = *seconds;
  }
  return study;
}

namespace {

/// What a default folder is called after: the study, before it the run that its file lies in, as
/// each has a winner. Parts that are imprinted go on where those of earlier versions are.
std::string name_of_results(const std::filesystem::path& file,
                            const Study& study,
                            ResultKind kind) {
  const std::filesystem::path run = run_above(without_links(file));
  const bool is_of_run = !run.empty() && kind != ResultKind::kImprint && kind != ResultKind::kTools;
  return is_of_run ? name_of_source(run) + "_" + study.name : study.name;
}

}  // namespace

std::filesystem::path out_folder(const StudyArguments& arguments,
                                 const Study& study,
                                 ResultKind kind) {
  if (!arguments.out.empty()) {
    return arguments.out;
  }
  const std::string name = name_of_results(arguments.study, study, kind);
  std::filesystem::path folder =
      kind == ResultKind::kRun ? default_run_folder(study.name) : default_result_folder(name, kind);
  check_source_of_folder(folder, {arguments.study});
  return folder;
}

void print_result(const CommonArguments& common,
                  const nlohmann::ordered_json& json,
                  const std::string& text) {
  if (common.is_json) {
    std::cout << json.dump(2) << "\n";
  } else if (!common.is_quiet) {
    std::cout << text;
  }
  std::cout.flush();
  if (!std::cout) {
    throw IoError("stdout: cannot be written");
  }
}

}  // namespace glint
