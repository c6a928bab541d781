// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/fault.h"

#include <algorithm>
#include <charconv>
#include <vector>

namespace glint {
namespace {

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t space = text.find(' ');
    if (space != 0) {
      words.push_back(text.substr(0, space));
    }
    text = space == std::string_view::npos ? std::string_view() : text.substr(space + 1);
  }
  return words;
}

}  // namespace

std::optional<Fault> parse_fault(std::string_view text) {
  constexpr std::array<std::string_view, 3> kMoments = {"now", "moving", "still"};
  constexpr double kLongestS = 3600.0;
  const std::vector<std::string_view> words = words_of(text);
  if (words.empty() || words.size() > 3) {
    return std::nullopt;
  }
  const auto kind = std::ranges::find(kFaultNames, words[0]);
  const auto moment = std::ranges::find(kMoments, words.size() > 1 ? words[1] : kMoments[0]);
  if (kind == kFaultNames.end() || moment == kMoments.end()) {
    return std::nullopt;
  }
  Fault fault = {.kind = static_cast<FaultKind>(kind - kFaultNames.begin()),
                 .when = static_cast<Fault::When>(moment - kMoments.begin())};
  if (words.size() == 3) {
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, fault.delay_s);
    if (error != std::errc() || stop != end || !(fault.delay_s >= 0.0) ||
        fault.delay_s > kLongestS) {
      return std::nullopt;
    }
  }
  return fault;
}

}  // namespace glint
