// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/result_folder.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/output/provenance.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

struct KindNames {
  ResultKind kind;
  std::string_view command;
  const char* folder;  ///< in out/<name>
};

constexpr auto kKinds =
    std::to_array<KindNames>({{ResultKind::kRun, "run", "run"},
                              {ResultKind::kRender, "render", "render"},
                              {ResultKind::kImprint, "imprint", "imprint"},
                              {ResultKind::kTools, "imprint --preview_tools", "tools"},
                              {ResultKind::kInspect, "inspect", "inspect"},
                              {ResultKind::kFrontier, "frontier", "frontier"},
                              {ResultKind::kCalibrate, "calibrate", "calibrate"},
                              {ResultKind::kBoard, "calibrate --print_board", "board"},
                              {ResultKind::kSensor, "calibrate --sensor", "sensor"},
                              {ResultKind::kPlan, "calibrate --plan", "plan"},
                              {ResultKind::kPoints, "calibrate --points", "points"},
                              {ResultKind::kPlace, "calibrate --place", "place"},
                              {ResultKind::kUndistort, "undistort", "undistort"},
                              {ResultKind::kCover, "cover", "cover"},
                              {ResultKind::kCompare, "compare", "compare"},
                              {ResultKind::kValidate, "validate", "validate"},
                              {ResultKind::kGrab, "cell grab", "grab"},
                              {ResultKind::kAcquire, "acquire", "acquire"},
                              {ResultKind::kViewPlan, "plan", "plan"},
                              {ResultKind::kStability, "stability", "stability"}});

const KindNames& names_of(ResultKind kind) {
  return *std::ranges::find(kKinds, kind, &KindNames::kind);
}

bool has_entry(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() != fs::file_type::not_found && !error;
}

/// The object of run.json; null when there is none that can be read.
Json run_json_in(const fs::path& folder) {
  std::error_code ignored;
  const fs::path file = folder / "run.json";
  const Json json = fs::is_regular_file(file, ignored)
                        ? Json::parse(read_file(file), nullptr, false)
                        : Json(nullptr);
  return json.is_object() ? json : Json(nullptr);
}

std::optional<ResultKind> kind_told_by(const Json& run) {
  if (!run.is_object()) {
    return std::nullopt;
  }
  if (const auto verb = run.find("verb"); verb != run.end() && verb->is_string()) {
    const auto found = std::ranges::find(kKinds, verb->get<std::string>(), &KindNames::command);
    return found != kKinds.end() ? std::optional(found->kind) : std::nullopt;
  }
  if (run.contains("inspected")) {
    return ResultKind::kInspect;
  }
  return run.contains("algorithm") ? std::optional(ResultKind::kRun) : std::nullopt;
}

/// Folders of versions whose run.json did not tell.
std::optional<ResultKind> kind_by_files(const fs::path& folder) {
  const auto has = [&](const char* name) { return has_entry(folder / name); };
  if (has(kResolvedScene) && read_file(folder / kResolvedScene).starts_with("# glint imprint:")) {
    return ResultKind::kImprint;
  }
  if (has("study.resolved.toml") && has("run.json")) {
    return ResultKind::kRender;
  }
  if (has("frontier.json") && has("frontier.html")) {
    return ResultKind::kFrontier;
  }
  return has("tools.json") && has("tools.png") ? std::optional(ResultKind::kTools) : std::nullopt;
}

/// Without those that cannot be told.
std::vector<std::string> seen_from(const fs::path& folder, const std::vector<fs::path>& sources) {
  std::vector<std::string> seen;
  for (const fs::path& source : sources) {
    seen.push_back(source_seen_from(folder, source));
  }
  std::erase(seen, "");
  return seen;
}

/// Empty: of older versions, or nothing could be told.
std::vector<std::string> sources_told_by(const Json& run) {
  std::vector<std::string> told;
  const auto source = run.is_object() ? run.find("source") : run.end();
  if (source != run.end()) {
    for (const Json& one : source->is_array() ? *source : Json::array({*source})) {
      told.push_back(one.is_string() ? one.get<std::string>() : std::string());
    }
  }
  std::erase(told, "");
  return told;
}

/// Whether a told source was removed, renamed or moved.
bool is_gone(const fs::path& source) {
  std::error_code ignored;
  return fs::status(source, ignored).type() == fs::file_type::not_found;
}

/// study.toml and scene.toml are called after their folder, and so are their results: they stand
/// for it.
fs::path named_source(const fs::path& source) {
  const fs::path file = source.filename();
  return file == "study.toml" || file == "scene.toml" ? source.parent_path() : source;
}

/// @param told, here  seen from the folder
bool is_same_source(const fs::path& folder, const std::string& told, const std::string& here) {
  std::error_code ignored;
  return told == here ||
         fs::equivalent(named_source(folder / told), named_source(folder / here), ignored);
}

/// A told source from the current folder where it lies below it, else with its full path.
std::string shown_source(const fs::path& folder, const std::string& told) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(fs::absolute(folder / told, ignored), ignored);
  if (whole.empty()) {
    return (folder / told).lexically_normal().string();
  }
  const fs::path near = whole.lexically_relative(fs::current_path(ignored));
  return (near.empty() || *near.begin() == ".." ? whole : near).string();
}

/// Refuses a folder that holds results of some verb and some study.
[[noreturn]] void throw_taken(const fs::path& folder, ResultKind kind) {
  const std::string study = study_of_folder(folder);
  throw ConfigError(fmt::format("{}: holds results of `glint {}`{}; choose another output folder",
                                folder.string(),
                                command_of(kind),
                                study.empty() ? "" : " of " + study));
}

}  // namespace

std::string_view command_of(ResultKind kind) {
  return names_of(kind).command;
}

std::optional<ResultKind> result_kind_of(const fs::path& folder) {
  if (has_entry(folder / "study.sqlite")) {
    return ResultKind::kRun;
  }
  const auto told = kind_told_by(run_json_in(folder));
  return told ? told : kind_by_files(folder);
}

void check_result_folder(const fs::path& folder,
                         ResultKind kind,
                         std::span<const std::string> names) {
  if (const auto found = result_kind_of(folder)) {
    if (*found != kind) {
      throw_taken(folder, *found);
    }
    return;
  }
  for (const std::string& name : names) {
    if (has_entry(folder / name)) {
      throw ConfigError(
          fmt::format("{}: holds a {} that is not of `glint {}`; choose another output folder",
                      folder.string(),
                      name,
                      command_of(kind)));
    }
  }
}

std::string study_of_folder(const fs::path& folder) {
  const Json run = run_json_in(folder);
  const auto study = run.is_object() ? run.find("study") : run.end();
  return study != run.end() && study->is_string() ? study->get<std::string>() : std::string();
}

void check_study_of_folder(const fs::path& folder, const std::string& study) {
  const std::string other = study_of_folder(folder);
  const auto kind = result_kind_of(folder);
  if (kind && !other.empty() && other != study) {
    throw_taken(folder, *kind);
  }
}

std::string source_seen_from(const fs::path& folder, const fs::path& source) {
  std::error_code ignored;
  if (source.empty() || fs::is_other(source, ignored)) {
    return "";
  }
  const auto whole = [&](const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  };
  return whole(source).lexically_relative(whole(folder)).generic_string();
}

Json sources_seen_from(const fs::path& folder, const std::vector<fs::path>& sources) {
  const std::vector<std::string> seen = seen_from(folder, sources);
  return seen.size() == 1 ? Json(seen.front()) : Json(seen);
}

void check_source_of_folder(const fs::path& folder, const std::vector<fs::path>& sources) {
  const std::vector<std::string> told = sources_told_by(run_json_in(folder));
  const std::vector<std::string> here = seen_from(folder, sources);
  const bool is_same = std::ranges::equal(told, here, [&](const auto& one, const auto& other) {
    return is_gone(folder / one) || is_same_source(folder, one, other);
  });
  if (here.empty() || is_same || std::ranges::all_of(told, [&](const std::string& source) {
        return is_gone(folder / source);
      })) {
    return;
  }
  std::vector<std::string> shown;
  for (const std::string& source : told) {
    shown.push_back(shown_source(folder, source));
  }
  throw ConfigError(
      fmt::format("{}: holds results of {}; choose another folder with --out, or this very one to "
                  "write there all the same",
                  folder.string(),
                  join(shown, " and ")));
}

void check_inputs_kept(std::span<const fs::path> inputs,
                       const fs::path& folder,
                       std::span<const std::string> names) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(fs::absolute(folder, ignored), ignored);
  for (const fs::path& input : inputs) {
    const fs::path inside =
        input.empty()
            ? fs::path()
            : fs::weakly_canonical(fs::absolute(input), ignored).lexically_relative(whole);
    if (!inside.empty() && std::ranges::count(names, inside.begin()->string()) > 0) {
      throw ConfigError(fmt::format(
          "{}: is read, and lies where results are written; choose another output folder than {}",
          input.string(),
          folder.string()));
    }
  }
}

void mark_result_folder(const fs::path& folder,
                        ResultKind kind,
                        const std::string& study,
                        const std::string& source) {
  if (!result_kind_of(folder)) {
    Json mark = {{"version", program_version()}, {"verb", std::string(command_of(kind))}};
    for (const auto& [name, value] : {std::pair{"study", &study}, std::pair{"source", &source}}) {
      if (!value->empty()) {
        mark[name] = *value;
      }
    }
    write_file_durably(folder / "run.json", mark.dump(2) + "\n");
  }
}

fs::path default_result_folder(const std::string& name, ResultKind kind) {
  return fs::path("out") / name / names_of(kind).folder;
}

std::string name_of_source(const fs::path& source) {
  std::error_code ignored;
  fs::path whole = fs::weakly_canonical(fs::absolute(source, ignored), ignored);
  if (whole.filename().empty()) {  // "out/gear/run/" that is not there
    whole = whole.parent_path();
  }
  if (whole.filename() == "run" || whole.filename() == "render") {
    whole = whole.parent_path();
  }
  return (fs::is_regular_file(whole, ignored) ? whole.stem() : whole.filename()).string();
}

fs::path folder_of_pictures(std::span<const fs::path> files, ResultKind kind) {
  std::error_code ignored;
  const fs::path first = files.empty() ? fs::path() : files.front();
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(first, ignored), ignored).parent_path().filename();
  return default_result_folder(folder.empty() ? "camera" : folder.string(), kind);
}

fs::path default_run_folder(const std::string& name) {
  const fs::path folder = default_result_folder(name, ResultKind::kRun);
  const fs::path older = folder.parent_path();
  const bool is_older = result_kind_of(older) == ResultKind::kRun && !result_kind_of(folder);
  return is_older ? older : folder;
}

}  // namespace glint
