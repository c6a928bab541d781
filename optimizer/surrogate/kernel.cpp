// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/kernel.h"

#include <array>
#include <cmath>

namespace glint {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns in units of their lengths; those that the term does not look at are 0.
MatrixXd scaled(const Encoding& encoding,
                const KernelParameters& parameters,
                const MatrixXd& rows,
                bool is_own) {
  MatrixXd result = rows.leftCols(encoding.num_columns());
  for (Index c = 0; c < result.cols(); ++c) {
    const Encoding::Column& column = encoding.columns()[static_cast<std::size_t>(c)];
    const bool is_seen = is_own || !column.is_conditional;
    result.col(c) *= is_seen ? std::exp(-parameters[column.length]) : 0.0;
  }
  return result;
}

/// sqrt(5) times the distances.
MatrixXd distances(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd squared = (-2.0 * a * b.transpose()).colwise() + a.rowwise().squaredNorm();
  squared.rowwise() += b.rowwise().squaredNorm().transpose();
  return (5.0 * squared.array().max(0.0)).sqrt().matrix();
}

/// Sets to 0 what lies in different branches.
void mask_branches(const MatrixXd& a, const MatrixXd& b, MatrixXd& values) {
  const auto branch_a = a.rightCols<1>();
  const auto branch_b = b.rightCols<1>();
  for (Index k = 0; k < values.cols(); ++k) {
    values.col(k).array() *= (branch_a.array() == branch_b(k, 0)).cast<double>();
  }
}

MatrixXd matern(const MatrixXd& d) {
  return ((1.0 + d.array() + d.array().square() / 3.0) * (-d.array()).exp()).matrix();
}

}  // namespace

Index num_parameters(const Encoding& encoding) {
  return encoding.num_lengths() + 2 + (encoding.has_branches() ? 1 : 0);
}

double own_share(const Encoding& encoding, const KernelParameters& parameters) {
  if (!encoding.has_branches()) {
    return 0.0;
  }
  return 1.0 / (1.0 + std::exp(-parameters[encoding.num_lengths() + 2]));
}

std::array<KernelTerm, 2> kernel_terms(const Encoding& encoding,
                                       const KernelParameters& parameters) {
  const double share = own_share(encoding, parameters);
  const double signal = signal_variance(encoding, parameters);
  return {KernelTerm{false, signal * (1.0 - share)}, KernelTerm{true, signal * share}};
}

double signal_variance(const Encoding& encoding, const KernelParameters& parameters) {
  return std::exp(parameters[encoding.num_lengths()]);
}

double noise_variance(const Encoding& encoding, const KernelParameters& parameters) {
  return std::exp(parameters[encoding.num_lengths() + 1]);
}

MatrixXd covariance(const Encoding& encoding,
                    const KernelParameters& parameters,
                    const MatrixXd& a,
                    const MatrixXd& b) {
  MatrixXd sum = MatrixXd::Zero(a.rows(), b.rows());
  for (const KernelTerm& term : kernel_terms(encoding, parameters)) {
    if (term.weight == 0.0) {
      continue;
    }
    MatrixXd values = matern(distances(scaled(encoding, parameters, a, term.is_own),
                                       scaled(encoding, parameters, b, term.is_own)));
    if (term.is_own) {
      mask_branches(a, b, values);
    }
    sum += term.weight * values;
  }
  return sum;
}

std::vector<MatrixXd> weighted_derivatives(const Encoding& encoding,
                                           const KernelParameters& parameters,
                                           const MatrixXd& data,
                                           const MatrixXd& rows,
                                           std::span<const MatrixXd> weights) {
  std::vector<MatrixXd> derivatives(weights.size(),
                                    MatrixXd::Zero(rows.rows(), encoding.num_columns()));
  for (const KernelTerm& term : kernel_terms(encoding, parameters)) {
    if (term.weight == 0.0) {
      continue;
    }
    const MatrixXd a = scaled(encoding, parameters, data, term.is_own);
    const MatrixXd b = scaled(encoding, parameters, rows, term.is_own);
    const MatrixXd d = distances(a, b);
    // d m / d x = -5/3 (1 + sqrt(5) r) exp(-sqrt(5) r) * difference / length^2
    MatrixXd factors = (term.weight * -5.0 / 3.0 * (1.0 + d.array()) * (-d.array()).exp()).matrix();
    if (term.is_own) {
      mask_branches(data, rows, factors);
    }
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const MatrixXd weighted = factors.cwiseProduct(weights[k]);
      MatrixXd part = b;
      part.array().colwise() *= weighted.colwise().sum().transpose().array();
      part -= weighted.transpose() * a;
      for (Index c = 0; c < part.cols(); ++c) {
        const Encoding::Column& column = encoding.columns()[static_cast<std::size_t>(c)];
        derivatives[k].col(c) += std::exp(-parameters[column.length]) * part.col(c);
      }
    }
  }
  return derivatives;
}

VectorXd half_trace_of_derivative(const Encoding& encoding,
                                  const KernelParameters& parameters,
                                  const MatrixXd& rows,
                                  const MatrixXd& b) {
  const Index num_lengths = encoding.num_lengths();
  VectorXd gradient = VectorXd::Zero(num_parameters(encoding));
  for (const KernelTerm& term : kernel_terms(encoding, parameters)) {
    if (term.weight == 0.0) {
      continue;
    }
    const MatrixXd x = scaled(encoding, parameters, rows, term.is_own);
    const MatrixXd d = distances(x, x);
    MatrixXd masked = b;
    if (term.is_own) {
      mask_branches(rows, rows, masked);
    }
    const double value = 0.5 * term.weight * (masked.array() * matern(d).array()).sum();
    // d m / d log(length) = 5/3 (1 + sqrt(5) r) exp(-sqrt(5) r) * (difference / length)^2
    const MatrixXd weights =
        (term.weight * 5.0 / 3.0 * masked.array() * (1.0 + d.array()) * (-d.array()).exp())
            .matrix();
    const VectorXd row_sums = weights.rowwise().sum();
    const MatrixXd product = weights * x;
    for (Index c = 0; c < x.cols(); ++c) {
      const Index length = encoding.columns()[static_cast<std::size_t>(c)].length;
      gradient[length] += row_sums.dot(x.col(c).cwiseAbs2()) - x.col(c).dot(product.col(c));
    }
    gradient[num_lengths] += value;
    if (encoding.has_branches()) {
      const double share = own_share(encoding, parameters);
      gradient[num_lengths + 2] += term.is_own ? value * (1.0 - share) : -value * share;
    }
  }
  return gradient;
}

}  // namespace glint
