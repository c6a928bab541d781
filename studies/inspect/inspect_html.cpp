// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_html.h"

#include <fmt/format.h>

namespace glint::inspect_html {

std::string plural(std::int64_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string badge(const std::optional<Grade>& grade) {
  return grade ? fmt::format("<span class=\"badge {0}\">{0}</span>", grade_name(*grade)) : "";
}

std::string cell(std::string_view text, bool is_number) {
  return fmt::format("<td{}>{}</td>", is_number ? " class=\"n\"" : "", text);
}

std::string heads(std::initializer_list<std::string_view> words) {
  std::string text = "<tr>";
  for (const std::string_view word : words) {
    const bool is_text = word.starts_with("!");
    text += fmt::format(
        "<th{}>{}</th>", is_text ? "" : " class=\"n\"", is_text ? word.substr(1) : word);
  }
  return text + "</tr>\n";
}

std::string number(double value) {
  return fmt::format("{:.4g}", value);
}

}  // namespace glint::inspect_html
