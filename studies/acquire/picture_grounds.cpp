// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/picture_grounds.h"

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr const char* kPart = "[part] ";
constexpr const char* kFeature = "[camera.features] ";

std::string value_in(const PictureGrounds& grounds, const std::string& name) {
  const auto found = grounds.find(name);
  return found == grounds.end() ? "not set" : found->second;
}

}  // namespace

PictureGrounds picture_grounds(const SceneSettings* scene, const Cell& cell) {
  PictureGrounds grounds;
  if (scene != nullptr) {
    const ConfigNode tables = write_scene(*scene);
    const ConfigNode* part = tables.find("part");
    for (std::size_t i = 0; part != nullptr && i < part->names.size(); ++i) {
      const bool is_mesh = part->names[i] == "file" && !scene->part.file.empty();
      grounds[kPart + part->names[i]] = is_mesh
                                            ? "SHA-256 " + sha256_hex(read_file(scene->part.file))
                                            : value_to_toml(part->items[i]);
    }
  }
  for (const CellFeature& feature : camera_of(cell).features) {
    grounds[kFeature + feature.name] = feature.value;
  }
  return grounds;
}

std::string ground_difference(const PictureGrounds& there, const PictureGrounds& now) {
  PictureGrounds all = there;
  all.insert(now.begin(), now.end());
  for (const auto& [name, value] : all) {
    const bool is_known = there.contains(name) && now.contains(name);
    if (name.starts_with(kPart) && !is_known) {
      continue;
    }
    if (value_in(there, name) != value_in(now, name)) {
      return fmt::format(
          "{} is {} there, and {} now", name, value_in(there, name), value_in(now, name));
    }
  }
  return {};
}

}  // namespace glint
