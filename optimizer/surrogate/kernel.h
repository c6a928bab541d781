// SPDX-License-Identifier: GPL-3.0-or-later
//
// Covariance of two designs: Matern 5/2 with one length per variable,
//
//   k = s^2 [(1 - w) m(r_shared) + w [same active variables] m(r_all)],
//   m(r) = (1 + sqrt(5) r + 5/3 r^2) exp(-sqrt(5) r),
//
// where r_shared looks at the variables that are active everywhere and r_all at all that are active
// in both. Without conditional variables w = 0. (C. Rasmussen and C. Williams, "Gaussian Processes
// for Machine Learning", 2006, 4.2; the sum over branches is own.)
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "optimizer/surrogate/encoding.h"

namespace glint {

/// Logarithms of: lengths (parts of a variable's range), signal variance, noise variance; then,
/// with branches, log(w / (1 - w)). Of values with mean 0 and variance 1.
using KernelParameters = Eigen::VectorXd;

Eigen::Index num_parameters(const Encoding& encoding);

/// One of the two terms: everything within the same branch, or what is active everywhere.
struct KernelTerm {
  bool is_own = false;
  double weight = 1.0;  ///< its variance
};

std::array<KernelTerm, 2> kernel_terms(const Encoding& encoding,
                                       const KernelParameters& parameters);

/// w; 0 without branches.
double own_share(const Encoding& encoding, const KernelParameters& parameters);

/// Covariances of the values at encoded rows, without noise: one row per row of a.
Eigen::MatrixXd covariance(const Encoding& encoding,
                           const KernelParameters& parameters,
                           const Eigen::MatrixXd& a,
                           const Eigen::MatrixXd& b);

/// Half the sum of b(i, k) * d covariance(i, k) / d parameter, for each parameter but the noise,
/// whose entry is 0. @param b symmetric
Eigen::VectorXd half_trace_of_derivative(const Encoding& encoding,
                                         const KernelParameters& parameters,
                                         const Eigen::MatrixXd& rows,
                                         const Eigen::MatrixXd& b);

/// For each matrix of weights, with one row per row of `data` and one column per row of `rows`: the
/// sum over i of weights(i, r) * d covariance(data i, rows r) / d rows(r, c), at (r, c).
std::vector<Eigen::MatrixXd> weighted_derivatives(const Encoding& encoding,
                                                  const KernelParameters& parameters,
                                                  const Eigen::MatrixXd& data,
                                                  const Eigen::MatrixXd& rows,
                                                  std::span<const Eigen::MatrixXd> weights);

double signal_variance(const Encoding& encoding, const KernelParameters& parameters);
double noise_variance(const Encoding& encoding, const KernelParameters& parameters);

}  // namespace glint
