// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/output_folder.h"

#include <system_error>
#include <vector>

#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// The topmost folder of a path that is not there; empty when all of it is. A link is there, though
/// it lead to nothing: nobody's to remove.
fs::path first_missing(const fs::path& path) {
  fs::path missing;
  std::error_code error;
  for (fs::path folder = path; !folder.empty(); folder = folder.parent_path()) {
    if (fs::symlink_status(folder, error).type() != fs::file_type::not_found) {
      break;
    }
    missing = folder;
    if (folder == folder.parent_path()) {
      break;
    }
  }
  return missing;
}

/// ".name.PID.part" or ".name.PID.part.extension"; the name may hold dots.
bool is_unfinished(const std::string& name) {
  const std::vector<std::string> parts = split(name, '.');
  if (parts.size() < 4 || !parts.front().empty()) {
    return false;
  }
  const auto part = parts.back() == "part" ? parts.end() - 1 : parts.end() - 2;
  const std::string& process = *(part - 1);
  return *part == "part" && !process.empty() &&
         process.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& path) : first_created_(first_missing(path)) {
  try {
    make_folder_durably(path);
  } catch (...) {
    std::error_code ignored;
    if (!first_created_.empty()) {
      fs::remove_all(first_created_, ignored);
    }
    throw;
  }
}

OutputFolder::~OutputFolder() {
  if (!first_created_.empty()) {
    std::error_code ignored;
    fs::remove_all(first_created_, ignored);
  }
}

void remove_unfinished_files(const fs::path& folder) {
  std::vector<fs::path> unfinished;
  std::error_code ignored;
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    if (is_unfinished(at->path().filename().string())) {
      unfinished.push_back(at->path());
    }
  }
  for (const fs::path& path : unfinished) {
    fs::remove(path, ignored);
  }
}

}  // namespace glint
