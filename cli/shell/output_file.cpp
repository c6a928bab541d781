// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/output_file.h"

#include "core/file.h"

namespace glint {

void make_folder_of(const std::filesystem::path& file) {
  if (file.has_parent_path()) {
    make_folder(file.parent_path());
  }
}

}  // namespace glint
