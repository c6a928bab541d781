// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

namespace glint {

std::string Place::prefix() const {
  if (file.empty()) {
    return "";
  }
  if (line <= 0) {
    return fmt::format("{}: ", file);
  }
  if (column <= 0) {
    return fmt::format("{}:{}: ", file, line);
  }
  return fmt::format("{}:{}:{}: ", file, line, column);
}

std::string last_system_error() {
  return std::generic_category().message(errno);
}

namespace detail {

void check_failed(const char* file, int line, const char* condition, const char* text) {
  std::fprintf(stderr, "%s:%d: check failed: %s (%s)\n", file, line, text, condition);
  std::abort();
}

}  // namespace detail
}  // namespace glint
