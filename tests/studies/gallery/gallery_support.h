// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gallery's studies beside what their folders promise: expected.json and the tables of
// README.md.
#pragma once

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "studies/definition/study.h"

namespace glint::gallery {

inline std::filesystem::path folder_of(const std::string& study) {
  return std::filesystem::path(GLINT_SOURCE_DIR) / "studies" / "gallery" / study;
}

inline std::filesystem::path mesh_folder() {
  return std::filesystem::path(GLINT_SHARED_DIR) / "data" / "meshes";
}

struct Expected {
  double value = 0.0;
  double tolerance = 0.0;  ///< absolute
};

/// "design.score" -> what is expected; designs are the baseline, the prototypes, "winner" and the
/// variants that the tests know.
using ExpectedScores = std::map<std::string, Expected>;

inline ExpectedScores read_expected(const std::string& study) {
  const auto json = nlohmann::json::parse(read_file(folder_of(study) / "expected.json"));
  ExpectedScores expected;
  for (const auto& [name, row] : json.items()) {
    expected[name] = {row.at("value").get<double>(), row.at("tolerance").get<double>()};
  }
  return expected;
}

/// A scene of a study that is no prototype: what `--set` makes of it.
struct Variant {
  std::string design;
  std::vector<KeyValue> sets;
};

inline Variant mesh_variant(const std::string& design,
                            const std::string& file,
                            const std::string& unit,
                            std::vector<KeyValue> more = {}) {
  Variant variant{.design = design,
                  .sets = {{"part.file", (mesh_folder() / file).string()}, {"part.unit", unit}}};
  variant.sets.insert(variant.sets.end(), more.begin(), more.end());
  return variant;
}

/// A number of a README's table: the score of a design, as printed.
struct Printed {
  std::string name;  ///< "design.score"
  double value = 0.0;
  double half_step = 0.0;  ///< half of the last printed digit
  std::string text;
};

/// The text between the first pair of backticks; empty when there is none.
inline std::string in_backticks(const std::string& cell) {
  static const std::regex kPattern("`([^`]+)`");
  std::smatch match;
  return std::regex_search(cell, match, kPattern) ? match[1].str() : std::string();
}

inline std::optional<Printed> printed_number(const std::string& name, const std::string& cell) {
  static const std::regex kNumber(R"(^\**(-?\d+(?:\.(\d+))?)( %)?)");
  std::smatch match;
  const std::size_t begin = cell.find_first_not_of(' ');
  const std::string text = begin == std::string::npos ? std::string() : cell.substr(begin);
  if (!std::regex_search(text, match, kNumber)) {
    return std::nullopt;
  }
  const double scale = match[3].matched ? 0.01 : 1.0;
  const auto decimals = static_cast<double>(match[2].length());
  return Printed{.name = name,
                 .value = scale * std::stod(match[1].str()),
                 .half_step = 0.5 * scale * std::pow(10.0, -decimals),
                 .text = text};
}

/// All numbers of tables whose header names scores in backticks and whose rows begin with a design
/// in backticks. Columns without a score in their header are left out.
inline std::vector<Printed> printed_numbers(const std::string& study) {
  std::vector<Printed> numbers;
  std::vector<std::string> header;
  std::istringstream lines(read_file(folder_of(study) / "README.md"));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("|")) {
      header.clear();
      continue;
    }
    const std::vector<std::string> cells = split(line, '|');
    if (header.empty()) {
      header = cells;
      continue;
    }
    const std::string design = in_backticks(cells.at(1));
    for (std::size_t i = 2; !design.empty() && i < std::min(cells.size(), header.size()); ++i) {
      const std::string score = in_backticks(header[i]);
      const auto number = printed_number(fmt::format("{}.{}", design, score), cells[i]);
      if (!score.empty() && number) {
        numbers.push_back(*number);
      }
    }
  }
  return numbers;
}

/// What the README's tables print is what expected.json has, to the last digit.
/// @param at_least  so many numbers
inline void expect_printed_numbers(const std::string& study, std::size_t at_least) {
  const ExpectedScores expected = read_expected(study);
  const std::vector<Printed> numbers = printed_numbers(study);
  EXPECT_GE(numbers.size(), at_least);
  for (const Printed& number : numbers) {
    const auto row = expected.find(number.name);
    if (row == expected.end()) {
      ADD_FAILURE() << number.name << " = " << number.text << " is not in expected.json";
      continue;
    }
    EXPECT_NEAR(number.value, row->second.value, number.half_step * (1.0 + 1e-6)) << number.name;
  }
}

}  // namespace glint::gallery
