// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/placed_json.h"

#include <algorithm>
#include <charconv>
#include <cstdint>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr int kMaxDepth = 64;

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | (code >> 6));
    put(0x80 | (code & 0x3F));
  } else {
    put(0xE0 | (code >> 12));
    put(0x80 | ((code >> 6) & 0x3F));
    put(0x80 | (code & 0x3F));
  }
}

bool is_json_number(std::string_view word) {
  std::size_t i = 0;
  const auto digits = [&] {
    const std::size_t start = i;
    while (i < word.size() && word[i] >= '0' && word[i] <= '9') {
      ++i;
    }
    return i - start;
  };
  i += word.starts_with('-') ? 1U : 0U;
  const std::size_t first = i;
  const std::size_t whole = digits();
  if (whole == 0 || (whole > 1 && word[first] == '0')) {
    return false;
  }
  if (i < word.size() && word[i] == '.') {
    ++i;
    if (digits() == 0) {
      return false;
    }
  }
  if (i < word.size() && (word[i] == 'e' || word[i] == 'E')) {
    ++i;
    i += i < word.size() && (word[i] == '+' || word[i] == '-') ? 1U : 0U;
    if (digits() == 0) {
      return false;
    }
  }
  return i == word.size();
}

class JsonParser {
 public:
  JsonParser(std::string_view text, const std::string& file) : text_(text), file_(file) {
    if (text_.starts_with("\xEF\xBB\xBF")) {
      text_.remove_prefix(3);
    }
  }

  ConfigNode parse() {
    ConfigNode root = value(0);
    skip_space();
    if (at_ < text_.size()) {
      fail("something follows the end of the JSON value");
    }
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigError(place().prefix() + message);
  }

  Place place() const {
    return {.file = file_, .line = line_, .column = static_cast<int>(at_ - line_start_) + 1};
  }

  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) < 4) {
      const bool is_line_end = text_[at_] == '\n';
      ++at_;
      if (is_line_end) {
        ++line_;
        line_start_ = at_;
      }
    }
  }

  char peek() {
    skip_space();
    if (at_ == text_.size()) {
      fail("the JSON text ends too early");
    }
    return text_[at_];
  }

  void expect(char wanted) {
    if (peek() != wanted) {
      fail(fmt::format("found '{}', expected '{}'", text_[at_], wanted));
    }
    ++at_;
  }

  ConfigNode value(int depth) {
    if (depth > kMaxDepth) {
      fail(fmt::format("JSON nested deeper than {} levels", kMaxDepth));
    }
    const char first = peek();
    const Place start = place();
    ConfigNode node = first == '['   ? array(depth)
                      : first == '{' ? object(depth)
                      : first == '"' ? ConfigNode::from_text(quoted())
                                     : word();
    node.place = start;
    return node;
  }

  ConfigNode array(int depth) {
    ConfigNode node = ConfigNode::array();
    expect('[');
    if (peek() == ']') {
      ++at_;
      return node;
    }
    for (;;) {
      node.items.push_back(value(depth + 1));
      if (peek() == ']') {
        ++at_;
        return node;
      }
      expect(',');
    }
  }

  ConfigNode object(int depth) {
    ConfigNode node = ConfigNode::table();
    expect('{');
    if (peek() == '}') {
      ++at_;
      return node;
    }
    for (;;) {
      if (peek() != '"') {
        fail("expected a name in double quotes");
      }
      std::string name = quoted();
      if (node.find(name) != nullptr) {
        fail(fmt::format("{}: appears twice in this object", name));
      }
      expect(':');
      node.items.push_back(value(depth + 1));
      node.names.push_back(std::move(name));
      if (peek() == '}') {
        ++at_;
        return node;
      }
      expect(',');
    }
  }

  std::string quoted() {
    std::string result;
    ++at_;
    while (at_ < text_.size() && text_[at_] != '"') {
      const char c = text_[at_];
      if (static_cast<unsigned char>(c) < 0x20) {
        fail("a control character or line end in a JSON text; write it as an escape");
      }
      ++at_;
      if (c == '\\') {
        escape(result);
      } else {
        result.push_back(c);
      }
    }
    if (at_ == text_.size()) {
      fail("a text is not closed by '\"'");
    }
    ++at_;
    return result;
  }

  void escape(std::string& result) {
    static constexpr std::string_view kLetters = "\"\\/bfnrt";
    static constexpr std::string_view kMeant = "\"\\/\b\f\n\r\t";
    const char letter = at_ < text_.size() ? text_[at_] : '\0';
    const std::size_t which = kLetters.find(letter);
    if (which < kLetters.size()) {
      result.push_back(kMeant[which]);
      ++at_;
      return;
    }
    std::uint32_t code = 0;
    const char* digits = text_.data() + at_ + 1;
    const bool fits = letter == 'u' && text_.size() - at_ > 4;
    // Halves of surrogate pairs name no character of their own; no key of ours needs them.
    if (!fits || std::from_chars(digits, digits + 4, code, 16).ptr != digits + 4 ||
        (code >= 0xD800 && code < 0xE000)) {
      fail("an escape must be one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\uXXXX");
    }
    append_utf8(result, code);
    at_ += 5;
  }

  /// A number, true or false.
  ConfigNode word() {
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n,]}:[{\"", at_), text_.size());
    const std::string_view found = text_.substr(at_, end - at_);
    if (found == "true" || found == "false") {
      at_ = end;
      return ConfigNode::from_boolean(found == "true");
    }
    double number = 0.0;
    if (!is_json_number(found) ||
        std::from_chars(found.data(), found.data() + found.size(), number).ec != std::errc()) {
      fail(fmt::format("found '{}', expected a number, text, array or object",
                       found.empty() ? text_.substr(at_, 1) : found));
    }
    at_ = end;
    return ConfigNode::from_number(number);
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
};

}  // namespace

ConfigNode parse_placed_json(std::string_view text, const std::string& file) {
  return JsonParser(text, file).parse();
}

}  // namespace glint
