// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/text_cursor.h"

#include <charconv>
#include <system_error>

#include <fmt/format.h>

namespace glint::mesh_file {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// A word from a file as it may stand in a message: short and printable.
std::string shown(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 30)) {
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text + (word.size() > 30 ? "..." : "");
}

/// from_chars takes no leading plus.
std::string_view without_plus(std::string_view word) {
  const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return has_plus ? word.substr(1) : word;
}

}  // namespace

TextCursor::TextCursor(std::string_view text, std::string file) : text_(text) {
  place_.file = std::move(file);
  place_.line = 1;
  place_.column = 1;
}

void TextCursor::skip_blanks() {
  while (position_ < text_.size()) {
    if (is_blank(text_[position_])) {
      ++position_;
    } else if (text_[position_] == '#') {
      position_ = std::min(text_.find('\n', position_), text_.size());
    } else {
      break;
    }
  }
}

std::string_view TextCursor::take_word() {
  const std::size_t begin = position_;
  place_.line = line_;
  place_.column = static_cast<int>(begin - line_begin_) + 1;
  while (position_ < text_.size() && text_[position_] != '\n' && !is_blank(text_[position_])) {
    ++position_;
  }
  return text_.substr(begin, position_ - begin);
}

void TextCursor::skip_line() {
  const std::size_t end = text_.find('\n', position_);
  if (end == std::string_view::npos) {
    position_ = text_.size();
    return;
  }
  position_ = end + 1;
  line_begin_ = position_;
  ++line_;
}

std::string_view TextCursor::next_word() {
  skip_blanks();
  while (position_ < text_.size() && text_[position_] == '\n') {
    skip_line();
    skip_blanks();
  }
  return take_word();
}

std::string_view TextCursor::word_on_line() {
  skip_blanks();
  return take_word();
}

double TextCursor::number(std::string_view what) {
  return to_number(next_word(), what);
}

double TextCursor::number_on_line(std::string_view what) {
  return to_number(word_on_line(), what);
}

std::int64_t TextCursor::integer(std::string_view what) {
  return to_integer(next_word(), what);
}

double TextCursor::to_number(std::string_view word, std::string_view what) const {
  if (word.empty()) {
    fail(fmt::format("{} is missing", what));
  }
  const std::string_view digits = without_plus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && digits.find('-', 1) != std::string_view::npos) {
    return 0.0;  // 1e-400
  }
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(fmt::format("{} is no number: \"{}\"", what, shown(word)));
  }
  return value;
}

std::int64_t TextCursor::to_integer(std::string_view word, std::string_view what) const {
  if (word.empty()) {
    fail(fmt::format("{} is missing", what));
  }
  const std::string_view digits = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(fmt::format("{} is no whole number: \"{}\"", what, shown(word)));
  }
  return value;
}

void TextCursor::fail(const std::string& message) const {
  throw ConfigError(place_.prefix() + message + (at_end() ? " (the file ends here)" : ""));
}

}  // namespace glint::mesh_file
