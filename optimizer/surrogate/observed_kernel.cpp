// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/observed_kernel.h"

#include <cmath>

namespace glint {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// The kernel and its derivatives between two points x and y, of one term.
class Pair {
 public:
  /// @param inverse  1 / length of each column
  /// @param s        difference / length of each column
  Pair(const KernelTerm& term, const RowVectorXd& inverse, const RowVectorXd& s)
      : inverse_(inverse), s_(s), a_(std::sqrt(5.0) * s.norm()) {
    const double decay = term.weight * std::exp(-a_);
    value_ = (1.0 + a_ + a_ * a_ / 3.0) * decay;
    f_ = 5.0 / 3.0 * (1.0 + a_) * decay;
    g_ = 25.0 / 3.0 * decay;
  }

  /// What is observed at x with what is observed at y.
  double covariance(Index at_x, Index at_y) const {
    if (at_x == Observation::kValue && at_y == Observation::kValue) {
      return value_;
    }
    if (at_x == Observation::kValue) {
      return f_ * s_[at_y] * inverse_[at_y];
    }
    if (at_y == Observation::kValue) {
      return -f_ * s_[at_x] * inverse_[at_x];
    }
    return ((at_x == at_y ? f_ : 0.0) - g_ * s_[at_x] * s_[at_y]) * inverse_[at_x] * inverse_[at_y];
  }

  /// Its derivative by the logarithm of the length of column m.
  double by_length(Index at_x, Index at_y, Index m) const {
    const double square = s_[m] * s_[m];
    if (at_x == Observation::kValue && at_y == Observation::kValue) {
      return f_ * square;
    }
    if (at_x == Observation::kValue || at_y == Observation::kValue) {
      const Index c = at_x == Observation::kValue ? at_y : at_x;
      const double sign = at_x == Observation::kValue ? 1.0 : -1.0;
      return sign * (g_ * square - (c == m ? 2.0 * f_ : 0.0)) * s_[c] * inverse_[c];
    }
    const double same = at_x == at_y ? 1.0 : 0.0;
    const double own = (at_x == m ? 1.0 : 0.0) + (at_y == m ? 1.0 : 0.0);
    const double product = s_[at_x] * s_[at_y];
    const double of_g = a_ > 1e-12 ? 5.0 * g_ * square / a_ : 0.0;
    const double sum = same * (g_ * square - own * f_) + product * (2.0 * own * g_ - of_g);
    return sum * inverse_[at_x] * inverse_[at_y];
  }

  Index num_columns() const { return s_.size(); }

  bool sees(Index column) const { return s_[column] != 0.0 || inverse_[column] != 0.0; }

 private:
  const RowVectorXd& inverse_;
  const RowVectorXd& s_;
  double a_ = 0.0;
  double value_ = 0.0;
  double f_ = 0.0;
  double g_ = 0.0;
};

/// 1 / length of each column, 0 for those that the term does not look at.
RowVectorXd inverse_lengths(const Encoding& encoding,
                            const KernelParameters& parameters,
                            const KernelTerm& term) {
  RowVectorXd inverse(encoding.num_columns());
  for (Index c = 0; c < inverse.size(); ++c) {
    const Encoding::Column& column = encoding.columns()[static_cast<std::size_t>(c)];
    const bool is_seen = term.is_own || !column.is_conditional;
    inverse[c] = is_seen ? std::exp(-parameters[column.length]) : 0.0;
  }
  return inverse;
}

/// The observations at each point.
std::vector<std::vector<Index>> by_point(const Observed& observed) {
  std::vector<std::vector<Index>> lists(static_cast<std::size_t>(observed.points.rows()));
  for (std::size_t i = 0; i < observed.seen.size(); ++i) {
    lists[static_cast<std::size_t>(observed.seen[i].point)].push_back(static_cast<Index>(i));
  }
  return lists;
}

/// Calls with a Pair of each term for the points x and rows y that it relates.
template <class Use>
void for_each_pair(const Observed& observed,
                   const MatrixXd& rows,
                   bool is_triangle,
                   const Use& use) {
  const Index columns = observed.encoding.num_columns();
  for (const KernelTerm& term : kernel_terms(observed.encoding, observed.parameters)) {
    if (term.weight == 0.0) {
      continue;
    }
    const RowVectorXd inverse = inverse_lengths(observed.encoding, observed.parameters, term);
    RowVectorXd s(columns);
    for (Index y = 0; y < rows.rows(); ++y) {
      for (Index x = 0; x < (is_triangle ? y + 1 : observed.points.rows()); ++x) {
        if (term.is_own && observed.points(x, columns) != rows(y, columns)) {
          continue;
        }
        s = (observed.points.row(x).head(columns) - rows.row(y).head(columns))
                .cwiseProduct(inverse);
        use(term, Pair(term, inverse, s), x, y);
      }
    }
  }
}

}  // namespace

MatrixXd observed_covariance(const Observed& observed) {
  const auto size = static_cast<Index>(observed.seen.size());
  MatrixXd result = MatrixXd::Zero(size, size);
  const std::vector<std::vector<Index>> lists = by_point(observed);
  const auto column = [&](Index i) { return observed.seen[static_cast<std::size_t>(i)].column; };
  for_each_pair(
      observed, observed.points, true, [&](const KernelTerm&, const Pair& pair, Index x, Index y) {
        for (const Index i : lists[static_cast<std::size_t>(x)]) {
          for (const Index k : lists[static_cast<std::size_t>(y)]) {
            const double value = pair.covariance(column(i), column(k));
            result(i, k) += value;
            if (x != y) {
              result(k, i) += value;
            }
          }
        }
      });
  return result;
}

MatrixXd observed_covariance(const Observed& observed, const MatrixXd& rows) {
  MatrixXd result = MatrixXd::Zero(static_cast<Index>(observed.seen.size()), rows.rows());
  const std::vector<std::vector<Index>> lists = by_point(observed);
  for_each_pair(observed, rows, false, [&](const KernelTerm&, const Pair& pair, Index x, Index y) {
    for (const Index i : lists[static_cast<std::size_t>(x)]) {
      const Index column = observed.seen[static_cast<std::size_t>(i)].column;
      result(i, y) += pair.covariance(column, Observation::kValue);
    }
  });
  return result;
}

VectorXd observed_covariance(const Observed& observed, const RowVectorXd& row, Index column) {
  VectorXd result = VectorXd::Zero(static_cast<Index>(observed.seen.size()));
  const std::vector<std::vector<Index>> lists = by_point(observed);
  for_each_pair(
      observed, MatrixXd(row), false, [&](const KernelTerm&, const Pair& pair, Index x, Index) {
        for (const Index i : lists[static_cast<std::size_t>(x)]) {
          result[i] += pair.covariance(observed.seen[static_cast<std::size_t>(i)].column, column);
        }
      });
  return result;
}

std::vector<MatrixXd> observed_derivatives(const Observed& observed,
                                           const MatrixXd& rows,
                                           const std::vector<MatrixXd>& weights) {
  const Index columns = observed.encoding.num_columns();
  std::vector<MatrixXd> derivatives(weights.size(), MatrixXd::Zero(rows.rows(), columns));
  const std::vector<std::vector<Index>> lists = by_point(observed);
  for_each_pair(observed, rows, false, [&](const KernelTerm&, const Pair& pair, Index x, Index y) {
    for (const Index i : lists[static_cast<std::size_t>(x)]) {
      const Index column = observed.seen[static_cast<std::size_t>(i)].column;
      for (Index c = 0; c < columns; ++c) {
        const double derivative = pair.covariance(column, c);
        for (std::size_t k = 0; k < weights.size(); ++k) {
          derivatives[k](y, c) += weights[k](i, y) * derivative;
        }
      }
    }
  });
  return derivatives;
}

VectorXd observed_half_trace(const Observed& observed, const MatrixXd& b) {
  const Encoding& encoding = observed.encoding;
  const Index num_lengths = encoding.num_lengths();
  VectorXd gradient = VectorXd::Zero(num_parameters(encoding));
  const double share = own_share(encoding, observed.parameters);
  const std::vector<std::vector<Index>> lists = by_point(observed);
  const auto column = [&](Index i) { return observed.seen[static_cast<std::size_t>(i)].column; };
  const auto use = [&](const KernelTerm& term, const Pair& pair, Index x, Index y) {
    const double times = x == y ? 0.5 : 1.0;
    for (const Index i : lists[static_cast<std::size_t>(x)]) {
      for (const Index k : lists[static_cast<std::size_t>(y)]) {
        const double weight = times * b(i, k);
        const double value = weight * pair.covariance(column(i), column(k));
        gradient[num_lengths] += value;
        if (encoding.has_branches()) {
          gradient[num_lengths + 2] += term.is_own ? value * (1.0 - share) : -value * share;
        }
        for (Index m = 0; m < pair.num_columns(); ++m) {
          if (pair.sees(m)) {
            gradient[encoding.columns()[static_cast<std::size_t>(m)].length] +=
                weight * pair.by_length(column(i), column(k), m);
          }
        }
      }
    }
  };
  for_each_pair(observed, observed.points, true, use);
  return gradient;
}

}  // namespace glint
