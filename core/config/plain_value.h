// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "core/config/config.h"

namespace glint {

/// Deepest nesting of a file of poses.
inline constexpr int kMaxFileDepth = 64;

/// A word without quotes as a number (also with a plus sign, .nan, nan, .inf, -inf), true or false,
/// else a text. It has no place yet.
ConfigNode plain_value(std::string_view word);

}  // namespace glint
