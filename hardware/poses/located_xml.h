// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/config/config.h"

namespace glint {

/// Parses the XML that ViSP and OpenCV write into the tree that TOML gives: the root element's
/// children as a table, elements without children as numbers or texts, several elements of one name
/// as an array at the first one's place. Attributes, comments and declarations are passed over;
/// of entities only &lt; &gt; &amp; &quot; &apos; are known.
/// @param file  for messages
/// @throws ConfigError with file:line:column
ConfigNode parse_located_xml(std::string_view text, const std::string& file);

}  // namespace glint
