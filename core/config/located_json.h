// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/config/config.h"

namespace glint {

/// Parses JSON (RFC 8259) into the tree that TOML gives, so that one reader checks both and every
/// value knows where it stands. Numbers are doubles; null is refused, as TOML has none; of equal
/// names in one object the second is refused.
/// @param file  for messages
/// @throws ConfigError with file:line:column
ConfigNode parse_located_json(std::string_view text, const std::string& file);

}  // namespace glint
