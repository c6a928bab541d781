// SPDX-License-Identifier: GPL-3.0-or-later
//
// Offsets of edges as a linear system in the causes: columns of how each parameter moves every
// edge, noise, and the least squares of any set of parameters. Private to the room. Formulas:
// docs/theory/comparison.md.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "studies/compare/fit/cause_fit.h"

namespace glint::compare_detail {

/// Two parameters beyond this correlation cannot be told from each other by these edges.
inline constexpr double kNotSeparable = 0.99;

class EdgeSystem {
 public:
  /// @param columns     of each edge the px that it moves along its normal per unit of each
  /// parameter
  /// @param offsets_px  of each edge
  /// @param parameters  the first so many are free
  EdgeSystem(Eigen::MatrixXd columns, Eigen::VectorXd offsets_px, std::size_t parameters);

  std::size_t parameters() const { return parameters_; }

  /// Over the variance of each edge's stretch, 1 on average; 0 of outliers (beyond four robust
  /// standard deviations of what all parameters leave). Edges of low contrast scatter more.
  const Eigen::VectorXd& weights() const { return weights_; }

  std::size_t kept() const { return kept_; }

  /// Share of the edges that lie within two pixels of where all parameters have them.
  double agreeing() const { return agreeing_; }

  /// Weighted rms that all parameters leave of the kept edges.
  double noise_px() const { return noise_px_; }

  /// Weighted sum of squared offsets, and what the best values of these parameters leave of it.
  double squares() const { return right_squares_; }

  double rest_of(std::span<const std::size_t> chosen) const;

  /// In inner units.
  Eigen::VectorXd values_of(std::span<const std::size_t> chosen) const;

  /// The set with the least sum of squares over noise plus a price for each parameter, of all sets
  /// whose members can be told from each other.
  std::vector<std::size_t> best_set() const;

  /// Correlation of two parameters' values when the others of `beside` are free as well.
  double correlation(std::size_t one, std::size_t other, std::span<const std::size_t> beside) const;

  /// Standard deviations of the values, in inner units: the larger of those by noise that is alike
  /// for some neighbours, and of those by the scatter of whole stretches of edges (a sandwich),
  /// which holds for noise that differs from edge to edge.
  /// @param rest_px  what the values leave of each edge's offset
  Eigen::VectorXd sigmas_of(std::span<const std::size_t> chosen,
                            const Eigen::VectorXd& rest_px) const;

 private:
  void leave_out_outliers();
  void weigh_by_scatter(const Eigen::VectorXd& rest_px);
  Eigen::VectorXd rest_of_all() const;
  std::pair<Eigen::MatrixXd, Eigen::VectorXd> part_of(std::span<const std::size_t> chosen) const;
  Eigen::VectorXd scales_of(std::span<const std::size_t> chosen) const;
  Eigen::MatrixXd scatter_of(std::span<const std::size_t> chosen,
                             const Eigen::VectorXd& rest_px) const;
  bool are_separable(std::span<const std::size_t> chosen) const;

  std::size_t parameters_;
  Eigen::MatrixXd columns_;  ///< each of length 1
  Eigen::VectorXd offsets_;
  Eigen::VectorXd scales_;  ///< what the columns were divided by
  Eigen::VectorXd weights_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd right_;
  double right_squares_ = 0.0;
  double noise_px_ = 0.0;
  double alike_ = 1.0;  ///< neighbours that tell what one would
  double agreeing_ = 0.0;
  std::size_t kept_ = 0;
};

}  // namespace glint::compare_detail
