// SPDX-License-Identifier: GPL-3.0-or-later
//
// A Gaussian process over a search space: from evaluated designs to what is to be expected of any
// other one, with its uncertainty.
//
// Constant mean (generalised least squares), kernel of kernel.h, noise fitted and, where known, the
// values' own standard errors beside it. The parameters have the largest marginal likelihood times
// a prior, found from two starts in a counted number of steps. No clock, no random numbers, one
// thread: the same calls give the same bits.
//
// Duplicates, constant values and nearly equal points are allowed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "optimizer/problem/space.h"
#include "optimizer/surrogate/encoding.h"
#include "optimizer/surrogate/kernel.h"

namespace glint {

/// Of the value itself, without the noise of an evaluation.
struct Posterior {
  double mean = 0.0;
  double variance = 0.0;  ///< >= 0
};

/// Many predictions that vary together.
struct JointPosterior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// Predictions of several rows and their derivatives by the encoded columns.
struct SlopedPosterior {
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;     ///< > 0
  Eigen::MatrixXd mean_slopes;  ///< one row per row, one column per column
  Eigen::MatrixXd variance_slopes;
};

struct GaussianProcessSettings {
  bool is_noisy = true;  ///< false: the prior expects noise only where values have an error
  int max_steps = 40;    ///< >= 1, evaluations of the likelihood per start
  int max_fresh_points = 1000000;  ///< with more points there is no start from the prior's middle
};

class GaussianProcess {
 public:
  /// @param space  checked
  explicit GaussianProcess(const SearchSpace& space, GaussianProcessSettings settings = {});

  /// Chooses the parameters anew; the last ones are one of the starts.
  /// @param points  canonical, at least one
  /// @param values  finite, one per point
  /// @param errors  standard errors, one per point, NaN where not known; empty: none is
  void fit(std::span<const Point> points,
           std::span<const double> values,
           std::span<const double> errors = {});

  /// The same data with given parameters.
  void set(const KernelParameters& parameters,
           std::span<const Point> points,
           std::span<const double> values,
           std::span<const double> errors = {});

  /// One more value; the parameters stay. Needs a fit.
  void add(const Point& point, double value, std::optional<double> error = {});

  /// Needs a fit, as all below.
  Posterior predict(const Point& point) const;
  std::vector<Posterior> predict(std::span<const Point> points) const;
  /// The means alone, much cheaper.
  std::vector<double> predict_means(std::span<const Point> points) const;
  JointPosterior predict_jointly(std::span<const Point> points) const;
  /// The same of rows of encoding(), into two columns: mean and variance.
  Eigen::MatrixX2d predict_rows(const Eigen::MatrixXd& rows) const;

  SlopedPosterior predict_with_slopes(const Eigen::MatrixXd& rows) const;

  /// The means at the points it knows, in their order; costs next to nothing.
  Eigen::VectorXd means_at_points() const;

  /// What each value would be expected to be without itself, its noise included.
  std::vector<Posterior> leave_one_out() const;
  /// 1 - (squared errors of leave_one_out()) / (squared deviations from the mean); 1 is perfect, 0
  /// no better than the mean. 0 for constant values.
  double leave_one_out_q2() const;

  /// Standard deviation of an evaluation's noise, without the values' own errors.
  double noise() const;

  const Encoding& encoding() const { return encoding_; }

  const KernelParameters& parameters() const { return parameters_; }

  int num_points() const { return static_cast<int>(values_.size()); }

 private:
  void set_data(std::span<const Point> points,
                std::span<const double> values,
                std::span<const double> errors);
  double loss(const KernelParameters& parameters, Eigen::VectorXd& gradient) const;
  KernelParameters fitted_from(const KernelParameters& start) const;
  void factorise();
  void solve();

  Encoding encoding_;
  GaussianProcessSettings settings_;
  KernelParameters parameters_;
  Eigen::MatrixXd rows_;       ///< encoded points
  Eigen::VectorXd values_;     ///< mean 0, variance 1 when they were set
  Eigen::VectorXd own_noise_;  ///< variances of values_, 0 where not known
  double offset_ = 0.0;
  double scale_ = 1.0;
  Eigen::MatrixXd factor_;  ///< lower triangle L, L L^T = covariance with noise
  double jitter_ = 0.0;
  double mean_ = 0.0;        ///< of values_
  Eigen::VectorXd weights_;  ///< inverse covariance times (values_ - mean_)
};

}  // namespace glint
