// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// The candidate with the smallest edit distance to the word; empty when there is none.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// The shortest decimal text that reads back as the same double; never locale-dependent.
std::string shortest(double value);

/// A length as a person writes it: at most 3 decimals, no trailing zeros, "66.7 mm".
std::string length_text(double length_mm);

/// The parts between separators; empty parts are kept.
std::vector<std::string> split(std::string_view text, char separator);

std::string join(std::span<const std::string> parts, std::string_view separator);

/// The text with &, <, > and " escaped and control characters blanked, for HTML and XML.
std::string markup_text(std::string_view text);

/// SHA-256 of the bytes in lower-case hexadecimal, for content hashes.
std::string sha256_hex(std::string_view bytes);

}  // namespace glint
