// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate_cell/validation_steps.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/file.h"
#include "core/shell_word.h"
#include "studies/validate/validated_designs.h"

namespace glint {

std::vector<std::string> designs_to_validate(const Study& study) {
  if (study.scene.validate && !study.scene.validate->designs.empty()) {
    return names_in(study.scene.validate->designs);
  }
  std::vector<std::string> names;
  if (study.has_search()) {
    names.emplace_back("winner");
  }
  for (const Prototype& prototype : study.prototypes) {
    names.push_back(prototype.name);
  }
  if (names.empty()) {
    names.emplace_back("baseline");
  }
  return names;
}

std::filesystem::path beside_run(const std::filesystem::path& run) {
  const std::filesystem::path plain = (run / ".").lexically_normal().parent_path();
  const bool is_named = !plain.empty() && plain.filename() != "." && plain.filename() != "..";
  return is_named ? plain.parent_path()
                  : std::filesystem::weakly_canonical(std::filesystem::absolute(run)).parent_path();
}

std::vector<std::string> validation_steps(const Study& study,
                                          const std::filesystem::path& run,
                                          const std::filesystem::path& cell,
                                          const std::string& driving) {
  std::vector<std::string> steps;
  if (!study.scene.validate) {
    return steps;
  }
  const std::filesystem::path beside = beside_run(run);
  for (const std::string& name : designs_to_validate(study)) {
    const std::filesystem::path scene = run / name / "scene.toml";
    if (is_there(scene)) {
      steps.push_back(fmt::format("glint acquire {} --cell {} --out {}{} --move",
                                  shell_word(scene.string()),
                                  shell_word(cell.string()),
                                  shell_word((beside / "acquired" / name).string()),
                                  driving));
    }
  }
  steps.push_back(fmt::format("glint validate {} --pictures {} --out {}",
                              shell_word(run.string()),
                              shell_word((beside / "acquired").string()),
                              shell_word((beside / "validate").string())));
  return steps;
}

}  // namespace glint
