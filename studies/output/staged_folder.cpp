// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/staged_folder.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

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
    return entry.filename() == kResolvedScene || entry.filename() == "run.json";
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

bool has_ended(pid_t process) {
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    entries.push_back(at->path());
  }
  std::ranges::sort(entries);
  return entries;
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
