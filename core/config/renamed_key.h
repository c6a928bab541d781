// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keys that had another name in older versions are read under it, too. Lists of keys and files that
// are written have the new name alone.
#pragma once

#include <string_view>

#include "core/config/keys.h"

namespace glint {

/// The name by which a visitor asks for a renamed key: its own, and the former one where the table
/// that is read has that alone. Then the log warns: "most_retakes is called max_retakes now". A
/// table with both is refused, as the former one is an unknown key.
///
///     keys.integer(name_in_table(keys, "max_retakes", "most_retakes"), ...);
///
/// @param former  with static storage, as the name
std::string_view name_in_table(const KeyVisitor& keys,
                               std::string_view name,
                               std::string_view former);

}  // namespace glint
