// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/quantiles.h"

#include <cmath>
#include <numbers>

#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include "core/error.h"

namespace glint {
namespace {

/// In double throughout: long double has other widths on other machines.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

void check_probability(double probability) {
  GLINT_CHECK(probability > 0.0 && probability < 1.0, "a probability lies in (0, 1)");
}

}  // namespace

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

double normal_quantile(double probability) {
  check_probability(probability);
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * probability, InDouble());
}

double logistic(double x) {
  return x >= 0.0 ? 1.0 / (1.0 + std::exp(-x)) : 1.0 - 1.0 / (1.0 + std::exp(x));
}

double t_quantile(double probability, double freedom) {
  check_probability(probability);
  GLINT_CHECK(freedom >= 1.0, "at least one degree of freedom");
  return boost::math::quantile(boost::math::students_t_distribution<double, InDouble>(freedom),
                               probability);
}

double noncentral_t_quantile(double probability, double freedom, double shift) {
  check_probability(probability);
  GLINT_CHECK(freedom >= 1.0, "at least one degree of freedom");
  using NoncentralT = boost::math::non_central_t_distribution<double, InDouble>;
  return boost::math::quantile(NoncentralT(freedom, shift), probability);
}

double gamma_quantile(double probability, double shape) {
  check_probability(probability);
  GLINT_CHECK(shape > 0.0, "the shape of a gamma distribution is positive");
  return boost::math::gamma_p_inv(shape, probability, InDouble());
}

}  // namespace glint
