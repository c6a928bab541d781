// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate_cell/validation_steps.h"

#include <algorithm>

#include <fmt/format.h>

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

std::vector<std::string> validation_steps(const Study& study,
                                          const std::filesystem::path& run,
                                          const std::filesystem::path& cell) {
  std::vector<std::string> steps;
  if (!study.scene.validate) {
    return steps;
  }
  const std::filesystem::path pictures = run.parent_path() / "acquired";
  for (const std::string& name : designs_to_validate(study)) {
    steps.push_back(fmt::format("glint acquire {} --cell {} --out {} --move",
                                shell_word((run / name / "scene.toml").string()),
                                shell_word(cell.string()),
                                shell_word((pictures / name).string())));
  }
  steps.push_back(fmt::format(
      "glint validate {} --pictures {}", shell_word(run.string()), shell_word(pictures.string())));
  return steps;
}

}  // namespace glint
