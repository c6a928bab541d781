// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whose results a folder holds. A folder takes the results of one verb only, files that are of
// nobody known are left alone, and what a verb reads it does not overwrite.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// What makes folders of results.
enum class ResultKind {
  kRun,
  kRender,
  kImprint,
  kTools,
  kInspect,
  kFrontier,
  kCalibrate,
  kBoard,
  kSensor,
  kPlan,
  kPoints,
  kPlace,
  kUndistort,
  kCover,
  kCompare,
  kValidate,
  kGrab,
  kAcquire,
  kViewPlan,
  kStability
};

/// As it is typed: "run", "render", "imprint", "imprint --preview_tools", "inspect", "frontier",
/// "calibrate", "calibrate --print_board", "calibrate --sensor", "calibrate --plan",
/// "calibrate --points", "calibrate --place", "undistort", "cover", "compare", "validate",
/// "cell grab", "acquire", "plan", "stability".
std::string_view command_of(ResultKind kind);

/// Whose results a folder holds: by the field "verb" of its run.json, in folders of older versions
/// by what is in them. Empty: it is no folder of results.
std::optional<ResultKind> result_kind_of(const std::filesystem::path& folder);

/// Asks before anything is written.
/// @param names  files and folders directly in `folder` that the results consist of
/// @throws ConfigError when the folder holds results of another kind, or, being no folder of
///         results, something of one of these names
void check_result_folder(const std::filesystem::path& folder,
                         ResultKind kind,
                         std::span<const std::string> names);

/// The study that run.json tells; empty: it does not tell one.
std::string study_of_folder(const std::filesystem::path& folder);

/// Asks before anything is written.
/// @throws ConfigError when run.json tells another study than this one
void check_study_of_folder(const std::filesystem::path& folder, const std::string& study);

/// How run.json tells what results were made of, as `source`: seen from the folder of the results,
/// so that both may be moved together; links are followed. Empty: there is nothing to tell, as of
/// a study that came through a pipe.
std::string source_seen_from(const std::filesystem::path& folder,
                             const std::filesystem::path& source);

/// The same of several inputs: a text for one, a list for more.
nlohmann::ordered_json sources_seen_from(const std::filesystem::path& folder,
                                         const std::vector<std::filesystem::path>& sources);

/// Asks before anything is written to a default folder, which is called after what is read:
/// out/pictures/calibrate is that of all folders which are called "pictures", out/gear/render that
/// of each gear.toml. Not to be asked of a folder that was given with --out. The same file by a
/// link is the same, study.toml and scene.toml of one folder share theirs, and what is gone cannot
/// be another one's.
/// @param sources  what the results are to be made of, as sources_seen_from() tells it
/// @throws ConfigError when run.json tells other sources than these
void check_source_of_folder(const std::filesystem::path& folder,
                            const std::vector<std::filesystem::path>& sources);

/// @param inputs  files that are read; an empty path is none
/// @param names   as above
/// @throws ConfigError naming an input that is one of these files or lies in one of these folders
void check_inputs_kept(std::span<const std::filesystem::path> inputs,
                       const std::filesystem::path& folder,
                       std::span<const std::string> names);

/// Writes a run.json that tells whose folder it is, where nothing tells it yet: for results whose
/// files appear one by one. The run.json of the finished results replaces it.
/// @param study   whose results they are; empty: of none
/// @param source  as source_seen_from() tells the study's file; empty: of none
/// @throws IoError
void mark_result_folder(const std::filesystem::path& folder,
                        ResultKind kind,
                        const std::string& study = "",
                        const std::string& source = "");

/// Where results go unless --out tells: out/<name>/<last word of the command>.
std::filesystem::path default_result_folder(const std::string& name, ResultKind kind);

/// What results made of a file or folder are called: by its name, or that of the folder around it
/// where it is one of a run or a rendering. "gear" of out/gear/run, gear and gear.png. Empty: it
/// has no name.
std::string name_of_source(const std::filesystem::path& source);

/// The same with the name of the folder that the first file is in.
std::filesystem::path folder_of_pictures(std::span<const std::filesystem::path> files,
                                         ResultKind kind);

/// The same of a study's run; the folder of older versions, out/<name>, when a run is there and
/// none in the new one.
std::filesystem::path default_run_folder(const std::string& name);

}  // namespace glint
