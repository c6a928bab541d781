// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values put over those of a study's file: by a variable, by a prototype, by --set.
#pragma once

#include <string>
#include <vector>

#include "core/config/config.h"

namespace glint {

/// Puts a value at a dotted path of a scene's tables.
/// @param root      tables as written; what the path runs through is added where they lack it
/// @param resolved  write_scene() of them
/// @throws ConfigError  as set_path()
void put_override(ConfigNode& root,
                  const ConfigNode& resolved,
                  const std::string& path,
                  const ConfigNode& value);

/// Puts the value of `--set path=text` where its path says; a path with quotes runs through tables
/// only. @throws ConfigError
void put_set(ConfigNode& root, const std::string& path, const std::string& text);

/// Asked when a scene has been read: throws if it has problems, and tells with them of variables of
/// lights and defects that the file has no table of, as of a light that was replaced.
/// @throws ConfigError
void throw_if_any_of_scene(const ConfigNode& root, std::vector<Problem> problems);

}  // namespace glint
