// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_page.h"

#include <fmt/format.h>

#include "core/image/image_io.h"
#include "studies/output/provenance.h"
#include "studies/report/report.h"
#include "studies/run/render_maps.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string sentence(const Json& result) {
  const std::size_t count = result["views"].size();
  const bool has_light = count == 0 || result["views"][0].contains("relative_error");
  std::string text = fmt::format("{} view{} of {} x {} pixels",
                                 count,
                                 count == 1 ? "" : "s",
                                 result["width_px"].get<int>(),
                                 result["height_px"].get<int>());
  const bool is_sum = has_light && count > 0 && result["views"][0]["relative_error"].is_null();
  text += is_sum      ? " by sums of direct light."
          : has_light ? " by path tracing."
                      : ": masks and geometry, no light was sampled.";
  if (result["status"] == "interrupted") {
    text += " The rendering was interrupted; this is what there is.";
  }
  return text;
}

/// The colours of the defect map.
Json legend(const std::set<DefectType>& types) {
  Json list = Json::array();
  for (const DefectType type : types) {
    list.push_back({{"name", type_name(type)}, {"colour", defect_colour_css(type)}});
  }
  list.push_back({{"name", "sound surface"}, {"colour", "#ced4d9"}});
  list.push_back({{"name", "beside the part"}, {"colour", "#282e34"}});
  return list;
}

}  // namespace

std::string render_page(const RenderPage& page) {
  Json rendered = {
      {"legend", legend(page.types)}, {"drawing", page.drawing}, {"views", Json::array()}};
  for (const PageView& view : page.views) {
    rendered["views"].emplace_back(view.row)["image"] = base64(view.png);
  }
  if (!page.sheet_png.empty()) {
    rendered["sheet"] = base64(page.sheet_png);
  }
  if (page.result.contains("scores")) {
    rendered["scores"] = page.result["scores"];
  }
  Json source = provenance();
  source.erase("cores");
  return render_report({{"title", page.title},
                        {"verdict",
                         {{"title", "Summary"},
                          {"sentence", sentence(page.result)},
                          {"tone", "neutral"},
                          {"details", page.result["notes"]}}},
                        {"when", page.when},
                        {"scene", {{"facts", page.facts}}},
                        {"rendered", rendered},
                        {"config_toml", page.toml},
                        {"provenance", source}});
}

}  // namespace glint
