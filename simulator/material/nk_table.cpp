// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/nk_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "core/config/located_yaml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr double kNmPerUm = 1000.0;
constexpr std::string_view kBlank = " \t\r";

struct Line {
  int number = 0;
  std::string text;
};

struct Column {
  std::vector<double> wavelength_nm;
  std::vector<double> value;
};

[[noreturn]] void refuse(const std::string& file, int line, const std::string& message) {
  throw ConfigError(Place{.file = file, .line = line}.prefix() + message);
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) {
    return {};
  }
  return std::string(text.substr(first, text.find_last_not_of(kBlank) - first + 1));
}

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (std::string& line : split(text, '\n')) {
    lines.push_back({.number = static_cast<int>(lines.size()) + 1, .text = std::move(line)});
  }
  return lines;
}

/// The numbers of a row, separated by blanks or commas.
std::vector<double> numbers_of(const std::string& file, const Line& line) {
  constexpr std::string_view kSeparators = " \t\r,";
  std::vector<double> numbers;
  std::string_view rest = line.text;
  for (;;) {
    const std::size_t first = rest.find_first_not_of(kSeparators);
    if (first == std::string_view::npos) {
      return numbers;
    }
    rest.remove_prefix(first);
    const std::string_view word = rest.substr(0, rest.find_first_of(kSeparators));
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      refuse(file, line.number, fmt::format("\"{}\" is no number", word));
    }
    numbers.push_back(value);
    rest.remove_prefix(word.size());
  }
}

std::vector<double> row_of(const std::string& file, const Line& line, std::size_t count) {
  std::vector<double> row = numbers_of(file, line);
  if (row.size() != count) {
    refuse(file,
           line.number,
           fmt::format("has {} numbers, must have {}: wavelength in micrometres, {}",
                       row.size(),
                       count,
                       count == 3 ? "n, k" : "then n or k"));
  }
  row[0] *= kNmPerUm;
  return row;
}

void check_rising(const std::string& file,
                  int line,
                  const std::vector<double>& so_far,
                  double next) {
  if (next <= 0.0 || (!so_far.empty() && next <= so_far.back())) {
    refuse(file, line, "the wavelengths must be positive and rise from row to row");
  }
}

void append(NkTable& table, const Line& line, const std::vector<double>& row) {
  check_rising(table.file, line.number, table.wavelength_nm, row[0]);
  if (row[1] <= 0.0 || row[2] < 0.0) {
    refuse(table.file,
           line.number,
           fmt::format("n is {}, k is {}; must be > 0 and >= 0", row[1], row[2]));
  }
  table.wavelength_nm.push_back(row[0]);
  table.n.push_back(row[1]);
  table.k.push_back(row[2]);
}

/// The first table of n and k under DATA. @throws ConfigError
const ConfigNode& tabulated(const ConfigNode& root, const std::string& file) {
  const ConfigNode* data = root.find("DATA");
  if (data == nullptr || data->kind != ConfigNode::Kind::kArray || data->items.empty()) {
    refuse(file, 1, "holds no table under DATA");
  }
  for (const ConfigNode& entry : data->items) {
    const ConfigNode* type = entry.find("type");
    const ConfigNode* rows = entry.find("data");
    if (type != nullptr && rows != nullptr && type->text == "tabulated nk") {
      return *rows;
    }
  }
  const ConfigNode* type = data->items.front().find("type");
  const ConfigNode& where = type != nullptr ? *type : data->items.front();
  refuse(file,
         where.place.line,
         fmt::format(R"(type is "{}", must be "tabulated nk": metals need n and k)", where.text));
}

NkTable parse_yaml(std::string_view text, const std::string& file) {
  const ConfigNode root = parse_located_yaml(text, file, YamlNulls::kLeftOut);
  const ConfigNode& data = tabulated(root, file);
  NkTable table = {.file = file};
  for (Line& line : lines_of(data.text)) {
    line.number += data.place.line;  // rows begin below "data: |"
    const std::string row = trimmed(line.text);
    if (!row.empty() && row.front() != '#') {
      append(table, line, row_of(file, line, 3));
    }
  }
  return table;
}

double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto above = std::lower_bound(x.begin(), x.end(), at);
  const auto i = static_cast<std::size_t>(above - x.begin());
  if (i == 0) {
    return y.front();
  }
  const double share = (at - x[i - 1]) / (x[i] - x[i - 1]);
  return std::lerp(y[i - 1], y[i], share);  // exact at a row, never beyond its neighbours
}

/// Two tables as one, at the rows of the first that the second covers.
NkTable joined(const std::string& file, const Column& n, const Column& k, int line) {
  NkTable table = {.file = file};
  for (std::size_t i = 0; i < n.value.size(); ++i) {
    const double x = n.wavelength_nm[i];
    if (!k.value.empty() && x >= k.wavelength_nm.front() && x <= k.wavelength_nm.back()) {
      append(table, {.number = line}, {x, n.value[i], between(k.wavelength_nm, k.value, x)});
    }
  }
  return table;
}

/// Without core/csv.h: header lines within the file begin tables of their own, and rows are read by
/// the same function as those of YAML, which blanks separate.
NkTable parse_csv(const std::vector<Line>& lines, const std::string& file) {
  NkTable table = {.file = file};
  Column n;
  Column k;
  Column* column = nullptr;
  for (const Line& line : lines) {
    const std::string text = trimmed(line.text);
    if (text == "wl,n,k") {
      column = nullptr;
    } else if (text == "wl,n" || text == "wl,k") {
      column = text == "wl,n" ? &n : &k;
    } else if (!text.empty() && column == nullptr) {
      append(table, line, row_of(file, line, 3));
    } else if (!text.empty()) {
      const std::vector<double> row = row_of(file, line, 2);
      check_rising(file, line.number, column->wavelength_nm, row[0]);
      column->wavelength_nm.push_back(row[0]);
      column->value.push_back(row[1]);
    }
  }
  return table.n.empty() ? joined(file, n, k, static_cast<int>(lines.size())) : table;
}

}  // namespace

RefractiveIndex NkTable::at(double at_nm) const {
  if (!(at_nm >= wavelength_nm.front() && at_nm <= wavelength_nm.back())) {
    throw ConfigError(fmt::format("{}: has no values at {} nm, only from {} to {} nm",
                                  file,
                                  shortest(at_nm),
                                  shortest(wavelength_nm.front()),
                                  shortest(wavelength_nm.back())));
  }
  return {.n = between(wavelength_nm, n, at_nm), .k = between(wavelength_nm, k, at_nm)};
}

NkTable parse_nk(std::string_view text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) {  // as spreadsheets write it
    text.remove_prefix(3);
  }
  const std::vector<Line> lines = lines_of(text);
  const bool is_csv = text.starts_with("wl,");
  NkTable table = is_csv ? parse_csv(lines, file) : parse_yaml(text, file);
  if (table.n.empty()) {
    refuse(file, static_cast<int>(lines.size()), "holds no rows of wavelength, n and k");
  }
  return table;
}

NkTable read_nk(const std::filesystem::path& path) {
  return parse_nk(read_file(path), path.string());
}

}  // namespace glint
