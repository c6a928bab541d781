// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace glint {

/// The text as one word of a POSIX shell: as it is where all its characters mean themselves, else
/// in single quotes. For commands that a person copies.
std::string shell_word(std::string_view text);

}  // namespace glint
