// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint/imprint_folder.h"
#include "studies/definition/study_text.h"

#include <system_error>

#include <fmt/format.h>

#include "core/file.h"
#include "core/text.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

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

/// " (part.radius_mm is 7, was 8)"; empty: a file, the program or the kind of folder differs.
std::string differences_text(std::vector<std::string> changes) {
  constexpr std::size_t kMaxTold = 3;
  if (changes.size() > kMaxTold) {
    const std::string more = fmt::format("{} more", changes.size() - kMaxTold);
    changes.resize(kMaxTold);
    changes.push_back(more);
  }
  return changes.empty() ? std::string() : fmt::format(" ({})", join(changes, ", "));
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

std::string part_name(int part) {
  return fmt::format("part_{:04d}", part);
}

std::vector<std::string> names_of_imprint(int count) {
  if (count == 0) {  // the folder may be the scene's own, with the user's part in it
    return {"part.stl",
            "part.ply",
            "defect_map.obj",
            "defect_map.mtl",
            "defects.json",
            "preview_defects.png",
            kResolvedScene,
            "run.json"};
  }
  std::vector<std::string> names = {"parts.json", kResolvedScene, "run.json"};
  for (int part = 0; part < count; ++part) {
    names.push_back(part_name(part));
  }
  return names;
}

void check_imprint_folder(const fs::path& out, const Study& study, int count) {
  check_result_folder(out, ResultKind::kImprint, names_of_imprint(count));
  const fs::path scene = out / kResolvedScene;
  std::error_code ignored;
  if (!fs::exists(scene, ignored)) {
    return;
  }
  const std::string there = read_file(scene);
  if (first_line(there) != first_line(marked_scene_text(study, count > 0))) {
    throw ConfigError(
        fmt::format("{}: holds parts of another configuration{}; choose another output folder, or "
                    "remove this one",
                    out.string(),
                    differences_text(change_texts(changed_keys(study, there)))));
  }
}

}  // namespace glint
