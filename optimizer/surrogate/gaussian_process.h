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
// Duplicates, constant values and nearly equal points are allowed. Where a point's derivatives are
// known they are observations like values (observed_kernel.h), with a noise of their own.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "optimizer/problem/space.h"
#include "optimizer/surrogate/encoding.h"
#include "optimizer/surrogate/kernel.h"
#include "optimizer/surrogate/observed_kernel.h"
#include "optimizer/surrogate/parameter_fit.h"

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
struct PosteriorWithDerivatives {
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;          ///< > 0
  Eigen::MatrixXd mean_derivatives;  ///< one row per row, one column per column
  Eigen::MatrixXd variance_derivatives;
};

struct GaussianProcessSettings {
  bool is_noisy = true;  ///< false: the prior expects noise only where values have an error
  int max_steps = 40;    ///< >= 1, evaluations of the likelihood per start
  int max_fresh_points = 1000000;  ///< with more points there is no start from the prior's middle
  bool takes_derivatives = false;  ///< one more parameter: log of the noise variance of derivatives
};

/// By the coordinates of the unit cube, one number per variable, NaN where not known; empty: none.
using UnitDerivatives = std::vector<double>;

class GaussianProcess {
 public:
  /// @param space  checked
  explicit GaussianProcess(const SearchSpace& space, GaussianProcessSettings settings = {});

  /// Chooses the parameters anew; the last ones are one of the starts.
  /// @param points  canonical, at least one
  /// @param values  finite, one per point
  /// @param errors  standard errors, one per point, NaN where not known; empty: none is
  /// @param derivatives  one per point, or none; only where settings.takes_derivatives
  void fit(std::span<const Point> points,
           std::span<const double> values,
           std::span<const double> errors = {},
           std::span<const UnitDerivatives> derivatives = {});

  /// The same data with given parameters.
  void set(const KernelParameters& parameters,
           std::span<const Point> points,
           std::span<const double> values,
           std::span<const double> errors = {},
           std::span<const UnitDerivatives> derivatives = {});

  /// One more value; the parameters stay. Needs a fit.
  void add(const Point& point,
           double value,
           std::optional<double> error = {},
           const UnitDerivatives& derivatives = {});

  /// Lets go of derivatives whose distance from what everything else leads to expect of them is
  /// more than so many standard deviations. Needs a fit. @return how many
  int drop_contradicted_derivatives(double max_deviations);

  /// Derivatives that it knows, those let go included.
  int num_derivatives() const { return static_cast<int>(seen_.size()) - num_points(); }

  /// Needs a fit, as all below.
  Posterior predict(const Point& point) const;
  std::vector<Posterior> predict(std::span<const Point> points) const;
  /// The means alone, much cheaper.
  std::vector<double> predict_means(std::span<const Point> points) const;
  JointPosterior predict_jointly(std::span<const Point> points) const;
  /// The same of rows of encoding(), into two columns: mean and variance.
  Eigen::MatrixX2d predict_rows(const Eigen::MatrixXd& rows) const;

  PosteriorWithDerivatives predict_with_derivatives(const Eigen::MatrixXd& rows) const;

  /// The means at the points it knows, in their order; costs next to nothing.
  Eigen::VectorXd means_at_points() const;

  /// What it was told of them.
  Eigen::VectorXd values_at_points() const;

  /// What each value would be expected to be without itself, its noise included.
  std::vector<Posterior> leave_one_out() const;
  /// 1 - (squared errors of leave_one_out()) / (squared deviations from the mean); 1 is perfect, 0
  /// no better than the mean. 0 for constant values.
  double leave_one_out_q2() const;

  /// Standard deviation of an evaluation's noise, without the values' own errors.
  double noise() const;

  const Encoding& encoding() const { return encoding_; }

  const KernelParameters& parameters() const { return parameters_; }

  int num_points() const { return static_cast<int>(rows_.rows()); }

 private:
  void set_data(std::span<const Point> points,
                std::span<const double> values,
                std::span<const double> errors,
                std::span<const UnitDerivatives> derivatives);
  void see_derivatives(Eigen::Index point, const UnitDerivatives& derivatives);
  void grow(const Eigen::RowVectorXd& row, const Observation& what, double value, double own_noise);
  double prior_variance(Eigen::Index column) const;
  void append(const Observation& what, double value, double own_noise);
  Observed observed(const KernelParameters& parameters) const;
  Eigen::MatrixXd gram(const KernelParameters& parameters) const;
  Eigen::MatrixXd covariance_with(const Eigen::MatrixXd& rows) const;
  Eigen::VectorXd values_alone(const Eigen::VectorXd& observations) const;
  double noise_of(const KernelParameters& parameters, std::size_t observation) const;
  double loss(const KernelParameters& parameters, Eigen::VectorXd& gradient) const;
  std::vector<Prior> priors() const;
  KernelParameters fitted_from(const KernelParameters& start) const;
  void factorise();
  void solve();

  Encoding encoding_;
  GaussianProcessSettings settings_;
  KernelParameters parameters_;
  Eigen::MatrixXd rows_;           ///< encoded points
  std::vector<Observation> seen_;  ///< what values_ are of; without derivatives each point's value
  bool has_derivatives_ = false;   ///< seen_ holds some
  Eigen::VectorXd is_value_;       ///< 1 for values, 0 for derivatives
  Eigen::VectorXd values_;         ///< mean 0, variance 1 when they were set; derivatives alike
  Eigen::VectorXd own_noise_;      ///< variances of values_, 0 where not known
  double offset_ = 0.0;
  double scale_ = 1.0;
  Eigen::MatrixXd factor_;  ///< lower triangle L, L L^T = covariance with noise
  double jitter_ = 0.0;
  double mean_ = 0.0;        ///< of values_
  Eigen::VectorXd weights_;  ///< inverse covariance times (values_ - mean_)
};

}  // namespace glint
