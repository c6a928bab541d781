// SPDX-License-Identifier: GPL-3.0-or-later
//
// Causes are freed one after the other: all are looked at by slopes from where the fit began, the
// most promising of each kind are fitted, and what a later one makes needless is taken back.
#include "studies/validate/grey_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/Cholesky>

#include "studies/validate/grey_terms.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using validate_detail::GreyModel;
using validate_detail::GreyNumber;
using validate_detail::GreyProblem;
using validate_detail::GreyState;
using validate_detail::GreySystem;
using validate_detail::GreyTerm;

constexpr Index kLeastPixels = 200;
constexpr double kPixelsAlike = 10.0;  ///< neighbours tell about the same
constexpr double kPrice = 14.0;        ///< 3.7 standard deviations for each number
constexpr double kFloor = 0.003;       ///< of the mean grey: no model is better
constexpr int kRounds = 6;
constexpr double kSettledMm = 0.1;
constexpr double kHuber = 2.5;

struct Fitted {
  GreyState state;
  std::vector<GreyTerm> terms;
  double score = std::numeric_limits<double>::max();
  VectorXd sigma;
  GreySystem system;  ///< of the last slopes
};

double median_size(const VectorXd& values) {
  std::vector<double> sizes(static_cast<std::size_t>(values.size()));
  for (Index i = 0; i < values.size(); ++i) {
    sizes[static_cast<std::size_t>(i)] = std::abs(values[i]);
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return 1.4826 * *middle;
}

/// Robust least squares of a step. A weak wish for small steps keeps apart what the pictures
/// cannot: exposure and the powers of all segments together.
VectorXd step_of(const GreySystem& system, const VectorXd& left, VectorXd* sigma = nullptr) {
  const double noise = std::max(median_size(left), kFloor);
  const VectorXd weights = left.unaryExpr([&](double value) {
    const double ratio = std::abs(value) / (kHuber * noise);
    return 1.0 / std::max(1.0, ratio);
  });
  const MatrixXd weighted = weights.asDiagonal() * system.columns;
  MatrixXd normal = system.columns.transpose() * weighted;
  const double scale = normal.diagonal().maxCoeff();
  for (Index i = 0; i < normal.rows(); ++i) {
    const bool is_segment =
        system.numbers[static_cast<std::size_t>(i)].term.fault == GreyFault::kSegments;
    normal(i, i) += (is_segment ? 1e-4 : 1e-9) * scale;
  }
  const Eigen::LDLT<MatrixXd> solver(normal);
  if (sigma != nullptr) {
    const MatrixXd covariance = solver.solve(MatrixXd::Identity(normal.rows(), normal.cols()));
    *sigma = noise * std::sqrt(kPixelsAlike) * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
  return solver.solve(weighted.transpose() * left);
}

double robust_rms(const VectorXd& left) {
  const double noise = std::max(median_size(left), kFloor);
  double sum = 0.0;
  for (Index i = 0; i < left.size(); ++i) {
    const double ratio = std::abs(left[i]) / (4.0 * kHuber * noise);
    sum += left[i] * left[i] / std::max(1.0, ratio);
  }
  return std::sqrt(sum / static_cast<double>(left.size()));
}

double score_of(const VectorXd& left, std::size_t numbers) {
  const double rms = robust_rms(left);
  const double n = static_cast<double>(left.size()) / kPixelsAlike;
  return n * std::log(rms * rms + kFloor * kFloor) + kPrice * static_cast<double>(numbers);
}

/// The score after a step along the slopes, if grey values were linear.
double linear_score(const GreySystem& system, const VectorXd& left) {
  VectorXd rest = left;
  for (int round = 0; round < 2; ++round) {
    rest -= system.columns * step_of(system, rest);
  }
  return score_of(rest, system.numbers.size());
}

GreySystem joined(GreySystem first, const GreySystem& second) {
  for (std::size_t i = 0; i < second.numbers.size(); ++i) {
    first.add(second.columns.col(static_cast<Index>(i)), second.numbers[i]);
  }
  return first;
}

class GreyFitter {
 public:
  GreyFitter(SceneStore& store, std::span<const GreyDesign> designs) : problem_(store, designs) {}

  std::vector<GreyFit> fit(const GreyOptions& options) {
    std::vector<GreyFit> fits(model().designs().size());
    if (model().lights().empty() || model().real().size() < kLeastPixels) {
      return fits;
    }
    const GreyState start = problem_.start();
    const Fitted exposed = fitted(start, own_exposures());
    double most = 0.0;
    for (std::size_t d = 0; d < fits.size(); ++d) {
      fits[d].is_known = model().rows(d).count >= kLeastPixels;
      fits[d].before = even_share(start, d);
      fits[d].exposed = even_share(exposed.state, d);
      most = std::max(most, fits[d].exposed);
    }
    const bool is_searching = most > options.agree_share;
    const Fitted best = is_searching ? searched(options.good_share) : exposed;
    for (std::size_t d = 0; d < fits.size(); ++d) {
      tell(best, d, fits[d]);
      if (!is_searching) {
        fits[d].faults = {GreyFault::kExposure};
        fits[d].values.resize(1);
        fits[d].values[0].value = fits[d].change.exposure;
      }
    }
    return fits;
  }

 private:
  const GreyModel& model() const { return problem_.model(); }

  VectorXd left_at(const GreyState& state) { return model().real() - problem_.predicted(state); }

  double even_share(const GreyState& state, std::size_t design) {
    return model().even_rms(left_at(state), design);
  }

  double most_even_share(const GreyState& state) {
    double most = 0.0;
    for (std::size_t d = 0; d < model().designs().size(); ++d) {
      most = std::max(most, even_share(state, d));
    }
    return most;
  }

  std::vector<GreyTerm> own_exposures() const {
    std::vector<GreyTerm> terms = {{.fault = GreyFault::kExposure}};
    for (std::size_t d = 1; d < model().designs().size(); ++d) {
      terms.push_back({.fault = GreyFault::kLightPower, .of = d});
    }
    return terms;
  }

  Fitted searched(double good_share) {
    Fitted best = fitted(problem_.start(), {{.fault = GreyFault::kExposure}});
    while (most_even_share(best.state) > good_share && improve(best, good_share)) {
      while (simplify(best)) {
      }
    }
    return best;
  }

  /// Gauss-Newton from a state with some numbers free. Slopes by place and roughness cost
  /// renderings, and hold for two steps.
  Fitted fitted(GreyState state, const std::vector<GreyTerm>& terms) {
    const bool is_linear = std::ranges::none_of(terms, [](const GreyTerm& term) {
      return term.fault == GreyFault::kLightPlace || term.fault == GreyFault::kRoughness;
    });
    Fitted best = {.terms = terms};
    GreySystem system;
    VectorXd left = left_at(state);
    for (int round = 0; round < kRounds; ++round) {
      if (is_linear || round % 2 == 0) {
        system = problem_.system_at(state, terms);
      }
      VectorXd sigma;
      const VectorXd step = step_of(system, left, &sigma);
      const double moved_mm = problem_.take(system, step, state);
      left = left_at(state);
      const double score = score_of(left, system.numbers.size());
      const bool is_better = score < best.score;
      if (is_better) {
        best.state = state;
        best.score = score;
        best.sigma = sigma;
        best.system = system;
      }
      if (round > 1 && (!is_better || moved_mm < kSettledMm)) {
        break;
      }
    }
    return best;
  }

  static bool has(const Fitted& fit, const GreyTerm& term) {
    return std::ranges::find(fit.terms, term) != fit.terms.end();
  }

  /// The most promising term of each kind that is not free yet.
  std::map<GreyFault, GreyTerm> promising(const Fitted& best) {
    std::map<GreyFault, GreyTerm> found;
    std::map<GreyFault, double> scores;
    const VectorXd left = left_at(best.state);
    for (const GreyTerm& term : problem_.terms()) {
      if (has(best, term)) {
        continue;
      }
      const double score =
          linear_score(joined(best.system, problem_.rough_system(best.state, term)), left);
      const auto known = scores.find(term.fault);
      if (score < best.score && (known == scores.end() || score < known->second)) {
        scores[term.fault] = score;
        found[term.fault] = term;
      }
    }
    return found;
  }

  /// Frees what helps most. @return false: nothing does
  bool improve(Fitted& best, double good_share) {
    Fitted better = best;
    for (const auto& [fault, term] : promising(best)) {
      // Roughness is the last one, looked at where the lights do not explain everything.
      if (fault == GreyFault::kRoughness && most_even_share(better.state) <= good_share) {
        continue;
      }
      std::vector<GreyTerm> terms = best.terms;
      terms.push_back(term);
      Fitted tried = fitted(best.state, terms);
      if (tried.score < better.score) {
        better = std::move(tried);
      }
    }
    const bool is_better = better.terms.size() > best.terms.size();
    best = std::move(better);
    return is_better;
  }

  /// The slopes without a term, and what is left with its numbers at zero.
  GreySystem without(const Fitted& best, const GreyTerm& term, VectorXd& left) {
    GreySystem rest;
    GreyState state = best.state;
    for (std::size_t i = 0; i < best.system.numbers.size(); ++i) {
      const GreyNumber& number = best.system.numbers[i];
      const auto column = best.system.columns.col(static_cast<Index>(i));
      if (number.term == term) {
        left += column * problem_.number(state, number);
      } else {
        rest.add(column, number);
      }
    }
    return rest;
  }

  /// Takes back a term that the others have made needless. @return false: none is
  bool simplify(Fitted& best) {
    if (best.terms.size() < 3) {
      return false;
    }
    for (const GreyTerm& term : best.terms) {
      if (term.fault == GreyFault::kExposure) {
        continue;
      }
      VectorXd left = left_at(best.state);
      const GreySystem rest = without(best, term, left);
      if (linear_score(rest, left) >= best.score) {
        continue;
      }
      GreyState state = best.state;
      problem_.reset(state, term);
      std::vector<GreyTerm> terms = best.terms;
      std::erase(terms, term);
      Fitted tried = fitted(state, terms);
      if (tried.score < best.score) {
        best = std::move(tried);
        return true;
      }
    }
    return false;
  }

  /// Of a single design powers of segments are told against their median, which cannot be told from
  /// the exposure.
  double common_power(const Fitted& best) const {
    std::vector<double> powers;
    for (std::size_t l = 0; l < model().lights().size(); ++l) {
      if (has(best, {.fault = GreyFault::kSegments, .of = l})) {
        for (int i = 0; i < model().lights()[l].segments; ++i) {
          powers.push_back(1.0 + best.state.segments[model().first_segment(l) + i]);
        }
      }
    }
    if (powers.empty() || model().designs().size() > 1) {
      return 1.0;
    }
    std::ranges::sort(powers);
    return std::max(0.05, powers[powers.size() / 2]);
  }

  GreyValue value_of(const Fitted& best, std::size_t column, double common) {
    const GreyNumber& number = best.system.numbers[column];
    GreyState state = best.state;
    const double value = problem_.number(state, number);
    GreyValue told = {.fault = number.term.fault,
                      .index = number.index,
                      .value = value,
                      .sigma = best.sigma[static_cast<Index>(column)]};
    switch (told.fault) {
      case GreyFault::kExposure:
        told.value = value * common;
        break;
      case GreyFault::kLightPower:
        told.light = model().designs()[number.term.of];
        told.value = 1.0 + value;
        break;
      case GreyFault::kSegments:
        told.light = model().lights()[number.term.of].name;
        told.value = (1.0 + value) / common;
        break;
      case GreyFault::kLightPlace:
        told.light = model().lights()[number.term.of].name;
        break;
      case GreyFault::kRoughness:
        told.value = std::exp(value);
        break;
    }
    return told;
  }

  void tell(const Fitted& best, std::size_t design, GreyFit& fit) {
    for (const GreyTerm& term : best.terms) {
      const bool is_of_other = term.fault == GreyFault::kLightPower && term.of != design;
      if (!is_of_other && std::ranges::find(fit.faults, term.fault) == fit.faults.end()) {
        fit.faults.push_back(term.fault);
      }
    }
    const double common = common_power(best);
    for (std::size_t i = 0; i < best.system.numbers.size(); ++i) {
      const GreyTerm& term = best.system.numbers[i].term;
      if (term.fault != GreyFault::kLightPower || term.of == design) {
        fit.values.push_back(value_of(best, i, common));
      }
    }
    put_change(best, fit);
    fit.change.exposure =
        best.state.exposure * common * (1.0 + best.state.powers[static_cast<Index>(design)]);
    fit.after = even_share(best.state, design);
    fit.renders = model().renders();
  }

  void put_change(const Fitted& best, GreyFit& fit) const {
    for (std::size_t l = 0; l < model().lights().size(); ++l) {
      fit.change.lights.push_back(
          {.name = model().lights()[l].name, .moved_mm = best.state.places[l]});
    }
    for (const GreyValue& value : fit.values) {
      if (value.fault == GreyFault::kSegments) {
        const auto light = std::ranges::find(fit.change.lights, value.light, &LightChange::name);
        light->segment_power.push_back(std::max(0.0, value.value));
      }
    }
    fit.change.roughness = std::exp(best.state.roughness);
  }

  GreyProblem problem_;
};

}  // namespace

std::string name_of(GreyFault fault) {
  constexpr std::array<const char*, kGreyFaults> kNames = {
      "exposure", "light_power", "segment_power", "light_place", "roughness"};
  return kNames[static_cast<std::size_t>(fault)];
}

std::vector<GreyFit> fit_grey(SceneStore& store,
                              std::span<const GreyDesign> designs,
                              const GreyOptions& options) {
  std::vector<GreyDesign> chosen;
  for (const GreyDesign& design : designs) {
    GreyDesign some = {.name = design.name, .views = {}};
    const std::size_t all = design.views.size();
    const std::size_t count = std::min(all, std::max<std::size_t>(1, options.max_views));
    for (std::size_t i = 0; i < count; ++i) {
      some.views.push_back(design.views[i * all / count]);
    }
    chosen.push_back(std::move(some));
  }
  return GreyFitter(store, chosen).fit(options);
}

}  // namespace glint
