// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which parameters of a kernel are likely: priors, and the search for the best ones (NLopt).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "optimizer/surrogate/encoding.h"
#include "optimizer/surrogate/kernel.h"

namespace glint {

/// Normal prior of the logarithm of a parameter, and its box.
struct Prior {
  double mean = 0.0;
  double sigma = 1.0;
  double low = 0.0;
  double high = 1.0;
};

/// One per parameter. @param takes_derivatives  the last one is of the noise of derivatives
std::vector<Prior> priors_of(const Encoding& encoding, bool is_noisy, bool takes_derivatives);

KernelParameters prior_means(const std::vector<Prior>& priors);

/// A loss with minus the logarithm of the prior, without its constant; the derivatives are added to
/// the gradient.
double prior_loss(const std::vector<Prior>& priors,
                  const KernelParameters& parameters,
                  Eigen::VectorXd& gradient,
                  double loss);

/// A loss and, into the vector, its derivatives by the parameters.
using ParameterLoss = std::function<double(const KernelParameters&, Eigen::VectorXd&)>;

/// The parameters of the smallest loss that so many evaluations from a start find.
KernelParameters fitted_parameters(const std::vector<Prior>& priors,
                                   const KernelParameters& start,
                                   int max_steps,
                                   const ParameterLoss& loss);

}  // namespace glint
