// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace glint::test {

/// What stands in the data element of a page, as text.
inline std::string page_text(const std::string& page) {
  const std::string start = R"(<script type="application/json" id="data">)";
  const auto at = page.find(start) + start.size();
  return page.substr(at, page.find("</script>", at) - at);
}

/// The JSON that a page is drawn from (studies/report/report.h).
inline nlohmann::ordered_json page_data(const std::string& page) {
  return nlohmann::ordered_json::parse(page_text(page));
}

/// The page with its element of date and duration empty: what the same study gives at any time.
inline std::string without_when(std::string page) {
  const std::string start = "<span id=\"when\">";
  const auto at = page.find(start);
  if (at != std::string::npos) {
    const auto text = at + start.size();
    page.erase(text, page.find("</span>", text) - text);
  }
  return page;
}

}  // namespace glint::test
