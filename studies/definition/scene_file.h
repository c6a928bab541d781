// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "core/config/toml.h"
#include "studies/definition/scene.h"

namespace glint {

/// The scene that stands in a file. @throws ConfigError with all its problems, IoError
inline SceneSettings load_scene(const std::filesystem::path& file) {
  std::vector<Problem> errors;
  SceneSettings scene = read_scene(load_toml(file), errors);
  throw_if_any(errors);
  return scene;
}

}  // namespace glint
