// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/config/config.h"

namespace glint {

/// What becomes of names without a value.
enum class YamlNulls { kRefused, kLeftOut };

/// Parses YAML 1.1, also as OpenCV writes it ("%YAML:1.0", matrices with a tag), into the tree that
/// TOML gives. Plain words are numbers where they read as one, also .nan and .inf, true or false,
/// else texts; aliases are refused, a second document, equal names in one mapping and more than 64
/// levels.
/// @param file  for messages
/// @throws ConfigError with file:line:column
ConfigNode parse_located_yaml(std::string_view text,
                              const std::string& file,
                              YamlNulls nulls = YamlNulls::kRefused);

}  // namespace glint
