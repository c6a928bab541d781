// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/run_folder.h"

#include <system_error>

namespace glint {
namespace fs = std::filesystem;

fs::path run_above(const fs::path& path) {
  if (path.empty()) {
    return {};
  }
  std::error_code none;
  fs::path folder = (fs::absolute(path) / ".").lexically_normal().parent_path();
  for (;; folder = folder.parent_path()) {
    if (fs::exists(folder / kRunStudy, none)) {
      return folder;
    }
    if (folder == folder.parent_path()) {
      return {};
    }
  }
}

}  // namespace glint
