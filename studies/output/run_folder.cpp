// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/run_folder.h"

#include <system_error>

#include "studies/output/result_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// What `glint render` and `glint cover` write holds the study, too, and may lie in a design of a
/// run.
bool is_run(const fs::path& folder) {
  std::error_code none;
  if (!fs::exists(folder / kRunStudy, none)) {
    return false;
  }
  const auto kind = result_kind_of(folder);
  return kind != ResultKind::kRender && kind != ResultKind::kCover;
}

}  // namespace

fs::path run_above(const fs::path& path) {
  if (path.empty()) {
    return {};
  }
  fs::path folder = (fs::absolute(path) / ".").lexically_normal().parent_path();
  for (;; folder = folder.parent_path()) {
    if (is_run(folder)) {
      return folder;
    }
    if (folder == folder.parent_path()) {
      return {};
    }
  }
}

std::string name_within_run(const fs::path& path) {
  std::error_code ignored;
  const fs::path whole = without_links(path);
  const fs::path run = run_above(whole);
  if (run.empty()) {
    return name_of_source(path);
  }
  std::string name = name_of_source(run);
  const bool is_file = fs::is_regular_file(whole, ignored);
  for (const fs::path& part :
       (is_file ? whole.parent_path() / whole.stem() : whole).lexically_relative(run)) {
    if (!part.empty() && part != ".") {
      name += "_" + part.string();
    }
  }
  return name;
}

fs::path without_links(const fs::path& path) {
  std::error_code error;
  fs::path led_to = path.empty() ? path : fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path).lexically_normal() : led_to;
}

}  // namespace glint
