// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/config/config.h"

namespace glint {

/// Parses YAML 1.1, also as OpenCV writes it ("%YAML:1.0", matrices with a tag), into the tree that
/// TOML gives. Plain words are numbers where they read as one, also .nan and .inf, true or false,
/// else texts; null is refused, and so are aliases, a second document, equal names in one mapping
/// and more than 64 levels.
/// @param file  for messages
/// @throws ConfigError with file:line:column
ConfigNode parse_located_yaml(std::string_view text, const std::string& file);

}  // namespace glint
