// SPDX-License-Identifier: GPL-3.0-or-later
//
// Data of reports for tests of their verdicts.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/report/report.h"

namespace glint {

using Json = nlohmann::ordered_json;

/// A design with CNR `cnr` and evenness 0.8, scored again with fresh seeds to the same values.
inline Json design_with(const std::string& key, double cnr) {
  const Json scores = {{"homogeneity.h_rms", 0.8},
                       {"homogeneity.lit_share", 1.0},
                       {"homogeneity.clipped_share", 0.0},
                       {"defects.made", 1},
                       {"defects.min_cnr", cnr}};
  return {{"key", key},
          {"title", key},
          {"feasible", true},
          {"scores", scores},
          {"rescored", scores},
          {"variables", {{"lighting.tunnel.radius_mm", 120.0}, {"sensor.gain", 2.0}}},
          {"defects", {{{"label", "dent"}, {"width_px", 8.0}}}}};
}

inline Json trial_with(int number, double cnr) {
  return {{"number", number},
          {"failed", false},
          {"feasible", true},
          {"objective", cnr},
          {"scores", {{"defects.min_cnr", cnr}, {"homogeneity.h_rms", 0.8}}}};
}

/// A sound search for the CNR of the worst defect: 5 before, 20 found, nothing on a limit.
inline Json sound_search() {
  return {{"title", "search"},
          {"status", "done"},
          {"objective", {{"name", "defects.min_cnr"}, {"sense", "maximise"}}},
          {"constraints", {{{"name", "homogeneity.h_rms"}, {"min", 0.7}}}},
          {"variables",
           {{{"name", "lighting.tunnel.radius_mm"},
             {"kind", "float"},
             {"low", 80},
             {"high", 160},
             {"log", false},
             {"unit", "mm"}},
            {{"name", "sensor.gain"},
             {"kind", "float"},
             {"low", 1},
             {"high", 3},
             {"log", false},
             {"unit", ""}}}},
          {"designs", {design_with("baseline", 5.0), design_with("winner", 20.0)}},
          {"trials",
           {trial_with(1, 5.0),
            trial_with(2, 7.0),
            trial_with(3, 9.0),
            trial_with(4, 12.0),
            trial_with(5, 20.0)}}};
}

/// Three prototypes without a search, scanned four times each with the same noise.
inline Json prototypes() {
  Json data = sound_search();
  data.erase("status");
  data["variables"] = Json::array();
  data["trials"] = Json::array();
  data["designs"] = {
      design_with("baseline", 5.0), design_with("dome", 9.0), design_with("bar", 7.0)};
  const std::vector<std::vector<double>> scans = {
      {5.1, 4.9, 5.0, 5.2}, {9.1, 8.9, 9.0, 9.2}, {7.1, 6.9, 7.0, 7.2}};
  for (std::size_t i = 0; i < scans.size(); ++i) {
    data["designs"][i]["repeated"]["defects.min_cnr"] = scans[i];
  }
  return data;
}

inline void set_cnr(Json& design, double cnr) {
  design["scores"]["defects.min_cnr"] = cnr;
  design["rescored"]["defects.min_cnr"] = cnr;
}

inline Json runs_with(int second_group) {
  Json runs = {{{"title", "a"},
                {"group", 0},
                {"differs", Json::array()},
                {"objective", {{"name", "defects.min_cnr"}, {"sense", "maximise"}}},
                {"feasible", true},
                {"scores", {{"defects.min_cnr", 5.0}}}}};
  runs.push_back(runs[0]);
  runs[1]["title"] = "b";
  runs[1]["group"] = second_group;
  runs[1]["scores"]["defects.min_cnr"] = 8.0;
  return {{"runs", runs}};
}

inline std::multiset<std::string> codes_of(const Json& data) {
  std::multiset<std::string> codes;
  const Json report = complete_report(data);
  for (const Json& finding : report["verdict"]["findings"]) {
    codes.insert(finding["code"].get<std::string>());
  }
  return codes;
}

inline std::string text_of_code(const Json& data, const std::string& code) {
  const Json report = complete_report(data);
  for (const Json& finding : report["verdict"]["findings"]) {
    if (finding["code"] == code) {
      return finding["text"].get<std::string>();
    }
  }
  return "";
}

inline Json changed(Json data, const std::function<void(Json&)>& change) {
  change(data);
  return data;
}

inline void repeat(Json& design, const std::vector<double>& scans) {
  design["repeated"]["defects.min_cnr"] = scans;
}

}  // namespace glint
