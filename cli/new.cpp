// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/output_file.h"
#include "core/config/toml.h"
#include "core/file.h"
#include "core/shell_word.h"
#include "core/text.h"
#include "studies/starter/starter.h"

namespace glint {
namespace {

/// The camera's data sheet as TOML keys: from a file, or from "key=value,key=value"; empty for one
/// that shows the whole part.
std::string camera_keys(const NewArguments& arguments) {
  if (arguments.camera.empty()) {
    return "";
  }
  std::error_code ignored;
  if (std::filesystem::exists(arguments.camera, ignored)) {
    const ConfigNode root = load_toml(arguments.camera);
    const ConfigNode* camera = root.find("camera");
    return to_toml(camera != nullptr ? *camera : root);
  }
  std::string keys;
  for (const std::string& pair : split(arguments.camera, ',')) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos) {
      throw ConfigError(fmt::format(
          "--camera {}: is no file, and \"{}\" is no key=value", arguments.camera, pair));
    }
    keys += fmt::format("{} = {}\n", pair.substr(0, equals), pair.substr(equals + 1));
  }
  return keys;
}

/// The part's file as the study names it: relative to the study.
std::string part_path(const NewArguments& arguments) {
  const std::filesystem::path folder =
      std::filesystem::absolute(arguments.out.empty() ? "study.toml" : arguments.out)
          .lexically_normal()
          .parent_path();
  const std::filesystem::path part = std::filesystem::absolute(arguments.part).lexically_normal();
  return part.lexically_relative(folder).generic_string();
}

PartSettings part_settings(const NewArguments& arguments) {
  ConfigNode table = ConfigNode::table();
  set_path(table, "file", ConfigNode::from_text(arguments.part.string()));
  set_path(table, "unit", ConfigNode::from_text(arguments.unit));
  std::vector<Problem> errors;
  PartSettings settings;
  KeyReader reader(&table, "part", errors);
  visit_keys(reader, settings);
  throw_if_any(errors);
  return settings;
}

/// The light of that name, one of those that the command line allows.
StarterLight light_of(const std::string& name) {
  constexpr std::array kLights = {StarterLight::kTunnel,
                                  StarterLight::kRing,
                                  StarterLight::kDome,
                                  StarterLight::kBar,
                                  StarterLight::kAll};
  return *std::ranges::find(kLights, name, light_name);
}

void check_files(const NewArguments& arguments) {
  if (std::error_code ignored; !std::filesystem::exists(arguments.part, ignored)) {
    throw IoError(arguments.part.string() + ": cannot be read: No such file or directory");
  }
  if (!arguments.out.empty() && std::filesystem::exists(arguments.out)) {
    throw ConfigError(arguments.out.string() + ": exists already; give --out another name");
  }
}

/// With the study itself or the name of its file.
nlohmann::ordered_json told_of(const Starter& starter, const char* key, const std::string& study) {
  return {{"schema", 1},
          {"status", "done"},
          {key, study},
          {"is_dent_visible", starter.is_dent_visible},
          {"start_score", starter.start_score},
          {"notes", starter.notes}};
}

int write_starter(const NewArguments& arguments, const CommonArguments& common) {
  check_files(arguments);
  const Starter starter =
      make_starter({.part = part_settings(arguments),
                    .part_file = part_path(arguments),
                    .unit = arguments.unit,
                    .study_file = arguments.out.empty() ? "study.toml" : arguments.out.string(),
                    .camera_keys = camera_keys(arguments),
                    .working_distance_mm = arguments.working_distance_mm,
                    .light = light_of(arguments.light),
                    .threads = common.threads});
  if (arguments.out.empty()) {
    print_result(common, told_of(starter, "text", starter.text), starter.text);
    return kExitDone;
  }
  const FolderOf folder(arguments.out);
  write_file(arguments.out, starter.text);
  load_study(arguments.out, {});
  std::string text = fmt::format("written: {}\n", arguments.out.string());
  for (const std::string& note : starter.notes) {
    text += "  note: " + note + "\n";
  }
  print_result(common,
               told_of(starter, "study", arguments.out.string()),
               text + fmt::format("next: glint check {}\n", shell_word(arguments.out.string())));
  return kExitDone;
}

}  // namespace

int new_command(const NewArguments& arguments, const CommonArguments& common) {
  try {
    return write_starter(arguments, common);
  } catch (const ConfigError& error) {
    throw with_option_names(error);
  }
}

}  // namespace glint
