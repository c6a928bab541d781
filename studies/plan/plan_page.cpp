// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_page.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string numbers_text(const Json& numbers, std::size_t from, std::size_t count, int digits) {
  std::string text;
  for (std::size_t i = from; i < from + count; ++i) {
    text += fmt::format("{}{:.{}f}", i == from ? "" : ", ", numbers[i].get<double>(), digits);
  }
  return text;
}

Json view_row(const Json& view) {
  const bool is_planned = view["outcome"] == "planned";
  const bool has_flange = view.contains("nearest_base_from_flange");
  const Json& nearest = view[has_flange ? "nearest_base_from_flange" : "nearest_base_from_camera"];
  return Json::array(
      {view["name"],
       view["outcome"],
       is_planned ? fmt::format("{:.1f}", view["margin_mm"].get<double>()) : "-",
       is_planned ? numbers_text(view["joints_deg"], 0, 6, 1) : view["reason"].get<std::string>(),
       numbers_text(view["base_from_camera"], 0, 3, 1),
       nearest.is_null() ? "-" : numbers_text(nearest, 0, 3, 1)});
}

Json path_row(const Json& path) {
  return Json::array({path["from"],
                      path["to"],
                      fmt::format("{}", path["joints_deg"].size() - 2),
                      fmt::format("{:.1f}", path["margin_mm"].get<double>()),
                      fmt::format("{:.1f}", path["duration_s"].get<double>())});
}

Json panel(const Json& plan) {
  Json views = {
      {"caption",
       "Views: margin in mm, joints in degrees, places of the camera in the robot's base in mm"},
      {"head",
       {"view",
        "outcome",
        "margin",
        "joints, or why not",
        "camera",
        "nearest camera that can be taken"}},
      {"rows", Json::array()}};
  Json paths = {{"caption", "Paths: each a straight way of the joints, or over safe positions"},
                {"head", {"from", "to", "over", "margin mm", "s"}},
                {"rows", Json::array()}};
  for (const Json& view : plan["views"]) {
    views["rows"].push_back(view_row(view));
  }
  for (const Json& path : plan["paths"]) {
    paths["rows"].push_back(path_row(path));
  }
  return {{"id", "plan"},
          {"title", "Views and paths"},
          {"tables", Json::array({std::move(views), std::move(paths)})}};
}

}  // namespace

std::string plan_sentence(const Json& plan) {
  const auto planned = std::ranges::count_if(
      plan["views"], [](const Json& view) { return view["outcome"] == "planned"; });
  std::string text = fmt::format("{} of {} views can be taken", planned, plan["views"].size());
  if (planned > 0) {
    text += fmt::format("; nothing comes nearer than {:.1f} mm, the tour takes {:.0f} s",
                        plan["reach"]["margin_mm"].get<double>(),
                        plan["duration_s"].get<double>());
  }
  return text + ".";
}

std::string plan_page(const PlanPage& page) {
  Json source = provenance();
  source.erase("cores");
  const bool is_whole = page.plan["reach"]["share"] == 1.0;
  return render_report(
      {{"title", page.title},
       {"verdict",
        {{"title", "Summary"},
         {"sentence", plan_sentence(page.plan)},
         {"tone", is_whole ? "good" : "neutral"},
         {"details", page.plan["notes"]}}},
       {"when", page.when},
       {"scene",
        {{"picture", base64(png_bytes(page.sheet))},
         {"size_px", {page.sheet.width(), page.sheet.height()}},
         {"note",
          "Arm and cell at each planned view, in their order: the arm grey, what it carries blue, "
          "what stands in the cell orange."}}},
       {"panels", Json::array({panel(page.plan)})},
       {"config_toml", page.toml},
       {"provenance", source}});
}

}  // namespace glint
