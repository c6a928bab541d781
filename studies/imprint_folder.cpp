// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "core/file.h"
#include "core/text.h"
#include "studies/provenance.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// What a part's files are called that other programs have, too.
constexpr std::array<const char*, 5> kCommonNames = {
    "part.stl", "part.ply", "defect_map.obj", "defect_map.mtl", "defects.json"};

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    entries.push_back(at->path());
  }
  std::ranges::sort(entries);
  return entries;
}

/// Everything in a file or a folder's files; what cannot be read is told by who needs it.
std::string bytes_of(const fs::path& path) {
  std::string bytes;
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    for (const fs::path& entry : sorted_entries(path)) {
      if (fs::is_regular_file(entry, ignored)) {
        bytes += fmt::format("{} {}\n", entry.filename().string(), sha256_hex(read_file(entry)));
      }
    }
  } else if (fs::is_regular_file(path, ignored)) {
    bytes = sha256_hex(read_file(path)) + "\n";
  }
  return bytes;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// ".name.PID.part": the process; 0 for other names.
pid_t process_of(const std::string& name) {
  const std::vector<std::string> parts = split(name, '.');
  if (parts.size() != 4 || !parts.front().empty() || parts[3] != "part" || parts[2].empty() ||
      parts[2].size() > 9 || parts[2].find_first_not_of("0123456789") != std::string::npos) {
    return 0;
  }
  return static_cast<pid_t>(std::stol(parts[2]));
}

/// Moves what is in a folder into another one that may hold files already; folders are merged.
void move_entries(const fs::path& from, const fs::path& to) {
  std::vector<fs::path> entries = sorted_entries(from);
  // What tells whose files these are comes first.
  std::stable_partition(entries.begin(), entries.end(), [](const fs::path& entry) {
    return entry.filename() == kResolvedScene;
  });
  for (const fs::path& entry : entries) {
    const fs::path goal = to / entry.filename();
    std::error_code error;
    if (fs::is_directory(entry, error)) {
      make_folder(goal);
      move_entries(entry, goal);
      continue;
    }
    fs::rename(entry, goal, error);
    if (error) {
      throw IoError(fmt::format("{}: cannot be written: {}", goal.string(), error.message()));
    }
  }
}

/// The folder may be the scene's own, with the user's part in it.
void check_no_foreign_part(const fs::path& out) {
  std::error_code ignored;
  for (const char* name : kCommonNames) {
    if (fs::exists(out / name, ignored)) {
      throw ConfigError(
          fmt::format("{}: holds a {} that is not of `glint imprint`; choose another output folder",
                      out.string(),
                      name));
    }
  }
}

bool has_ended(pid_t process) {
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

std::string marked_scene_text(const Study& study, bool is_many) {
  std::string content = config_hash(study) + "\n" + program_version() + "\n";
  for (const auto& [name, group] : study.scene.defects) {
    content += name + "\n" + bytes_of(group.tool_folder) + bytes_of(group.region.file);
  }
  return fmt::format("# glint imprint: {}, configuration {}\n{}",
                     is_many ? "numbered parts" : "one part",
                     sha256_hex(content),
                     resolved_text(study));
}

void check_imprint_folder(const fs::path& out, const std::string& marked_scene) {
  std::error_code ignored;
  if (fs::exists(out / "study.sqlite", ignored)) {
    throw ConfigError(
        fmt::format("{}: holds the run of a study; choose another output folder", out.string()));
  }
  const fs::path scene = out / kResolvedScene;
  if (!fs::exists(scene, ignored)) {
    check_no_foreign_part(out);
  } else if (first_line(read_file(scene)) != first_line(marked_scene)) {
    throw ConfigError(
        fmt::format("{}: holds parts of another configuration; choose another output folder, or "
                    "remove this one",
                    out.string()));
  }
}

void remove_stale_stages(const fs::path& out) {
  std::error_code ignored;
  for (const fs::path& entry : sorted_entries(out)) {
    const pid_t process = process_of(entry.filename().string());
    if (process > 0 && fs::is_directory(entry, ignored) && has_ended(process)) {
      fs::remove_all(entry, ignored);
    }
  }
}

StagedFolder::StagedFolder(fs::path out, std::string name)
    : out_(std::move(out)),
      name_(std::move(name)),
      path_(out_ / fmt::format(".{}.{}.part", name_.empty() ? "whole" : name_, ::getpid())) {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  make_folder(path_);
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void StagedFolder::commit() {
  std::error_code error;
  if (!name_.empty()) {
    fs::rename(path_, out_ / name_, error);
    std::error_code ignored;
    if (error && !fs::is_directory(out_ / name_, ignored)) {
      throw IoError(fmt::format(
          "{}: the folder cannot be made: {}", (out_ / name_).string(), error.message()));
    }
    return;
  }
  move_entries(path_, out_);
}

}  // namespace glint
