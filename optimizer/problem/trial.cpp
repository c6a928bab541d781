// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/problem/trial.h"

#include <algorithm>
#include <charconv>

#include "core/text.h"

namespace glint {
namespace {

constexpr std::string_view kSeparator = " | ";

Remark remark_from_text(std::string_view text) {
  std::int64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || text.starts_with('-')) {
    return {.count = {}, .text = std::string(text)};
  }
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return {.count = count, .text = std::string(text)};
}

}  // namespace

std::string text_of(const Remark& remark) {
  return remark.count ? std::to_string(*remark.count) + " " + remark.text : remark.text;
}

std::string text_of(std::span<const Remark> remarks) {
  std::vector<std::string> texts;
  for (const Remark& remark : remarks) {
    texts.push_back(text_of(remark));
  }
  return join(texts, kSeparator);
}

std::vector<Remark> remarks_from_text(std::string_view text) {
  std::vector<Remark> remarks;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(kSeparator), text.size());
    remarks.push_back(remark_from_text(text.substr(0, end)));
    text.remove_prefix(std::min(end + kSeparator.size(), text.size()));
  }
  return remarks;
}

}  // namespace glint
