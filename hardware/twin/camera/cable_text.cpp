// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/camera/cable_text.h"

#include <algorithm>
#include <charconv>

namespace glint {
namespace {

bool set_fault(CableFaults& faults, std::string_view key, double value) {
  const bool is_share = value <= 1.0;
  const bool is_flag = value == 0.0 || value == 1.0;
  if (key == "dropped") {
    faults.dropped = value;
    return is_share;
  }
  if (key == "doubled") {
    faults.doubled = value;
    return is_share;
  }
  if (key == "swapped") {
    faults.swapped = value;
    return is_share;
  }
  if (key == "delay_ms") {
    faults.delay = std::chrono::milliseconds(static_cast<int>(value));
    return true;
  }
  if (key == "longest_packet") {
    faults.longest_packet = static_cast<std::size_t>(value);
    return true;
  }
  if (key == "answers_resend") {
    faults.answers_resend = value != 0.0;
    return is_flag;
  }
  faults.is_cut = value != 0.0;
  return key == "cut" && is_flag;
}

bool set_word(CableFaults& faults, std::string_view word) {
  constexpr double kMax = 60000.0;
  const std::size_t sign = word.find('=');
  if (sign == std::string_view::npos) {
    return false;
  }
  double value = 0.0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data() + sign + 1, end, value);
  return error == std::errc() && rest == end && value >= 0.0 && value <= kMax &&
         set_fault(faults, word.substr(0, sign), value);
}

}  // namespace

std::optional<CableFaults> parse_cable_faults(std::string_view text) {
  CableFaults faults;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (!word.empty() && !set_word(faults, word)) {
      return std::nullopt;
    }
  }
  return faults;
}

}  // namespace glint
