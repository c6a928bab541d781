// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/population_report.h"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/output/read_json.h"
#include "studies/population/population_text.h"
#include "studies/report/report_wording.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using population_detail::a90_text;
using population_detail::largest_size;
using population_detail::rate_text;
using population_detail::share_text;
using population_detail::size_text;
using report_detail::measured;

/// A file of the run's folder; null in a folder of an earlier version, which has none.
Json read_charts(const fs::path& file) {
  return fs::exists(file) ? read_json(file) : Json(nullptr);
}

Json confusion_table(const Json& baseline) {
  Json head = {"the expert says"};
  Json rows = Json::array();
  for (const auto& [expert, row] : baseline["confusion"].items()) {
    Json cells = {expert};
    for (const auto& [sorted, count] : row.items()) {
      if (rows.empty()) {
        head.push_back("sorted " + sorted);
      }
      cells.push_back(fmt::format("{}", count.get<int>()));
    }
    rows.push_back(cells);
  }
  return {{"caption",
           fmt::format("The {} tested parts: {} in the expert's class, {}.",
                       baseline["tested"].get<int>(),
                       baseline["right"].get<int>(),
                       share_text(baseline["share_right"]))},
          {"head", head},
          {"rows", rows}};
}

Json wrong_table(const Json& baseline) {
  Json rows = Json::array();
  for (const Json& part : baseline["wrong_parts"]) {
    rows.push_back({fmt::format("{}", part["part"].get<int>()),
                    part["expert"],
                    part["sorted"],
                    fmt::format("{:.3f}", part["widest_hole_mm"].get<double>()),
                    fmt::format("{}", part["holes"].get<int>()),
                    fmt::format("{:.3f}", part["longest_scratch_mm"].get<double>()),
                    part["imprinted"].get<bool>() ? "yes" : "no"});
  }
  const Json& border = baseline["near_border"];
  return {{"caption",
           fmt::format("Parts in another class than the expert's. {} of the {} tested parts lie "
                       "within {:g} % of one of the expert's limits of size; {} of the {} wrong "
                       "ones are among them.",
                       border["parts"].get<int>(),
                       baseline["tested"].get<int>(),
                       100.0 * border["within"].get<double>(),
                       border["wrong_near_border"].get<int>(),
                       border["wrong"].get<int>())},
          {"head",
           {"part",
            "expert",
            "sorted",
            "widest hole (mm)",
            "holes",
            "longest scratch (mm)",
            "imprinted"}},
          {"rows", rows}};
}

Json lightings_table(const Json& designs) {
  Json rows = Json::array();
  for (const auto& [key, design] : designs.items()) {
    rows.push_back({design["title"],
                    fmt::format("{}", design["tested"].get<int>()),
                    share_text(design["share_right"]),
                    share_text(design["share_right_with_own_limits"]),
                    design.contains("share_found") ? share_text(design["share_found"]) : "-",
                    fmt::format("{}", design["other_kind"].get<int>()),
                    rate_text(design["false_alarms"]),
                    fmt::format("{:.1f} %", 100.0 * design["region_share"].get<double>())});
  }
  return {{"caption",
           "Each lighting sees the same parts. Limits learned there, and those of the study's own "
           "lighting; false alarms on flawless parts."},
          {"head",
           {"lighting",
            "tested parts",
            "in the expert's class",
            "with the own lighting's limits",
            "defects found",
            "as the other kind",
            "false alarms a part",
            "inspected"}},
          {"rows", rows}};
}

Json sorting_charts(const fs::path& run, const Json& sorting) {
  Json charts = Json::array();
  for (Json& sizes : read_charts(run / "sorting_sizes.json")) {
    sizes["kind"] = "sizes";
    charts.push_back(std::move(sizes));
  }
  if (sorting["designs"].size() > 1) {
    charts.push_back({{"kind", "lightings"}, {"designs", sorting["designs"]}});
  }
  return charts;
}

Json sorting_panel(const fs::path& run, const Json& sorting) {
  const Json& baseline = sorting["designs"]["baseline"];
  return {
      {"id", "sorting"},
      {"title", "Sorting"},
      {"lead",
       fmt::format("Limits are learned from {} of {} parts and tested on the other {}. "
                   "Intervals hold the truth with {:g} % confidence (shares: Wilson; rates: "
                   "Garwood).",
                   baseline["learned_from"].get<int>(),
                   baseline["parts"].get<int>(),
                   baseline["tested"].get<int>(),
                   100.0 * sorting["confidence"].get<double>())},
      {"charts", sorting_charts(run, sorting)},
      {"tables",
       {confusion_table(baseline), wrong_table(baseline), lightings_table(sorting["designs"])}}};
}

Json pod_table(const Json& pod) {
  const std::string unit = pod["unit"];
  Json rows = Json::array();
  for (const auto& [key, design] : pod["designs"].items()) {
    const Json& fit = design["fit"];
    const double largest = largest_size(design);
    rows.push_back({design["title"],
                    fmt::format("{}", design["defects"].get<int>()),
                    fmt::format("{}", design["masked"].get<int>()),
                    fit.is_null() ? "-" : size_text(fit["a50"], largest),
                    a90_text(fit, largest),
                    fit.is_null() ? "-" : size_text(fit["a90_95"], largest),
                    a90_text(design["fit_all_places"], largest),
                    rate_text(design["false_alarms"])});
  }
  return {
      {"caption",
       fmt::format("Sizes in {}. Curves are of defects where the line looks; where it does not, "
                   "a defect is missed whatever its size. The last a90 counts these as misses.",
                   unit)},
      {"head",
       {"lighting",
        "defects",
        "not inspected",
        "a50",
        "a90",
        "a90/95",
        "a90 of all places",
        "false alarms a part"}},
      {"rows", rows}};
}

Json levels_table(const Json& pod) {
  Json head = {
      fmt::format("{} ({})", pod["size"].get<std::string>(), pod["unit"].get<std::string>())};
  std::vector<Json> rows;
  for (const auto& [key, design] : pod["designs"].items()) {
    head.push_back(design["title"]);
    std::size_t i = 0;
    for (const Json& level : design["levels"]) {
      if (rows.size() <= i) {
        rows.push_back({measured(level["size"].get<double>())});
      }
      rows[i++].push_back(fmt::format("{} of {}",
                                      level["hits"].get<int>(),
                                      level["defects"].get<int>() - level["masked"].get<int>()));
    }
  }
  return {{"caption", "Defects found of those where the line looks, as they were counted."},
          {"head", head},
          {"rows", rows}};
}

Json pod_panel(const fs::path& run, const Json& pod) {
  const Json curves = read_charts(run / "pod_curves.json");
  return {{"id", "pod"},
          {"title", "Probability of detection"},
          {"lead",
           "Each lighting sees the same parts, at the threshold that [inspection] asks for there. "
           "Curves are logistic in the logarithm of size (MIL-HDBK-1823A); a90 is found nine times "
           "of ten, a90/95 with 95 % confidence."},
          {"charts", Json::array({{{"kind", "pod"}, {"pod", pod}, {"curves", curves}}})},
          {"tables", {pod_table(pod), levels_table(pod)}}};
}

}  // namespace

Json population_panels(const fs::path& run, const Json& result) {
  Json panels = Json::array();
  if (result.contains("sorting")) {
    panels.push_back(sorting_panel(run, result["sorting"]));
  }
  if (result.contains("pod")) {
    panels.push_back(pod_panel(run, result["pod"]));
  }
  return panels;
}

std::string population_summary(const Json& result) {
  std::string text;
  if (result.contains("sorting")) {
    for (const auto& [key, design] : result["sorting"]["designs"].items()) {
      text += fmt::format("  {:<24} {} in the expert's class, {} false alarms a part\n",
                          key,
                          share_text(design["share_right"]),
                          rate_text(design["false_alarms"]));
    }
  }
  return text;
}

}  // namespace glint
