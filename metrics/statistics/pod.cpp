// SPDX-License-Identifier: GPL-3.0-or-later
//
// Probability of detection over size from hits and misses: a logistic curve in ln(size), fitted by
// maximum likelihood with Newton's method and halved steps (MIL-HDBK-1823A). The interval of a90
// comes from the profile of the likelihood with Firth's penalty (D. Firth, Biometrika 80, 1993),
// which keeps its promise from 60 trials on where the usual ones are too narrow; its ends are found
// by regula falsi. docs/theory/statistics.md. Cost: a few hundred passes over the trials; memory
// for one number per trial.
#include "metrics/statistics/pod.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "metrics/statistics/quantiles.h"

namespace glint {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLogit90 = 2.1972245773362196;  // ln 9
constexpr double kFirth = 0.5;

struct Outcome {
  double x = 0.0;  ///< ln(size)
  bool is_hit = false;
};

/// Intercept and slope, and what the likelihood is like there.
struct Line {
  double intercept = 0.0;
  double slope = 0.0;
  double log_likelihood = -kInfinity;
  double by_intercept = 0.0;  ///< its derivatives
  double by_slope = 0.0;
  double j_ii = 0.0;  ///< Fisher information
  double j_is = 0.0;
  double j_ss = 0.0;

  double determinant() const { return j_ii * j_ss - j_is * j_is; }
};

/// Of hits and misses, with `penalty` times ln det of the information added: 0, or Firth's half.
class Likelihood {
 public:
  Likelihood(const std::vector<Outcome>& outcomes, double penalty)
      : outcomes_(outcomes), penalty_(penalty), chances_(outcomes.size()) {}

  Line at(double intercept, double slope) {
    Line line = {.intercept = intercept, .slope = slope, .log_likelihood = 0.0};
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      const double x = outcomes_[i].x;
      const double logit = intercept + slope * x;
      const double smaller = std::exp(-std::abs(logit));
      const double p = (logit >= 0.0 ? 1.0 : smaller) / (1.0 + smaller);
      const bool is_likely = (logit >= 0.0) == outcomes_[i].is_hit;
      line.log_likelihood -= std::log1p(smaller) + (is_likely ? 0.0 : std::abs(logit));
      const double weight = p * (1.0 - p);
      line.j_ii += weight;
      line.j_is += weight * x;
      line.j_ss += weight * x * x;
      chances_[i] = p;
    }
    if (penalty_ > 0.0) {
      line.log_likelihood += penalty_ * std::log(std::max(line.determinant(), 0.0));
    }
    add_gradient(line);
    return line;
  }

  /// The most likely line of all; the likelihood must have a finite maximum.
  Line most_likely() {
    Line line = at(0.0, 0.0);
    for (int round = 0; round < 100; ++round) {
      const double determinant = line.determinant();
      const double step_i =
          (line.j_ss * line.by_intercept - line.j_is * line.by_slope) / determinant;
      const double step_s =
          (line.j_ii * line.by_slope - line.j_is * line.by_intercept) / determinant;
      if (!climb(line, step_i, step_s)) {
        break;
      }
    }
    return line;
  }

  /// The most likely of the lines with 90 % at a place that do not fall.
  /// @param hint  a line nearby
  Line most_likely_through(double place, const Line& hint) {
    const auto through = [&](double slope) { return at(kLogit90 - slope * place, slope); };
    Line line = through(std::max(hint.slope, 0.0));
    const double level = (kLogit90 - hint.intercept) / place;  // keeps the middle where it is
    if (std::isfinite(level) && level > 0.0) {
      const Line other = through(level);
      line = other.log_likelihood > line.log_likelihood ? other : line;
    }
    for (int round = 0; round < 100; ++round) {
      const double gradient = line.by_slope - place * line.by_intercept;
      const double information = line.j_ss - 2.0 * place * line.j_is + place * place * line.j_ii;
      const double step = std::max(gradient / std::max(information, 1e-12), -line.slope);
      if (!climb(line, -step * place, step)) {
        break;
      }
    }
    return line;
  }

 private:
  void add_gradient(Line& line) const {
    const double determinant = std::max(line.determinant(), std::numeric_limits<double>::min());
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      const double x = outcomes_[i].x;
      const double p = chances_[i];
      const double leverage =
          p * (1.0 - p) * (line.j_ss - 2.0 * line.j_is * x + line.j_ii * x * x) / determinant;
      const double residual =
          (outcomes_[i].is_hit ? 1.0 : 0.0) - p + 2.0 * penalty_ * leverage * (0.5 - p);
      line.by_intercept += residual;
      line.by_slope += residual * x;
    }
  }

  /// Takes the step, or a part of it that gains. False when there is nothing more to gain.
  bool climb(Line& line, double step_i, double step_s) {
    constexpr double kGain = 1e-11;
    for (int halving = 0; halving < 40; ++halving) {
      const Line next = at(line.intercept + step_i, line.slope + step_s);
      const double gain = next.log_likelihood - line.log_likelihood;
      if (gain >= 0.0) {
        line = next;
        return gain > kGain;
      }
      step_i *= 0.5;
      step_s *= 0.5;
    }
    return false;
  }

  const std::vector<Outcome>& outcomes_;
  double penalty_;
  std::vector<double> chances_;
};

/// A finite maximum needs a miss above a hit, and a hit above a miss.
bool overlaps(const std::vector<Outcome>& outcomes) {
  double min_hit = kInfinity;
  double max_hit = -kInfinity;
  double min_miss = kInfinity;
  double max_miss = -kInfinity;
  for (const Outcome& outcome : outcomes) {
    double& minimum = outcome.is_hit ? min_hit : min_miss;
    double& maximum = outcome.is_hit ? max_hit : max_miss;
    minimum = std::min(minimum, outcome.x);
    maximum = std::max(maximum, outcome.x);
  }
  return max_miss > min_hit && max_hit > min_miss;
}

double place_of_90(const Line& line) {
  return (kLogit90 - line.intercept) / line.slope;
}

/// Of the place with 90 %, to first order.
double standard_error(const Line& line, double place) {
  const double variance =
      (line.j_ss - 2.0 * place * line.j_is + place * place * line.j_ii) / line.determinant();
  return std::sqrt(variance) / line.slope;
}

/// The farthest place of 90 % on one side that the likelihood allows; infinite when any is. The
/// root of twice the drop is nearly linear in it.
double farthest_place(Likelihood& likelihood, const Line& best, double direction, double z) {
  double inside = place_of_90(best);
  double short_of = -z;  // root minus z
  double step = direction * z * standard_error(best, inside);
  const auto beyond = [&](double place) {
    const double drop =
        best.log_likelihood - likelihood.most_likely_through(place, best).log_likelihood;
    return std::sqrt(2.0 * std::max(drop, 0.0)) - z;
  };
  double outside = inside + step;
  double over = beyond(outside);
  for (int doubling = 0; over < 0.0; ++doubling) {
    constexpr int kMaxDoublings = 20;
    if (doubling == kMaxDoublings) {
      return std::copysign(kInfinity, direction);
    }
    inside = outside;
    short_of = over;
    step *= 2.0;
    outside = inside + step;
    over = beyond(outside);
  }
  for (int i = 0; i < 60 && std::abs(outside - inside) > 1e-9 * (1.0 + std::abs(inside)); ++i) {
    const bool is_midway = i % 3 == 2;  // regula falsi alone may creep
    const double part = is_midway ? 0.5 : short_of / (short_of - over);
    const double place = inside + part * (outside - inside);
    const double root = beyond(place);
    if (std::abs(root) < 1e-6) {
      return place;
    }
    (root < 0.0 ? inside : outside) = place;
    (root < 0.0 ? short_of : over) = root;
  }
  return inside;
}

/// In coordinates of ln(size) around 0.
PodFit as_fit(const Line& line, double middle) {
  const double determinant = line.determinant();
  const double v_ii = line.j_ss / determinant;
  const double v_is = -line.j_is / determinant;
  const double v_ss = line.j_ii / determinant;
  return {.intercept = line.intercept - line.slope * middle,
          .slope = line.slope,
          .variance_intercept = v_ii - 2.0 * middle * v_is + middle * middle * v_ss,
          .variance_slope = v_ss,
          .covariance = v_is - middle * v_ss,
          .a50 = std::exp(middle - line.intercept / line.slope)};
}

double mean_ln_size(std::span<const SizedTrial> trials) {
  double sum = 0.0;
  for (const SizedTrial& trial : trials) {
    GLINT_CHECK(trial.size > 0.0 && std::isfinite(trial.size), "sizes are positive");
    sum += std::log(trial.size);
  }
  return sum / static_cast<double>(trials.size());
}

std::vector<Outcome> outcomes_around(double middle, std::span<const SizedTrial> trials) {
  std::vector<Outcome> outcomes;
  for (const SizedTrial& trial : trials) {
    outcomes.push_back({.x = std::log(trial.size) - middle, .is_hit = trial.is_hit});
  }
  return outcomes;
}

/// The fit with the given line, and intervals from the penalised likelihood.
std::optional<PodFit> with_intervals(const Line& line,
                                     double middle,
                                     Likelihood& penalised,
                                     double confidence) {
  const Line best = penalised.most_likely();
  if (!(line.slope > 0.0) || !(best.slope > 0.0)) {
    return std::nullopt;
  }
  const auto end = [&](double direction, double z) {
    return std::exp(middle + farthest_place(penalised, best, direction, z));
  };
  const double z = normal_quantile(0.5 * (1.0 + confidence));
  PodFit fit = as_fit(line, middle);
  fit.a90 = {
      .value = std::exp(middle + place_of_90(line)), .low = end(-1.0, z), .high = end(1.0, z)};
  fit.a90_95 = end(1.0, normal_quantile(0.95));
  return fit;
}

}  // namespace

Estimate PodFit::at(double size, double confidence) const {
  GLINT_CHECK(size > 0.0, "sizes are positive");
  const double x = std::log(size);
  const double logit = intercept + slope * x;
  const double variance = variance_intercept + 2.0 * x * covariance + x * x * variance_slope;
  const double half =
      normal_quantile(0.5 * (1.0 + confidence)) * std::sqrt(std::max(variance, 0.0));
  return {.value = logistic(logit), .low = logistic(logit - half), .high = logistic(logit + half)};
}

std::optional<PodFit> fit_pod(std::span<const SizedTrial> trials, double confidence) {
  const double middle = mean_ln_size(trials);
  const std::vector<Outcome> outcomes = outcomes_around(middle, trials);
  if (!overlaps(outcomes)) {
    return std::nullopt;
  }
  Likelihood penalised(outcomes, kFirth);
  return with_intervals(Likelihood(outcomes, 0.0).most_likely(), middle, penalised, confidence);
}

}  // namespace glint
