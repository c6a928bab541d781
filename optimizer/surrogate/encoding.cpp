// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/encoding.h"

namespace glint {

namespace {

constexpr double kHalfRoot = 0.7071067811865476;

}  // namespace

Encoding::Encoding(const SearchSpace& space) : space_(space) {
  for (std::size_t i = 0; i < space.variables.size(); ++i) {
    const Variable& variable = space.variables[i];
    if (num_values(variable) <= 1.0) {
      continue;
    }
    const bool is_conditional = !variable.when_name.empty();
    const bool is_choice = variable.kind == Variable::Kind::kChoice;
    const int num_columns = is_choice ? static_cast<int>(variable.choices.size()) : 1;
    for (int k = 0; k < num_columns; ++k) {
      columns_.push_back({i, is_choice ? k : -1, num_lengths_, is_conditional});
    }
    ++num_lengths_;
    has_branches_ = has_branches_ || is_conditional;
  }
}

Eigen::RowVectorXd Encoding::row(const Point& point) const {
  const std::vector<double> unit = unit_from_point(space_, point);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(num_columns() + 1);
  double branch = 0.0;
  for (Eigen::Index c = 0; c < num_columns(); ++c) {
    const Column& column = columns_[static_cast<std::size_t>(c)];
    const bool is_inactive = column.is_conditional && !is_active(space_, point, column.variable);
    branch = column.is_conditional ? 2.0 * branch + (is_inactive ? 0.0 : 1.0) : branch;
    if (is_inactive) {
      continue;
    }
    if (column.choice < 0) {
      row[c] = unit[column.variable];
    } else if (point[column.variable] == column.choice) {
      row[c] = kHalfRoot;
    }
  }
  row[num_columns()] = branch;
  return row;
}

Eigen::MatrixXd Encoding::rows(std::span<const Point> points) const {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), num_columns() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = row(points[i]);
  }
  return rows;
}

}  // namespace glint
