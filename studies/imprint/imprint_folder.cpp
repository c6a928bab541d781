// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint/imprint_folder.h"

#include <array>
#include <system_error>

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "studies/output/provenance.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// What a part's files are called that other programs have, too.
constexpr std::array<const char*, 5> kCommonNames = {
    "part.stl", "part.ply", "defect_map.obj", "defect_map.mtl", "defects.json"};

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

}  // namespace glint
