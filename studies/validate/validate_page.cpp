// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_page.h"

#include <algorithm>
#include <vector>

#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxPairs = 12;  ///< with pictures on the page; the folder has all
constexpr std::size_t kMaxBefore = 3;

const char* tone_of(const std::string& agreement) {
  return agreement == "agrees" ? "good" : agreement == "does_not_agree" ? "bad" : "neutral";
}

std::vector<std::string> details_of(const Json& result) {
  std::vector<std::string> lines;
  for (const Json& number : result["undetermined"]) {
    lines.push_back(number["text"].get<std::string>());
  }
  for (const char* key : {"advice", "notes"}) {
    for (const Json& line : result[key]) {
      lines.push_back(line.get<std::string>());
    }
  }
  return lines;
}

}  // namespace

std::string validate_page(const Json& result,
                          std::span<const PagePair> pairs,
                          std::span<const PagePair> before) {
  Json validation = result;
  validation.erase("pairs");
  for (std::size_t i = 0; i < std::min(before.size(), kMaxBefore); ++i) {
    validation["before"][i]["overlay"] = before[i].pictures["overlay"];
  }
  Json comparison = {{"pairs", result["pairs"]}, {"yardstick", nullptr}};
  for (std::size_t i = 0; i < std::min(pairs.size(), kMaxPairs); ++i) {
    comparison["pairs"][i].update(pairs[i].pictures);
  }
  for (std::size_t i = 0; i < std::min(pairs.size(), before.size()); ++i) {
    validation["before"][i]["overlay_after"] = pairs[i].pictures["overlay"];
  }
  return render_report({{"title", "Simulation and reality"},
                        {"verdict",
                         {{"title", "Verdict"},
                          {"sentence", result["verdict"]},
                          {"tone", tone_of(result["agreement"].get<std::string>())},
                          {"details", details_of(result)}}},
                        {"validation", validation},
                        {"comparison", comparison},
                        {"provenance", provenance()}});
}

}  // namespace glint
