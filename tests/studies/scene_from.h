// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/config/toml.h"
#include "studies/definition/scene.h"

namespace glint::test {

/// A scene from the text of its file. @throws ConfigError
inline SceneSettings scene_from(const std::string& text) {
  std::vector<Problem> errors;
  SceneSettings scene = read_scene(parse_toml(text, "scene.toml"), errors);
  if (!errors.empty()) {
    throw ConfigError(errors);
  }
  return scene;
}

}  // namespace glint::test
