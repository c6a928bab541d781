// SPDX-License-Identifier: GPL-3.0-or-later
//
// Covariances of values and of derivatives by encoded columns, under the kernel of kernel.h. With
// s = (x - y) / length, a = sqrt(5) |s| and, for one term of variance w,
//
//   F = 5/3 w (1 + a) exp(-a),   G = 25/3 w exp(-a):
//
//   cov(f(x), d f(y) / d y_e)              = F s_e / l_e
//   cov(d f(x) / d x_c, d f(y) / d y_e)    = ([c = e] F - G s_c s_e) / (l_c l_e)
//
// (C. Rasmussen and C. Williams, "Gaussian Processes for Machine Learning", 2006, 9.4; tests
// compare with differences.)
#pragma once

#include <Eigen/Core>
#include <vector>

#include "optimizer/surrogate/encoding.h"
#include "optimizer/surrogate/kernel.h"

namespace glint {

/// What is known at a point: the value, or its derivative by one of the encoded columns.
struct Observation {
  static constexpr Eigen::Index kValue = -1;

  Eigen::Index point = 0;  ///< row of the encoded points
  Eigen::Index column = kValue;
};

/// Observations and the encoded points that they refer to.
struct Observed {
  const Encoding& encoding;
  const KernelParameters& parameters;  ///< those of kernel.h come first
  const Eigen::MatrixXd& points;
  const std::vector<Observation>& seen;
};

/// Of all observations with each other, without noise.
Eigen::MatrixXd observed_covariance(const Observed& observed);

/// Of all observations with the values at encoded rows: one row per observation.
Eigen::MatrixXd observed_covariance(const Observed& observed, const Eigen::MatrixXd& rows);

/// Of all observations with one at an encoded row. @param column  as Observation::column
Eigen::VectorXd observed_covariance(const Observed& observed,
                                    const Eigen::RowVectorXd& row,
                                    Eigen::Index column);

/// For each matrix of weights, with one row per observation and one column per row of `rows`: the
/// sum of weights(i, r) * d covariance(i, value at rows r) / d rows(r, c), at (r, c).
std::vector<Eigen::MatrixXd> observed_derivatives(const Observed& observed,
                                                  const Eigen::MatrixXd& rows,
                                                  const std::vector<Eigen::MatrixXd>& weights);

/// Half the sum of b(i, k) * d covariance(i, k) / d parameter, for each parameter of kernel.h but
/// the noise, whose entry is 0. @param b symmetric, one row per observation
Eigen::VectorXd observed_half_trace(const Observed& observed, const Eigen::MatrixXd& b);

}  // namespace glint
