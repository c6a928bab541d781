// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/parameter_fit.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <nlopt.hpp>

namespace glint {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Prior kLength = {-0.7, 1.0, -3.5, 3.0};
constexpr Prior kSignal = {0.0, 1.0, -3.0, 3.0};
constexpr Prior kNoise = {-4.0, 2.0, -18.0, 0.7};
constexpr Prior kTinyNoise = {-12.0, 2.0, -18.0, 0.7};
constexpr Prior kShare = {0.0, 1.0, -4.0, 4.0};
constexpr Prior kDerivativeNoise = {-8.0, 3.0, -18.0, 4.0};

}  // namespace

std::vector<Prior> priors_of(const Encoding& encoding, bool is_noisy, bool takes_derivatives) {
  std::vector<Prior> priors(static_cast<std::size_t>(encoding.num_lengths()), kLength);
  priors.push_back(kSignal);
  priors.push_back(is_noisy ? kNoise : kTinyNoise);
  if (encoding.has_branches()) {
    priors.push_back(kShare);
  }
  if (takes_derivatives) {
    priors.push_back(kDerivativeNoise);
  }
  return priors;
}

KernelParameters prior_means(const std::vector<Prior>& priors) {
  KernelParameters means(static_cast<Index>(priors.size()));
  std::ranges::transform(priors, means.begin(), &Prior::mean);
  return means;
}

double prior_loss(const std::vector<Prior>& priors,
                  const KernelParameters& parameters,
                  VectorXd& gradient,
                  double loss) {
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const double z = (parameters[static_cast<Index>(i)] - priors[i].mean) / priors[i].sigma;
    loss += 0.5 * z * z;
    gradient[static_cast<Index>(i)] += z / priors[i].sigma;
  }
  return loss;
}

KernelParameters fitted_parameters(const std::vector<Prior>& priors,
                                   const KernelParameters& start,
                                   int max_steps,
                                   const ParameterLoss& loss) {
  struct Search {
    const ParameterLoss* loss;
    double best_loss = std::numeric_limits<double>::infinity();
    std::vector<double> best;
  };

  std::vector<double> x(start.begin(), start.end());
  std::vector<double> low;
  std::vector<double> high;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    low.push_back(priors[i].low);
    high.push_back(priors[i].high);
    x[i] = std::clamp(x[i], low[i], high[i]);
  }
  Search search{.loss = &loss, .best = x};
  nlopt::opt optimizer(nlopt::LD_LBFGS, static_cast<unsigned>(x.size()));
  optimizer.set_lower_bounds(low);
  optimizer.set_upper_bounds(high);
  optimizer.set_maxeval(max_steps);
  optimizer.set_ftol_abs(1e-3);
  optimizer.set_min_objective(
      [](const std::vector<double>& at, std::vector<double>& derivative, void* data) {
        Search& own = *static_cast<Search*>(data);
        const Eigen::Map<const VectorXd> parameters(at.data(), static_cast<Index>(at.size()));
        VectorXd gradient(parameters.size());
        const double value = (*own.loss)(parameters, gradient);
        if (value < own.best_loss) {
          own.best_loss = value;
          own.best = at;
        }
        std::ranges::copy(gradient, derivative.begin());
        return value;
      },
      &search);
  try {
    double unused = 0.0;
    optimizer.optimize(x, unused);
  } catch (const std::exception&) {
    // It stopped for rounding; the best one seen counts.
  }
  return Eigen::Map<const VectorXd>(search.best.data(), static_cast<Index>(search.best.size()));
}

}  // namespace glint
