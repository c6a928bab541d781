// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/statistics/rank_agreement.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace glint {
namespace {

constexpr double kStandardErrors = 2.0;

int sign(double value) {
  return (value > 0.0) - (value < 0.0);
}

bool are_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

std::size_t smallest(std::span<const double> values) {
  return static_cast<std::size_t>(std::ranges::min_element(values) - values.begin());
}

void check(std::span<const double> cheap,
           std::span<const double> reference,
           std::span<const double> reference_errors) {
  GLINT_CHECK(cheap.size() >= 2, "an order takes at least two things");
  GLINT_CHECK(reference.size() == cheap.size() && reference_errors.size() == cheap.size(),
              "one figure and one error of each thing");
  GLINT_CHECK(are_finite(cheap) && are_finite(reference) && are_finite(reference_errors),
              "figures are finite");
}

}  // namespace

RankAgreement rank_agreement(std::span<const double> cheap,
                             std::span<const double> reference,
                             std::span<const double> reference_errors) {
  check(cheap, reference, reference_errors);
  RankAgreement result;
  int balance = 0;
  for (std::size_t i = 0; i < cheap.size(); ++i) {
    for (std::size_t j = i + 1; j < cheap.size(); ++j) {
      const double difference = reference[i] - reference[j];
      const double error = std::hypot(reference_errors[i], reference_errors[j]);
      if (std::abs(difference) > kStandardErrors * error) {
        balance += sign(difference) * sign(cheap[i] - cheap[j]);
        ++result.pairs;
      }
    }
  }
  result.tau = result.pairs > 0 ? balance / static_cast<double>(result.pairs) : 0.0;
  result.winner = smallest(cheap);
  const std::size_t best = smallest(reference);
  result.winner_behind = reference[result.winner] - reference[best];
  result.winner_behind_se =
      result.winner == best ? 0.0
                            : std::hypot(reference_errors[result.winner], reference_errors[best]);
  return result;
}

bool is_ranking_right(const RankAgreement& agreement, double min_tau) {
  return agreement.pairs > 0 && agreement.tau >= min_tau &&
         agreement.winner_behind <= kStandardErrors * agreement.winner_behind_se;
}

}  // namespace glint
