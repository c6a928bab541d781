// SPDX-License-Identifier: GPL-3.0-or-later
//
// Causes are freed one after the other: all are looked at by derivatives from where the fit began,
// the most promising of each kind are fitted, and what a later one makes needless is taken back.
#include "studies/validate/grey_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/Core>

#include "studies/validate/camera_errors.h"
#include "studies/validate/grey_terms.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using validate_detail::add_camera_errors;
using validate_detail::GreyHalves;
using validate_detail::GreyModel;
using validate_detail::GreyNumber;
using validate_detail::GreyProblem;
using validate_detail::GreyState;
using validate_detail::GreySystem;
using validate_detail::GreyTerm;
using validate_detail::linear_score;
using validate_detail::rendered_score;
using validate_detail::score_of;
using validate_detail::step_of;

constexpr Index kMinPixels = 200;
constexpr double kMinCover = 0.5;  ///< of a part whose even differences tell of all of it
constexpr int kRounds = 6;
constexpr double kSettledMm = 0.1;
constexpr double kLongestPolishMm = 2.0;  ///< derivatives are not those of places farther away

struct Fitted {
  GreyState state;
  std::vector<GreyTerm> terms;
  double score = std::numeric_limits<double>::max();
  VectorXd sigma;
  GreySystem system;  ///< of the last derivatives
};

GreySystem joined(GreySystem first, const GreySystem& second) {
  for (std::size_t i = 0; i < second.numbers.size(); ++i) {
    first.add(second.column(i), second.numbers[i]);
  }
  return first;
}

class GreyFitter {
 public:
  GreyFitter(SceneStore& store, std::span<const GreyDesign> designs) : problem_(store, designs) {}

  std::vector<GreyFit> fit(const GreyOptions& options) {
    std::vector<GreyFit> fits(model().designs().size());
    if (model().lights().empty() || model().real().size() < kMinPixels) {
      return fits;
    }
    const GreyState start = problem_.start();
    const Fitted exposed = fitted(start, own_exposures());
    double most = 0.0;
    for (std::size_t d = 0; d < fits.size(); ++d) {
      fits[d].is_known = model().rows(d).count >= kMinPixels;
      fits[d].before = even_share(start, d);
      fits[d].exposed = even_share(exposed.state, d);
      most = std::max(most, fits[d].exposed);
    }
    const bool is_searching = most > options.agree_share;
    const Fitted best =
        is_searching ? polished(searched(options.good_share), options.camera_covariance) : exposed;
    std::vector<GreyValue> kept;
    if (is_searching) {
      kept = problem_.kept_values(best.state, best.system, left_at(best.state));
    }
    for (std::size_t d = 0; d < fits.size(); ++d) {
      tell(best, d, fits[d]);
      fits[d].kept = kept;
      tell_thin(model().even_cover(d), fits[d]);
      tell_power(fits[d]);
      if (!is_searching) {
        fits[d].faults = {GreyFault::kExposure};
        fits[d].values[0].sigma = sigma_of_exposure(fits[d]);
        fits[d].values.resize(1);
        fits[d].values[0].value = fits[d].change.exposure;
      }
    }
    return fits;
  }

 private:
  const GreyModel& model() const { return problem_.model(); }

  GreyHalves left_at(const GreyState& state, bool is_fine = false) {
    GreyHalves left = problem_.predicted(state, is_fine);
    for (VectorXd& half : left) {
      half = model().real() - half;
    }
    return left;
  }

  double even_share(const GreyState& state, std::size_t design) {
    return model().even_rms(validate_detail::mean_of(left_at(state)), design);
  }

  double max_even_share(const GreyState& state) {
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
    while (max_even_share(best.state) > good_share && improve(best, good_share)) {
      while (simplify(best)) {
      }
    }
    return best;
  }

  /// Gauss-Newton from a state with some numbers free. Derivatives by place and roughness cost
  /// renderings, and hold for two steps.
  Fitted fitted(GreyState state, const std::vector<GreyTerm>& terms) {
    const bool is_linear = !needs_rendering(terms);
    Fitted best = {.terms = terms};
    GreySystem system;
    GreyHalves left = left_at(state);
    for (int round = 0; round < kRounds; ++round) {
      if (is_linear || round % 2 == 0) {
        system = problem_.system_at(state, terms);
      }
      VectorXd sigma;
      const VectorXd step = step_of(system, left, &sigma);
      const double moved_mm = problem_.take(system, step, state);
      left = left_at(state);
      const double score = rendered_score(left, system.numbers.size());
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

  static bool needs_rendering(const std::vector<GreyTerm>& terms) {
    return std::ranges::any_of(terms, [](const GreyTerm& term) {
      return term.fault == GreyFault::kLightPlace || term.fault == GreyFault::kRoughness;
    });
  }

  /// One more step from fine pictures. Only these count for how exact it is: the noise of
  /// derivatives is multiplied by what is left, that of the picture is what is left.
  Fitted polished(Fitted fit, const Eigen::MatrixXd& covariance) {
    if (needs_rendering(fit.terms)) {
      const GreyHalves left = left_at(fit.state, true);
      const VectorXd step = step_of(fit.system, left, &fit.sigma);
      add_camera_errors(problem_, fit.state, fit.system, left, covariance, fit.sigma);
      GreyState state = fit.state;
      if (problem_.take(fit.system, step, state) <= kLongestPolishMm) {
        fit.state = state;
      }
    }
    return fit;
  }

  static bool has(const Fitted& fit, const GreyTerm& term) {
    return std::ranges::find(fit.terms, term) != fit.terms.end();
  }

  /// The most promising term of each kind that is not free yet.
  std::map<GreyFault, GreyTerm> promising(const Fitted& best) {
    std::map<GreyFault, GreyTerm> found;
    std::map<GreyFault, double> scores;
    const GreyHalves left = left_at(best.state);
    const double score_so_far = score_of(left, best.system.numbers.size());
    for (const GreyTerm& term : problem_.terms()) {
      if (has(best, term)) {
        continue;
      }
      const double score =
          linear_score(joined(best.system, problem_.rough_system(best.state, term)), left);
      const auto known = scores.find(term.fault);
      if (score < score_so_far && (known == scores.end() || score < known->second)) {
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
      if (fault == GreyFault::kRoughness && max_even_share(better.state) <= good_share) {
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

  /// The derivatives without a term, and what is left with its numbers at zero.
  GreySystem without(const Fitted& best, const GreyTerm& term, GreyHalves& left) {
    GreySystem rest;
    GreyState state = best.state;
    for (std::size_t i = 0; i < best.system.numbers.size(); ++i) {
      const GreyNumber& number = best.system.numbers[i];
      const GreyHalves column = best.system.column(i);
      if (number.term == term) {
        for (std::size_t half = 0; half < 2; ++half) {
          left[half] += column[half] * problem_.number(state, number);
        }
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
      GreyHalves left = left_at(best.state);
      const double score_so_far = score_of(left, best.system.numbers.size());
      const GreySystem rest = without(best, term, left);
      if (linear_score(rest, left) >= score_so_far) {
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
    fit.rounding = model().rounding_share(design);
    fit.renders = model().renders();
  }

  void tell_power(GreyFit& fit) const {
    const auto power = std::ranges::find(fit.values, GreyFault::kLightPower, &GreyValue::fault);
    if (power != fit.values.end()) {
      fit.power = power->value;
      fit.power_sigma = power->sigma;
    }
    fit.is_joint = model().designs().size() > 1;
  }

  /// Without a block of pixels whose mean could be even nothing but the exposure is told.
  static void tell_thin(double cover, GreyFit& fit) {
    fit.is_thin = fit.is_known && cover < kMinCover;
    if (fit.is_thin && cover <= 0.0) {
      fit.is_exposure_only = true;
      fit.before = std::abs(1.0 - 1.0 / fit.change.exposure);
    }
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

double sigma_of_exposure(const GreyFit& fit) {
  const auto number = [&fit](GreyFault fault) {
    const auto found = std::ranges::find(fit.values, fault, &GreyValue::fault);
    return found == fit.values.end() ? GreyValue{.value = 1.0} : *found;
  };
  const GreyValue exposure = number(GreyFault::kExposure);
  const GreyValue power = number(GreyFault::kLightPower);
  return std::hypot(power.value * exposure.sigma, exposure.value * power.sigma);
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
