// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

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

/// One thing that is wrong with the user's input. The program asks for the kind, the key and the
/// place; the text is for people and may be reworded.
struct Problem {
  enum class Kind {
    kOther,
    kUnknownKey,  ///< nobody reads a key or a table of that name
    kWrongType,   ///< the key takes another kind of value
    kOutOfRange,  ///< the key takes this value never, whatever other keys are
    kRelation     ///< the value does not go with other keys, or with what was made of them
  };

  Kind kind = Kind::kOther;
  Place place = {};
  std::string context = {};  ///< what the key was read for: "prototypes.flat"; mostly empty
  std::string key = {};      ///< dotted path of the key or table at fault; empty: none is
  std::string text = {};     ///< what is wrong, what is allowed

  /// `file:line:column: context: key: text`, without what is empty or unknown.
  std::string message() const;
};

std::vector<std::string> messages_of(std::span<const Problem> problems);

/// The user's input is wrong. The text holds the problems' messages, a line each.
class ConfigError : public Error {
 public:
  /// A problem of no key; a file's own errors have their place in the text.
  explicit ConfigError(const std::string& text) : ConfigError(Problem{.text = text}) {}

  ConfigError(const std::string& key, const std::string& text)
      : ConfigError(Problem{.key = key, .text = text}) {}

  explicit ConfigError(const Problem& problem) : ConfigError(std::vector{problem}) {}

  /// @param problems  at least one
  explicit ConfigError(std::vector<Problem> problems);

  const std::vector<Problem>& problems() const { return *problems_; }

 private:
  std::shared_ptr<const std::vector<Problem>> problems_;  // copies of an exception must not throw
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
