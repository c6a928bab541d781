// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/scratch_folder.h"

#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"

namespace glint {
namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(const char* what) {
  std::error_code error;
  path_ = fs::temp_directory_path(error) / fmt::format("glint_check_{}", ::getpid());
  if (error || (!fs::create_directory(path_, error) && error)) {
    throw IoError(fmt::format("no scratch folder for {}: {}", what, error.message()));
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace glint
