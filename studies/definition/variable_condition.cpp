// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/variable_condition.h"

#include <algorithm>

#include "core/text.h"

namespace glint {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \"");
  const auto last = text.find_last_not_of(" \"");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

/// The values of "[a, b]"; none when it is written otherwise.
std::vector<std::string> listed_values(const std::string& text) {
  const std::string list = trimmed(text);
  if (list.size() < 3 || list.front() != '[' || list.back() != ']') {
    return {};
  }
  std::vector<std::string> values;
  for (const std::string& item : split(list.substr(1, list.size() - 2), ',')) {
    values.push_back(trimmed(item));
  }
  return std::ranges::any_of(values, &std::string::empty) ? std::vector<std::string>() : values;
}

}  // namespace

void read_condition(const ConfigNode& node, Variable& variable, std::vector<Problem>& errors) {
  const auto equals = node.text.find("==");
  const auto in = node.text.find(" in ");
  std::vector<std::string> values;
  if (node.kind == ConfigNode::Kind::kText && equals != std::string::npos) {
    variable.when_name = trimmed(node.text.substr(0, equals));
    values = {trimmed(node.text.substr(equals + 2))};
  } else if (node.kind == ConfigNode::Kind::kText && in != std::string::npos) {
    variable.when_name = trimmed(node.text.substr(0, in));
    values = listed_values(node.text.substr(in + 4));
  }
  if (values.empty()) {
    errors.push_back({.place = node.place,
                      .context = "variables",
                      .key = variable.name,
                      .text = "when must be \"path == value\" or \"path in [value, value]\""});
    return;
  }
  variable.when_value = values.front();
  variable.when_others.assign(values.begin() + 1, values.end());
}

}  // namespace glint
