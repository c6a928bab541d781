// SPDX-License-Identifier: GPL-3.0-or-later
//
// nlohmann's parser reports values without their places. But the stream tells how far it has read
// at each report, and a value begins at the first character after the previous one that can begin
// a value.
#include "core/config/located_json.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace glint {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxDepth = 64;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBetweenValues = " \t\r\n,:]}";

/// Builds the tree from what the parser reports; its functions return whether to go on.
class TreeBuilder : public nlohmann::json_sax<Json> {
 public:
  TreeBuilder(std::string_view text, const std::string& file)
      : text_(text), file_(file), input_(std::string(text)) {}

  ConfigNode build() {
    Json::sax_parse(input_, this);
    if (!input_.eof()) {  // it takes a zero byte for the end
      fail(num_read() - 1, "something follows the end of the JSON value");
    }
    return std::move(root_.items.front());
  }

  bool null() override { fail(next_value(), "found 'null', expected a value"); }

  bool boolean(bool value) override {
    add(ConfigNode::from_boolean(value));
    return true;
  }

  bool number_integer(number_integer_t) override { return number(); }

  bool number_unsigned(number_unsigned_t) override { return number(); }

  bool number_float(number_float_t, const string_t&) override { return number(); }

  bool string(string_t& value) override {
    add(ConfigNode::from_text(std::move(value)));
    return true;
  }

  bool binary(binary_t&) override { return false; }  // not in JSON texts

  bool start_object(std::size_t) override {
    open_.push_back(&add(ConfigNode::table()));
    return true;
  }

  bool key(string_t& name) override {
    const std::size_t start = next_value();
    if (open_.back()->find(name) != nullptr) {
      fail(start, fmt::format("{}: appears twice in this object", name));
    }
    open_.back()->names.push_back(std::move(name));
    return true;
  }

  bool end_object() override { return end_array(); }

  bool start_array(std::size_t) override {
    open_.push_back(&add(ConfigNode::array()));
    return true;
  }

  bool end_array() override {
    open_.pop_back();
    return true;
  }

  bool parse_error(std::size_t position,
                   const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    std::size_t at = position - 1;  // of the last character read, or the end
    const std::size_t start = text_.find_first_not_of(kBetweenValues, last_end_);
    const bool is_inside_text =
        start < at && text_[start] == '"' && (at == text_.size() || text_[at] != '"');
    if (!is_inside_text) {
      at = std::min(at, start);
    }
    // "[json.exception...] parse error at line 1, column 2: syntax error while ..." tells the last
    // character's place, ours is better; "[json.exception...] number overflow ..." tells none.
    const std::string_view message = error.what();
    const std::size_t syntax = message.find("syntax error");
    fail(at, message.substr(syntax < message.size() ? syntax : message.find("] ") + 2));
  }

 private:
  [[noreturn]] void fail(std::size_t at, std::string_view message) {
    throw ConfigError(place(at).prefix().append(message));
  }

  /// Of a character that stands on the line of the one asked for before, or on a later one.
  Place place(std::size_t at) {
    for (; counted_ < std::min(at, text_.size()); ++counted_) {
      if (text_[counted_] == '\n') {
        ++line_;
        line_start_ = counted_ + 1;
      }
    }
    return {.file = file_, .line = line_, .column = static_cast<int>(at - line_start_) + 1};
  }

  std::size_t num_read() const {
    return static_cast<std::size_t>(input_.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in));
  }

  /// Where the value or name begins that was just read.
  std::size_t next_value() {
    const std::size_t start = text_.find_first_not_of(kBetweenValues, last_end_);
    last_end_ = num_read();
    return start;
  }

  bool number() {
    const std::size_t start = next_value();
    // The parser has also read what ended the number, if not the text did.
    if (!input_.eof() && kBetweenValues.find(text_[last_end_ - 1]) == std::string_view::npos) {
      fail(start, fmt::format("a number is followed by '{}'", text_[last_end_ - 1]));
    }
    double value = 0.0;
    const char* end = text_.data() + text_.size();
    if (std::from_chars(text_.data() + start, end, value).ec != std::errc()) {
      fail(start, "a number too small or too great for a double");
    }
    put(ConfigNode::from_number(value), start);
    return true;
  }

  ConfigNode& add(ConfigNode node) { return put(std::move(node), next_value()); }

  ConfigNode& put(ConfigNode node, std::size_t start) {
    if (open_.size() > kMaxDepth) {
      fail(start, fmt::format("JSON nested deeper than {} levels", kMaxDepth));
    }
    node.place = place(start);
    std::vector<ConfigNode>& items = open_.empty() ? root_.items : open_.back()->items;
    return items.emplace_back(std::move(node));
  }

  std::string_view text_;
  const std::string& file_;
  std::istringstream input_;
  std::size_t last_end_ = 0;  ///< of the value or name read last
  std::size_t counted_ = 0;   ///< characters whose line ends are in line_
  std::size_t line_start_ = 0;
  int line_ = 1;
  ConfigNode root_ = ConfigNode::array();
  std::vector<ConfigNode*> open_;  ///< arrays and tables around the next value
};

}  // namespace

ConfigNode parse_located_json(std::string_view text, const std::string& file) {
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  return TreeBuilder(text, file).build();
}

}  // namespace glint
