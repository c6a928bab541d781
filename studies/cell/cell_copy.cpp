// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_copy.h"

#include <fmt/format.h>

#include "core/config/toml.h"

namespace glint {
namespace fs = std::filesystem;

std::string cell_copy(const fs::path& file) {
  ConfigNode root = load_toml(file);
  const auto make_full = [&](const std::string& path) {
    const ConfigNode* node = root.at_path(path);
    if (node != nullptr && node->kind == ConfigNode::Kind::kText && !node->text.empty()) {
      const fs::path full = fs::absolute(fs::path(node->place.file).parent_path() / node->text);
      set_path(root, path, ConfigNode::from_text(full.lexically_normal().string()));
    }
  };
  for (const char* path : {"robot.arm_deltas", "calibration.file", "twin.truth", "stage.folder"}) {
    make_full(path);
  }
  for (const char* list : {"obstacle.{}.file", "stage.pictures.{}"}) {
    const std::string name = std::string(list).substr(0, std::string(list).find(".{}"));
    const ConfigNode* items = root.at_path(name);
    const std::size_t count = items == nullptr ? 0 : items->items.size();
    for (std::size_t i = 0; i < count; ++i) {
      make_full(fmt::format(fmt::runtime(list), i));
    }
  }
  return to_toml(root);
}

}  // namespace glint
