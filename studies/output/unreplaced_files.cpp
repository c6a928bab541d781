// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/unreplaced_files.h"

#include <algorithm>
#include <system_error>

namespace glint {
namespace fs = std::filesystem;

namespace {

/// A file itself, or all files below a folder.
std::vector<fs::path> files_of_entry(const fs::path& entry) {
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(entry, ignored);
  if (fs::is_regular_file(status)) {
    return {entry};
  }
  std::vector<fs::path> files;
  if (fs::is_directory(status)) {
    for (fs::recursive_directory_iterator at(entry, ignored), end; at != end;
         at.increment(ignored)) {
      if (fs::is_regular_file(at->symlink_status(ignored))) {
        files.push_back(at->path());
      }
    }
  }
  return files;
}

}  // namespace

std::vector<fs::path> unreplaced_files(const fs::path& out,
                                       const fs::path& stage,
                                       std::span<const fs::path> entries,
                                       std::span<const fs::path> kept) {
  std::vector<fs::path> found;
  for (const fs::path& entry : entries) {
    for (const fs::path& file : files_of_entry(out / entry)) {
      const fs::path relative = file.lexically_relative(out);
      std::error_code ignored;
      const bool is_kept = std::ranges::any_of(kept, [&](const fs::path& read) {
        return !read.empty() && fs::equivalent(read, file, ignored);
      });
      if (!is_kept && !fs::exists(stage / relative, ignored)) {
        found.push_back(relative);
      }
    }
  }
  return found;
}

void remove_unreplaced(const fs::path& out, std::span<const fs::path> files) {
  std::error_code ignored;
  for (const fs::path& file : files) {
    fs::remove(out / file, ignored);
    for (fs::path folder = file.parent_path(); !folder.empty(); folder = folder.parent_path()) {
      if (!fs::remove(out / folder, ignored)) {  // is not empty
        break;
      }
    }
  }
}

}  // namespace glint
