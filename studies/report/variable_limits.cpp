// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/variable_limits.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/report/report_verdict.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

/// Of a variable's range: nearer to its end it lies on its limit.
constexpr double kLimitShare = 0.02;

/// Which end of its range a variable lies on: -1, 0, 1.
int end_of(const Json& variable, double value) {
  const auto low = number_of(variable, "low");
  const auto high = number_of(variable, "high");
  if (!low || !high || !(*high > *low) || text_of(variable, "kind") == "choice") {
    return 0;
  }
  const bool is_log = member(variable, "log") == Json(true) && *low > 0.0 && value > 0.0;
  const double share =
      is_log ? std::log(value / *low) / std::log(*high / *low) : (value - *low) / (*high - *low);
  return share < kLimitShare ? -1 : share > 1.0 - kLimitShare ? 1 : 0;
}

/// Variables that differ in their number alone: control_mm.0, control_mm.1 ...
struct VariableFamily {
  std::string name;
  std::string table;  ///< "left_ring"
  int count = 0;
  int on_limit = 0;
};

/// "half_width_mm" -> "half width"
std::string without_unit(std::string word) {
  for (const std::string_view unit : {"_mm", "_deg", "_um", "_nm", "_px", "_e"}) {
    if (word.ends_with(unit)) {
      word.resize(word.size() - unit.size());
    }
  }
  std::ranges::replace(word, '_', ' ');
  return word;
}

/// "lighting.tunnel.control_mm.2" -> "control point", "sensor.gain" -> "gain"
std::string spoken(const std::string& path, bool has_number) {
  const std::vector<std::string> parts = split(path, '.');
  const std::string word = without_unit(parts[parts.size() - (has_number ? 2 : 1)]);
  return word == "control" ? "control point" : word;
}

bool ends_in_number(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot != std::string::npos && dot + 1 < path.size() &&
         path.find_first_not_of("0123456789", dot + 1) == std::string::npos;
}

/// The table that a variable's key stands in: "left_ring", "viewpoint 0".
std::string table_of(const std::string& path) {
  std::vector<std::string> parts = split(path, '.');
  parts.resize(parts.size() - std::min<std::size_t>(parts.size(), ends_in_number(path) ? 2 : 1));
  if (parts.empty()) {
    return "";
  }
  const bool is_item = parts.size() > 1 && ends_in_number("." + parts.back());
  return is_item ? parts[parts.size() - 2] + " " + parts.back() : parts.back();
}

/// @param is_alone  no other table has variables of that name
std::string family_text(const VariableFamily& family, bool is_alone) {
  const std::string of = is_alone || family.table.empty() ? "" : " of " + family.table;
  if (family.count == 1) {
    return "the " + family.name + of;
  }
  if (family.on_limit == 2 && family.count == 2) {
    return fmt::format("both {}s{}", family.name, of);
  }
  return family.on_limit == family.count
             ? fmt::format("all {} {}s{}", family.count, family.name, of)
             : fmt::format("{} of {} {}s{}", family.on_limit, family.count, family.name, of);
}

/// Those with variables on their limits. Where several tables have a "radius", each is told with
/// its table.
std::vector<std::string> texts_of(const std::vector<VariableFamily>& families) {
  std::vector<std::string> texts;
  for (const VariableFamily& family : families) {
    if (family.on_limit > 0) {
      const auto namesakes = std::ranges::count(families, family.name, &VariableFamily::name);
      texts.push_back(family_text(family, namesakes == 1));
    }
  }
  return texts;
}

/// "a", "a and b", "a, b and c"
std::string listed(const std::vector<std::string>& names) {
  const auto first = std::span(names).first(names.size() - 1);
  return first.empty() ? names.back() : join(first, ", ") + " and " + names.back();
}

/// The family of a variable, added where it is the first of it.
VariableFamily& family_of(std::vector<VariableFamily>& families, const std::string& path) {
  const bool has_number = ends_in_number(path);
  const std::string name = spoken(path, has_number);
  const std::string table = table_of(path);
  const auto known = std::ranges::find_if(families, [&](const VariableFamily& family) {
    return family.name == name && family.table == table;
  });
  return has_number && known != families.end()
             ? *known
             : families.emplace_back(VariableFamily{.name = name, .table = table});
}

/// Whether a variable says how large a light is; periods, slots and places of lights do not.
bool is_size(const std::string& path) {
  constexpr std::array<std::string_view, 7> kSizes = {
      "control", "radius", "outer radius", "half width", "width", "length", "size"};
  const std::vector<std::string> parts = split(path, '.');
  const std::string key = without_unit(parts[parts.size() - (ends_in_number(path) ? 2 : 1)]);
  return path.starts_with("lighting.") &&
         (std::ranges::find(kSizes, key) != kSizes.end() || path == "lighting.tunnel.height_mm");
}

/// What the ends that are met say about the best design.
std::string beyond(bool are_sizes, bool has_low, bool has_high, bool is_one) {
  if (are_sizes && has_low != has_high) {
    return has_high ? "the best design is larger than allowed"
                    : "the best design is smaller than allowed";
  }
  return is_one ? "a better design may lie beyond it" : "a better design may lie beyond them";
}

}  // namespace

std::vector<Finding> findings_on_limits(const Json& data, const Json& design) {
  std::vector<VariableFamily> families;
  bool are_sizes = true;
  bool has_low = false;
  bool has_high = false;
  for (const Json& variable : member(data, "variables")) {
    const std::string path = text_of(variable, "name");
    const auto value = number_of(member(design, "variables"), path);
    VariableFamily& family = family_of(families, path);
    ++family.count;
    const int end = value ? end_of(variable, *value) : 0;
    family.on_limit += end != 0 ? 1 : 0;
    are_sizes = are_sizes && (end == 0 || is_size(path));
    has_low = has_low || end < 0;
    has_high = has_high || end > 0;
  }
  const std::vector<std::string> names = texts_of(families);
  if (names.empty()) {
    return {};
  }
  const auto on_limit = [](int sum, const VariableFamily& family) { return sum + family.on_limit; };
  const bool is_one = std::accumulate(families.begin(), families.end(), 0, on_limit) == 1;
  std::string list = listed(names);
  list.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(list.front())));
  return {{"on_limits",
           fmt::format("{} {}: {}.",
                       list,
                       is_one ? "lies on its limit" : "lie on their limits",
                       beyond(are_sizes, has_low, has_high, is_one))}};
}

}  // namespace glint::report_detail
