// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_folder.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "core/error.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kLimits = "grading.toml";

std::vector<std::string> names_written(std::span<const PicturedPart> parts) {
  std::vector<std::string> names = {
      "result.json", "run.json", "report.html", "defects.csv", kLimits};
  for (const PicturedPart& part : parts) {
    names.push_back(part.name);
  }
  return names;
}

/// An inspection that is there already: of these parts, and none whose limits would stay behind.
void check_earlier(const fs::path& out, std::span<const std::string> names, bool is_learning) {
  std::error_code ignored;
  for (const fs::path& entry : sorted_entries(out)) {
    const std::string name = entry.filename().string();
    if (fs::is_directory(entry, ignored) && !name.starts_with(".") &&
        std::ranges::count(names, name) == 0) {
      throw ConfigError(
          fmt::format("{}: holds the inspection of another part, {}; choose another output folder, "
                      "or remove this one",
                      out.string(),
                      name));
    }
  }
  if (!is_learning && fs::exists(out / kLimits, ignored)) {
    throw ConfigError(
        fmt::format("{}: holds {}, the limits that an earlier inspection has learned; choose "
                    "another output folder, or move that file",
                    out.string(),
                    kLimits));
  }
}

}  // namespace

fs::path source_of_inspection(std::span<const fs::path> inputs) {
  std::error_code ignored;
  fs::path named = fs::weakly_canonical(fs::absolute(inputs.front(), ignored), ignored);
  if (named.filename().empty()) {  // "parts/a/"
    named = named.parent_path();
  }
  const bool is_of_verb = named.filename() == "run" || named.filename() == "render";
  if (inputs.size() > 1 || is_of_verb) {
    named = named.parent_path();
  }
  return named;
}

fs::path default_inspect_folder(std::span<const fs::path> inputs) {
  std::error_code ignored;
  const fs::path named = source_of_inspection(inputs);
  const fs::path name = fs::is_directory(named, ignored) ? named.filename() : named.stem();
  return default_result_folder(name.empty() ? "part" : name.string(), ResultKind::kInspect);
}

void check_inspect_folder(const fs::path& out,
                          std::span<const PicturedPart> parts,
                          std::span<const fs::path> inputs,
                          bool is_learning) {
  const std::vector<std::string> names = names_written(parts);
  std::vector<fs::path> read(inputs.begin(), inputs.end());
  for (const PicturedPart& part : parts) {
    read.insert(read.end(), part.pictures.begin(), part.pictures.end());
    read.insert(read.end(), {part.mask, part.scene, part.truth});
  }
  check_inputs_kept(read, out, names);
  check_result_folder(out, ResultKind::kInspect, names);
  if (result_kind_of(out)) {
    check_earlier(out, names, is_learning);
  }
}

void remove_outdated_maps(const fs::path& out,
                          const fs::path& stage,
                          std::span<const PicturedPart> parts) {
  std::error_code ignored;
  for (const PicturedPart& part : parts) {
    for (const char* name : {"modulation.exr", "phase_rad.exr"}) {
      if (!fs::exists(stage / part.name / name, ignored)) {
        fs::remove(out / part.name / name, ignored);
      }
    }
  }
}

}  // namespace glint
