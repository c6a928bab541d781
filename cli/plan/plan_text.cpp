// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/plan/plan_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/shell/exit_codes.h"
#include "studies/plan/plan_page.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string view_line(const Json& view) {
  const bool is_planned = view["outcome"] == "planned";
  std::string line = fmt::format(
      "  {:<10} {:<12} ", view["name"].get<std::string>(), view["outcome"].get<std::string>());
  if (is_planned) {
    line += fmt::format("margin {:.1f} mm", view["margin_mm"].get<double>());
  } else {
    line += view["reason"].get<std::string>();
  }
  if (const Json& nearest = view["nearest_base_from_camera"]; !nearest.is_null()) {
    line += fmt::format("; nearest camera that can be taken: ({:.1f}, {:.1f}, {:.1f}) mm",
                        nearest[0].get<double>(),
                        nearest[1].get<double>(),
                        nearest[2].get<double>());
  }
  if (const auto nearest = view.find("nearest_base_from_flange"); nearest != view.end()) {
    line += fmt::format("; nearest flange that can be taken: ({:.1f}, {:.1f}, {:.1f}) mm",
                        nearest->at(0).get<double>(),
                        nearest->at(1).get<double>(),
                        nearest->at(2).get<double>());
  }
  return line + "\n";
}

}  // namespace

std::string plan_text(const Json& result) {
  std::string text;
  for (const Json& view : result["views"]) {
    text += view_line(view);
  }
  std::string order;
  for (const Json& path : result["paths"]) {
    const bool is_straight = path["joints_deg"].size() == 2;
    order += fmt::format("{} {} ", path["from"].get<std::string>(), is_straight ? "->" : "~>");
  }
  if (!order.empty()) {
    const Json& last = result["paths"].back();
    text += fmt::format("tour: {}{}\n", order, last["to"].get<std::string>());
  }
  for (const Json& note : result["notes"]) {
    text += fmt::format("note: {}\n", note.get<std::string>());
  }
  return text + plan_sentence(result) + "\n" +
         fmt::format("report: {}\n", result["report"].get<std::string>());
}

int plan_exit_code(const Json& result) {
  return result["reach"]["share"] == 1.0 ? kExitDone : kExitNegative;
}

}  // namespace glint
