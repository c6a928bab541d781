// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/output_file.h"

#include <system_error>

#include "core/file.h"

namespace glint {
namespace fs = std::filesystem;

FolderOf::FolderOf(const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::error_code ignored;
  for (fs::path each = folder; !each.empty() && !fs::exists(fs::symlink_status(each, ignored));
       each = each.parent_path()) {
    made_.push_back(each);  // no link, though it lead to nothing: it was there
  }
  try {
    if (!folder.empty()) {
      make_folder(folder);
    }
  } catch (...) {
    remove_empty();
    throw;
  }
}

FolderOf::~FolderOf() {
  remove_empty();
}

void FolderOf::remove_empty() const {
  std::error_code ignored;
  for (const fs::path& folder : made_) {
    fs::remove(folder, ignored);  // only while it is empty
  }
}

}  // namespace glint
