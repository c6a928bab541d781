// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cover/cover_page.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::string place_text(const Json& place) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm",
                     place[0].get<double>(),
                     place[1].get<double>(),
                     place[2].get<double>());
}

/// How the views were chosen, as the end of a sentence.
std::string choice_text(const Json& choice) {
  if (choice["proven"].get<bool>()) {
    return "; no other choice of as many inspects more";
  }
  return choice["method"] == "greedy"
             ? ", one after the other, each that which adds most"
             : " by branch and bound, which ended before all better choices were ruled out";
}

std::string smallest_text(const Json& smallest) {
  return fmt::format(
      "The smallest defect that is found is at most {:.3g} \u00b5m wide on half of the inspected "
      "surface, {:.3g} \u00b5m on 95 % of it.",
      smallest["median_um"].get<double>(),
      smallest["p95_um"].get<double>());
}

/// What a defect must have to count as found, and that its contrast is not told place by place.
std::string found_text(const Json& result) {
  const auto width_px = result["smallest_defect"]["defect_px"].get<double>();
  if (!result.contains("pod")) {
    return fmt::format(
        "Found means {:.3g} pixels wide in the finest view of the place (coverage.defect_px), "
        "whatever the defect's contrast: no study of the probability of detection was given "
        "(--pod).",
        width_px);
  }
  const Json& pod = result["pod"];
  return fmt::format(
      "Found means {:.3g} pixels wide in the finest view of the place (coverage.defect_px), and as "
      "large as what the design {} finds nine times of ten ({:.4g} \u00b5m, a pixel being {:.4g} "
      "\u00b5m), in proportion to the pixel. That is one number for the whole surface: contrast "
      "counts as on the parts of that study, and is not measured place by place.",
      width_px,
      pod["design"].get<std::string>(),
      1e3 * pod["a90_mm"].get<double>(),
      pod["pixel_um"].get<double>());
}

std::vector<std::string> details(const Json& result) {
  std::vector<std::string> lines;
  if (const Json& gap = result["largest_gap"]; !gap.is_null()) {
    lines.push_back(
        fmt::format("The largest piece that no view inspects has {:.3g} mm\u00b2, is {:.3g} mm "
                    "across and lies at {}; most of it is {}.",
                    gap["area_mm2"].get<double>(),
                    gap["size_mm"].get<double>(),
                    place_text(gap["place_mm"]),
                    gap["mostly"].get<std::string>()));
  }
  if (const Json& smallest = result["smallest_defect"]; !smallest.is_null()) {
    lines.push_back(smallest_text(smallest));
    lines.push_back(found_text(result));
  }
  if (result.contains("choice")) {
    const Json& choice = result["choice"];
    lines.push_back(fmt::format("The views were chosen from {} candidates{}.",
                                choice["candidates"].get<int>(),
                                choice_text(choice)));
  }
  if (!result["has_light"].get<bool>()) {
    lines.emplace_back("Brightness was not looked at: this is what geometry allows.");
  }
  return lines;
}

}  // namespace

std::string coverage_sentence(const Json& result) {
  const std::size_t views = result["views"].size();
  std::string text = fmt::format("{} of the surface is inspected by {} view{}",
                                 percent(result["c1"].get<double>()),
                                 views,
                                 views == 1 ? "" : "s");
  if (result["ck"].size() > 1) {
    text += fmt::format(", {} by two or more from directions far enough apart",
                        percent(result["ck"][1].get<double>()));
  }
  return text + ".";
}

std::string cover_page(const CoverPage& page) {
  Json coverage = page.result;
  coverage["pictures"] = Json::array();
  for (const CoveragePicture& picture : page.pictures) {
    coverage["pictures"].push_back(
        {{"caption", picture.caption}, {"image", base64(png_bytes(picture.image))}});
  }
  coverage["legend"] = Json::array();
  for (const LegendEntry& entry : page.legend) {
    coverage["legend"].push_back(
        {{"name", entry.name}, {"colour", css_colour(entry.colour)}, {"share", entry.share}});
  }
  Json source = provenance();
  source.erase("cores");
  return render_report({{"title", page.title},
                        {"verdict",
                         {{"title", "Summary"},
                          {"sentence", coverage_sentence(page.result)},
                          {"tone", "neutral"},
                          {"details", details(page.result)}}},
                        {"when", page.when},
                        {"coverage", coverage},
                        {"config_toml", page.toml},
                        {"provenance", source}});
}

}  // namespace glint
