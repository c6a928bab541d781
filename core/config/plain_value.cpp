// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/plain_value.h"

#include <charconv>
#include <cstdint>
#include <limits>
#include <string>

namespace glint {

namespace {

/// A number as from_chars reads it: without a plus, and nan and inf without YAML's dot.
/// @param without_dot  keeps what is not a part of the word
std::string_view digits_of(std::string_view word, std::string& without_dot) {
  std::string_view digits = word;
  if (digits.starts_with('+')) {
    digits.remove_prefix(1);
  }
  for (const std::string_view special : {".nan", ".NaN", ".Nan", ".NAN", ".inf", ".Inf", ".INF"}) {
    if (digits == special || (digits.starts_with('-') && digits.substr(1) == special)) {
      without_dot = digits;
      without_dot.erase(without_dot.find('.'), 1);
      return without_dot;
    }
  }
  return digits;
}

}  // namespace

ConfigNode plain_value(std::string_view word) {
  if (word == "true" || word == "false") {
    return ConfigNode::from_boolean(word == "true");
  }
  std::string without_dot;
  const std::string_view digits = digits_of(word, without_dot);
  const char* end = digits.data() + digits.size();
  std::int64_t integer = 0;
  if (const auto [rest, error] = std::from_chars(digits.data(), end, integer);
      error == std::errc() && rest == end) {
    return ConfigNode::from_integer(integer);
  }
  double number = 0.0;
  if (const auto [rest, error] = std::from_chars(digits.data(), end, number);
      error == std::errc() && rest == end) {
    return ConfigNode::from_number(number);
  }
  return ConfigNode::from_text(std::string(word));
}

}  // namespace glint
