// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/dashboard_text.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr std::array<std::string_view, 10> kQueries = {"robotmode",
                                                       "safetymode",
                                                       "safetystatus",
                                                       "running",
                                                       "programState",
                                                       "PolyscopeVersion",
                                                       "get robot model",
                                                       "get serial number",
                                                       "is in remote control",
                                                       "get loaded program"};

constexpr std::array<std::string_view, 5> kFailures = {
    "fail", "could not", "not allowed", "cannot", "error"};

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  });
  return result;
}

}  // namespace

bool is_query(std::string_view command) {
  return std::ranges::find(kQueries, command) != kQueries.end();
}

std::string value_of_reply(std::string_view reply) {
  const std::size_t colon = reply.find(": ");
  return std::string(colon == std::string_view::npos ? reply : reply.substr(colon + 2));
}

std::optional<bool> flag_of_reply(std::string_view reply) {
  const std::string value = lower(value_of_reply(reply));
  if (value == "true") {
    return true;
  }
  return value == "false" ? std::optional(false) : std::nullopt;
}

std::string remote_control_problem(std::string_view reply) {
  const std::optional<bool> is_on = flag_of_reply(reply);
  if (is_on == true) {
    return {};
  }
  return fmt::format("{} (\"{}\")",
                     is_on ? "remote control is off: switch it on at the pendant"
                           : "the dashboard does not tell whether remote control is on",
                     reply.substr(0, 80));
}

bool is_success(std::string_view reply) {
  const std::string text = lower(reply);
  return std::ranges::none_of(kFailures, [&text](std::string_view failure) {
    return text.find(failure) != std::string::npos;
  });
}

}  // namespace glint
