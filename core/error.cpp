// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/error.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"

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

std::string Problem::message() const {
  std::string message = place.prefix();
  for (const std::string& part : {context, key}) {
    message += part.empty() ? "" : part + ": ";
  }
  return message + text;
}

std::vector<std::string> messages_of(std::span<const Problem> problems) {
  std::vector<std::string> messages;
  for (const Problem& problem : problems) {
    messages.push_back(problem.message());
  }
  return messages;
}

ConfigError::ConfigError(std::vector<Problem> problems)
    : Error(join(messages_of(problems), "\n")),
      problems_(std::make_shared<const std::vector<Problem>>(std::move(problems))) {}

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
