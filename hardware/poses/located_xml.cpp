// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/located_xml.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "core/config/plain_value.h"

namespace glint {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

class XmlParser {
 public:
  XmlParser(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  ConfigNode root() {
    skip_remarks();
    if (!rest().starts_with('<')) {
      fail("expected an element");
    }
    ConfigNode node = element(0).second;
    skip_remarks();
    if (at_ != text_.size()) {
      fail("something follows the root element");
    }
    return node;
  }

 private:
  std::string_view rest() const { return text_.substr(at_); }

  Place place() {
    for (; counted_ < at_; ++counted_) {
      if (text_[counted_] == '\n') {
        ++line_;
        line_start_ = counted_ + 1;
      }
    }
    return {.file = file_, .line = line_, .column = static_cast<int>(at_ - line_start_) + 1};
  }

  [[noreturn]] void fail(const std::string& text) { throw ConfigError(place().prefix() + text); }

  void skip_blanks() { at_ = std::min(text_.find_first_not_of(kBlank, at_), text_.size()); }

  void skip_past(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == text_.npos) {
      fail(fmt::format("the closing {} is missing", end));
    }
    at_ = found + end.size();
  }

  /// Blanks, comments and declarations.
  void skip_remarks() {
    for (skip_blanks();; skip_blanks()) {
      if (rest().starts_with("<!--")) {
        skip_past("-->");
      } else if (rest().starts_with("<?")) {
        skip_past("?>");
      } else if (rest().starts_with("<!")) {
        skip_past(">");
      } else {
        return;
      }
    }
  }

  std::string name() {
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n/>", at_), text_.size());
    std::string found(text_.substr(at_, end - at_));
    if (found.empty() || found.find('<') != found.npos) {
      fail("expected the name of an element");
    }
    at_ = end;
    return found;
  }

  /// Attributes are passed over. @return whether the element ends here
  bool end_of_tag() {
    for (skip_blanks(); !rest().starts_with('>') && !rest().starts_with("/>"); skip_blanks()) {
      const std::size_t quote = text_.find_first_of("\"'<>", at_);
      if (quote == text_.npos || (text_[quote] != '"' && text_[quote] != '\'')) {
        fail("expected an attribute or the end of the element's tag");
      }
      at_ = quote + 1;
      skip_past(text_.substr(quote, 1));
    }
    const bool is_empty = rest().starts_with("/>");
    at_ += is_empty ? 2 : 1;
    return is_empty;
  }

  std::pair<std::string, ConfigNode> element(int depth) {
    if (depth > kMaxFileDepth) {
      fail(fmt::format("XML nested deeper than {} levels", kMaxFileDepth));
    }
    const Place start = place();
    ++at_;
    std::pair<std::string, ConfigNode> result(name(), ConfigNode::from_text(""));
    if (!end_of_tag()) {
      result.second = content(result.first, depth);
    }
    if (result.second.place.line == 0) {
      result.second.place = start;
    }
    return result;
  }

  void close(const std::string& tag) {
    const std::size_t begin = at_ + 2;
    at_ = begin;
    if (const std::string closed = name(); closed != tag) {
      at_ = begin;
      fail(fmt::format("closes {}, but {} is open", closed, tag));
    }
    skip_past(">");
  }

  ConfigNode content(const std::string& tag, int depth) {
    ConfigNode table = ConfigNode::table();
    std::string words;
    Place first_word;
    while (true) {
      skip_remarks();
      if (rest().starts_with("</")) {
        break;
      }
      if (rest().starts_with('<')) {
        auto [key, item] = element(depth + 1);
        add(table, key, std::move(item));
        continue;
      }
      first_word = words.empty() ? place() : first_word;
      const std::size_t end = text_.find('<', at_);
      if (end == text_.npos) {
        fail(fmt::format("the element {} is not closed", tag));
      }
      words += text_.substr(at_, end - at_);
      at_ = end;
    }
    close(tag);
    if (!table.items.empty()) {
      return table;
    }
    ConfigNode leaf = plain_value(unescaped(words.substr(0, words.find_last_not_of(kBlank) + 1)));
    leaf.place = first_word;
    return leaf;
  }

  static void add(ConfigNode& table, const std::string& key, ConfigNode item) {
    ConfigNode* known = table.find(key);
    if (known == nullptr) {
      table.names.push_back(key);
      table.items.push_back(std::move(item));
      return;
    }
    if (!known->is_array()) {
      ConfigNode list = ConfigNode::array();
      list.place = known->place;
      list.items.push_back(std::move(*known));
      *known = std::move(list);
    }
    known->items.push_back(std::move(item));
  }

  static std::string unescaped(std::string text) {
    constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
        {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
    for (const auto& [entity, letter] : kEntities) {
      for (std::size_t at = text.find(entity); at != text.npos; at = text.find(entity, at + 1)) {
        text.replace(at, entity.size(), 1, letter);
      }
    }
    return text;
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  std::size_t counted_ = 0;  ///< characters whose line ends are in line_
  std::size_t line_start_ = 0;
  int line_ = 1;
};

}  // namespace

ConfigNode parse_located_xml(std::string_view text, const std::string& file) {
  return XmlParser(text, file).root();
}

}  // namespace glint
