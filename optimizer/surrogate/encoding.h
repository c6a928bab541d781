// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as rows of numbers in which distances mean something: floats and integers by their place
// in the unit cube, choices as one column per value, 1 / sqrt(2) where it is taken, so that two
// different choices lie one apart. Constants have no column; inactive variables are 0.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "optimizer/problem/space.h"

namespace glint {

class Encoding {
 public:
  struct Column {
    std::size_t variable = 0;
    int choice = -1;              ///< index of the value that the column stands for; -1: a number
    Eigen::Index length = 0;      ///< which length scale; all columns of a choice share theirs
    bool is_conditional = false;  ///< there are points where its variable is inactive
  };

  /// @param space  checked
  explicit Encoding(const SearchSpace& space);

  /// num_columns() numbers, then one that is the same for points with the same active variables.
  Eigen::RowVectorXd row(const Point& point) const;
  Eigen::MatrixXd rows(std::span<const Point> points) const;

  const std::vector<Column>& columns() const { return columns_; }

  Eigen::Index num_columns() const { return static_cast<Eigen::Index>(columns_.size()); }

  Eigen::Index num_lengths() const { return num_lengths_; }

  bool has_branches() const { return has_branches_; }

 private:
  SearchSpace space_;
  std::vector<Column> columns_;
  Eigen::Index num_lengths_ = 0;
  bool has_branches_ = false;
};

}  // namespace glint
