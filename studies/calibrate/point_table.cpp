// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/point_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {

PointTable::PointTable(std::string_view text, const std::string& file, std::string columns)
    : rows_(parse_csv(text, file, '#')), columns_(std::move(columns)) {
  if (rows_.size() < 2) {
    throw ConfigError(fmt::format("{}: has no points", file));
  }
  for (const CsvRow& row : rows_) {
    if (row.size() != rows_[0].size()) {
      throw ConfigError(fmt::format("{}has {} fields, must have {}",
                                    row.front().place.prefix(),
                                    row.size(),
                                    rows_[0].size()));
    }
  }
}

std::optional<std::size_t> PointTable::find(std::string_view name) const {
  const CsvRow& head = rows_.front();
  const auto found = std::ranges::find(head, name, &CsvField::text);
  return found == head.end() ? std::nullopt
                             : std::optional(static_cast<std::size_t>(found - head.begin()));
}

std::size_t PointTable::column(std::string_view name) const {
  const auto found = find(name);
  if (!found.has_value()) {
    throw ConfigError(fmt::format(
        "{}has no column {}; {}", rows_.front().front().place.prefix(), name, columns_));
  }
  return *found;
}

const CsvField& PointTable::field(std::size_t row, std::size_t column) const {
  return rows_[row + 1][column];
}

double PointTable::number(std::size_t row, std::size_t column) const {
  const CsvField& found = field(row, column);
  const auto value = found.number();
  if (!value || !std::isfinite(*value)) {
    throw ConfigError(fmt::format("{}'{}' must be a number", found.place.prefix(), found.text));
  }
  return *value;
}

Eigen::Vector3d PointTable::point(std::size_t row,
                                  const std::array<std::size_t, 3>& columns) const {
  const double x = number(row, columns[0]);
  const double y = number(row, columns[1]);
  return {x, y, number(row, columns[2])};
}

}  // namespace glint
