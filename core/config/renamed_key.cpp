// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/renamed_key.h"

#include "core/log.h"

namespace glint {

std::string_view name_in_table(const KeyVisitor& keys,
                               std::string_view name,
                               std::string_view former) {
  if (keys.is_given(name) || !keys.is_given(former)) {
    return name;
  }
  log(LogLevel::kWarning, "{} is called {} now, and is read under its former name", former, name);
  return former;
}

}  // namespace glint
