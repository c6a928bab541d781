// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tables of points in CSV files, their columns found by name.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/csv.h"

namespace glint {

class PointTable {
 public:
  /// Lines with '#' do not count. @param columns  what such a table has, for messages
  /// @throws ConfigError with file:line:column: no rows, rows of different lengths
  PointTable(std::string_view text, const std::string& file, std::string columns);

  std::size_t size() const { return rows_.size() - 1; }

  /// Of the column with that name. @throws ConfigError when there is none
  std::size_t column(std::string_view name) const;
  std::optional<std::size_t> find(std::string_view name) const;

  /// @param row  0 to size() - 1
  const CsvField& field(std::size_t row, std::size_t column) const;

  /// @throws ConfigError when it is no finite number
  double number(std::size_t row, std::size_t column) const;
  Eigen::Vector3d point(std::size_t row, const std::array<std::size_t, 3>& columns) const;

 private:
  std::vector<CsvRow> rows_;  ///< the head first
  std::string columns_;
};

}  // namespace glint
