// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace glint {

/// Where in a user's file something stands; line and column count from 1, 0 means unknown.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;

  /// `file:line:column: `, shortened by what is unknown; empty when nothing is known.
  std::string prefix() const;
};

/// Base of everything Glint throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user's input is wrong. The text is `file:line:column: key: what is wrong, what is allowed`,
/// one line per problem.
class ConfigError : public Error {
 public:
  using Error::Error;
};

/// A file could not be read or written.
class IoError : public Error {
 public:
  using Error::Error;
};

/// The operating system's last error as a sentence, for IoError texts.
std::string last_system_error();

namespace detail {
[[noreturn]] void check_failed(const char* file, int line, const char* condition, const char* text);
}  // namespace detail

}  // namespace glint

/// Aborts, in every build, when one of our own assumptions is broken.
#define GLINT_CHECK(condition, text)                                       \
  do {                                                                     \
    if (!(condition)) {                                                    \
      ::glint::detail::check_failed(__FILE__, __LINE__, #condition, text); \
    }                                                                      \
  } while (false)
