// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/located_yaml.h"

#include <yaml.h>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "core/config/plain_value.h"

namespace glint {
namespace {

constexpr std::string_view kOpenCvHead = "%YAML:";

/// An event that frees itself.
class YamlEvent {
 public:
  YamlEvent() = default;

  ~YamlEvent() { yaml_event_delete(&event_); }

  YamlEvent(const YamlEvent&) = delete;
  YamlEvent& operator=(const YamlEvent&) = delete;

  yaml_event_t* get() { return &event_; }

  yaml_event_type_t type() const { return event_.type; }

  std::string_view text() const {
    return {reinterpret_cast<const char*>(event_.data.scalar.value), event_.data.scalar.length};
  }

  bool is_plain() const { return event_.data.scalar.style == YAML_PLAIN_SCALAR_STYLE; }

  const yaml_mark_t& mark() const { return event_.start_mark; }

 private:
  yaml_event_t event_ = {};
};

class YamlTreeBuilder {
 public:
  YamlTreeBuilder(std::string_view text, const std::string& file, YamlNulls nulls)
      : file_(file), nulls_(nulls) {
    if (yaml_parser_initialize(&parser_) == 0) {
      throw ConfigError(file + ": no memory to read it");
    }
    yaml_parser_set_input_string(
        &parser_, reinterpret_cast<const unsigned char*>(text.data()), text.size());
  }

  ~YamlTreeBuilder() { yaml_parser_delete(&parser_); }

  YamlTreeBuilder(const YamlTreeBuilder&) = delete;
  YamlTreeBuilder& operator=(const YamlTreeBuilder&) = delete;

  ConfigNode build() {
    expect(YAML_STREAM_START_EVENT);
    YamlEvent begin;
    read(begin);
    if (begin.type() != YAML_DOCUMENT_START_EVENT) {
      throw ConfigError(Place{.file = file_, .line = 1, .column = 1}.prefix() + "holds no value");
    }
    YamlEvent first;
    read(first);
    ConfigNode root = value(first, 0);
    expect(YAML_DOCUMENT_END_EVENT);
    expect(YAML_STREAM_END_EVENT);
    return root;
  }

 private:
  Place place(const yaml_mark_t& mark) const {
    return {.file = file_,
            .line = static_cast<int>(mark.line) + 1,
            .column = static_cast<int>(mark.column) + 1};
  }

  [[noreturn]] void fail(const yaml_mark_t& mark, const std::string& text) const {
    throw ConfigError(place(mark).prefix() + text);
  }

  void read(YamlEvent& event) {
    if (yaml_parser_parse(&parser_, event.get()) == 0) {
      const bool has_mark = parser_.problem_mark.line + parser_.problem_mark.column > 0;
      const yaml_mark_t& mark = has_mark ? parser_.problem_mark : parser_.mark;
      fail(mark, parser_.problem != nullptr ? parser_.problem : "is no YAML");
    }
  }

  void expect(yaml_event_type_t type) {
    YamlEvent event;
    read(event);
    if (event.type() != type) {
      fail(event.mark(), "a second document follows, one is allowed");
    }
  }

  ConfigNode value(YamlEvent& event, int depth) {
    if (depth > kMaxFileDepth) {
      fail(event.mark(), fmt::format("YAML nested deeper than {} levels", kMaxFileDepth));
    }
    ConfigNode node;
    switch (event.type()) {
      case YAML_SCALAR_EVENT:
        node = event.is_plain() ? plain(event) : ConfigNode::from_text(std::string(event.text()));
        break;
      case YAML_SEQUENCE_START_EVENT:
        node = sequence(depth);
        break;
      case YAML_MAPPING_START_EVENT:
        node = mapping(depth);
        break;
      default:
        fail(event.mark(), "refers to an anchor, which is not understood here");
    }
    node.place = place(event.mark());
    return node;
  }

  static bool is_null(const YamlEvent& event) {
    return event.type() == YAML_SCALAR_EVENT && event.is_plain() &&
           (event.text().empty() || event.text() == "~" || event.text() == "null");
  }

  ConfigNode plain(const YamlEvent& event) const {
    if (is_null(event)) {
      fail(event.mark(), "found no value, expected one");
    }
    return plain_value(event.text());
  }

  ConfigNode sequence(int depth) {
    ConfigNode node = ConfigNode::array();
    while (true) {
      YamlEvent event;
      read(event);
      if (event.type() == YAML_SEQUENCE_END_EVENT) {
        return node;
      }
      node.items.push_back(value(event, depth + 1));
    }
  }

  ConfigNode mapping(int depth) {
    ConfigNode node = ConfigNode::table();
    while (true) {
      YamlEvent key;
      read(key);
      if (key.type() == YAML_MAPPING_END_EVENT) {
        return node;
      }
      if (key.type() != YAML_SCALAR_EVENT) {
        fail(key.mark(), "a key must be a plain word");
      }
      std::string name(key.text());
      if (node.find(name) != nullptr) {
        fail(key.mark(), fmt::format("{}: appears twice in this mapping", name));
      }
      YamlEvent event;
      read(event);
      if (nulls_ == YamlNulls::kLeftOut && is_null(event)) {
        continue;
      }
      ConfigNode item = value(event, depth + 1);
      node.names.push_back(std::move(name));
      node.items.push_back(std::move(item));
    }
  }

  const std::string& file_;
  YamlNulls nulls_;
  yaml_parser_t parser_ = {};
};

}  // namespace

ConfigNode parse_located_yaml(std::string_view text, const std::string& file, YamlNulls nulls) {
  if (!text.starts_with(kOpenCvHead)) {
    return YamlTreeBuilder(text, file, nulls).build();
  }
  // No directive of YAML has a colon, and its version 1.0 is refused: a comment in its place.
  std::string standard(text);
  standard.front() = '#';
  return YamlTreeBuilder(standard, file, nulls).build();
}

}  // namespace glint
