// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/scores_text.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "metrics/scores.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// Of a defect's own scores, in the order of the columns.
constexpr std::array<std::string_view, 10> kColumns = {"cnr",
                                                       "dprime",
                                                       "weber",
                                                       "change",
                                                       "best_frame",
                                                       "peak",
                                                       "michelson",
                                                       "signature",
                                                       "rms_contrast",
                                                       "union"};

/// Shares of everything there is are told in percent.
bool is_share(std::string_view name) {
  return name.ends_with("_share") || name.starts_with("homogeneity.h_") ||
         name == "homogeneity.worst_region" || name == "homogeneity.residual";
}

std::string value_text(std::string_view name, double value) {
  if (is_share(name)) {
    return fmt::format("{:.2f} %", 100.0 * value);
  }
  const std::string_view unit = written_unit(name);
  return fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", unit);
}

/// "defects.dent_1.cnr" -> "dent_1" and "cnr"; empty: it is no score of one defect.
std::pair<std::string, std::string> defect_score(const std::string& name) {
  const std::vector<std::string> parts = split(name, '.');
  const bool is_one = parts.size() == 3 && parts[0] == "defects" && !is_error(name);
  return is_one ? std::pair{parts[1], parts[2]} : std::pair<std::string, std::string>{};
}

/// A line for each defect, in the order of the scores.
std::string defect_table(const Json& scores) {
  std::vector<std::string> labels;
  std::map<std::string, std::map<std::string, double>> values;
  std::size_t width = std::string("defect").size();
  for (const auto& [name, value] : scores.items()) {
    const auto [label, score] = defect_score(name);
    if (label.empty() || !value.is_number()) {
      continue;
    }
    if (!values.contains(label)) {
      labels.push_back(label);
      width = std::max(width, label.size());
    }
    values[label][score] = value.get<double>();
  }
  if (labels.empty()) {
    return "";
  }
  std::string text = fmt::format("\n  {:<{}}", "defect", width);
  for (const std::string_view column : kColumns) {
    text += fmt::format(" {:>12}", column);
  }
  for (const std::string& label : labels) {
    text += fmt::format("\n  {:<{}}", label, width);
    for (const std::string_view column : kColumns) {
      const auto found = values[label].find(std::string(column));
      text += found == values[label].end() ? fmt::format(" {:>12}", "-")
                                           : fmt::format(" {:>12.4g}", found->second);
    }
  }
  return text + "\n  `glint explain defects.<label>.cnr` says what a column means\n";
}

}  // namespace

std::string scores_text(const Json& scores) {
  std::string text;
  for (const auto& [name, value] : scores.items()) {
    if (!value.is_number() || is_error(name) || !defect_score(name).first.empty()) {
      continue;
    }
    std::string shown = value_text(name, value.get<double>());
    const std::string error = error_name(name);
    if (scores.contains(error) && scores[error].is_number()) {
      shown += " +- " + value_text(name, scores[error].get<double>());
    }
    text += fmt::format("  {:<30} {:>20}  {}\n", name, shown, explain_score(name).value_or(""));
  }
  return text + defect_table(scores);
}

}  // namespace glint
