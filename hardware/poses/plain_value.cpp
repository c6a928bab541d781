// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/plain_value.h"

#include <charconv>
#include <cstdint>
#include <limits>
#include <string>

namespace glint {

ConfigNode plain_value(std::string_view word) {
  if (word == "true" || word == "false") {
    return ConfigNode::from_boolean(word == "true");
  }
  std::string_view digits = word;
  if (digits.starts_with('+')) {
    digits.remove_prefix(1);
  }
  std::string without_dot;
  for (const std::string_view special : {".nan", ".NaN", ".Nan", ".NAN", ".inf", ".Inf", ".INF"}) {
    if (digits == special || (digits.starts_with('-') && digits.substr(1) == special)) {
      without_dot = digits;
      without_dot.erase(without_dot.find('.'), 1);
      digits = without_dot;
    }
  }
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
