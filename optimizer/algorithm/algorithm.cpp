// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/algorithm.h"

#include <algorithm>
#include <array>
#include <deque>
#include <set>
#include <utility>

#include "core/config/keys.h"
#include "core/error.h"
#include "core/rng.h"
#include "core/text.h"
#include "optimizer/algorithm/gaussian_search.h"
#include "optimizer/algorithm/multi_start.h"
#include "optimizer/algorithm/nlopt_methods.h"
#include "optimizer/algorithm/pagmo_methods.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {

namespace {

constexpr std::array<std::string_view, 17> kNames = {"auto",
                                                     "sobol",
                                                     "random",
                                                     "direct_l",
                                                     "crs2",
                                                     "isres",
                                                     "mlsl",
                                                     "bobyqa",
                                                     "sbplx",
                                                     "cobyla",
                                                     "slsqp",
                                                     "mma",
                                                     "lbfgs",
                                                     "gp",
                                                     "cmaes",
                                                     "nsga2",
                                                     "nspso"};

constexpr int kPointsPerCombination = 4;
constexpr double kMaxMixedDesign = 64.0;
/// Each of its points tells as much as one point more for each variable.
constexpr int kDesignWithDerivatives = 3;

bool has_discrete(const SearchSpace& space) {
  return !std::ranges::all_of(space.variables, is_continuous);
}

/// Samples the whole space; never the same point twice.
class Sampling final : public Algorithm {
 public:
  Sampling(const SearchSpace& space,
           const SearchSettings& settings,
           std::vector<Point> start_points)
      : space_(space),
        is_random_(settings.algorithm == "random"),
        seed_(settings.seed),
        sobol_(settings.seed, static_cast<int>(space.variables.size())),
        start_points_(start_points.begin(), start_points.end()) {}

  std::optional<Point> ask() override {
    for (int repeats = 0; repeats < kMaxRepeats; ++repeats) {
      Point point = next_point();
      if (asked_.insert(point).second) {
        return point;
      }
    }
    return std::nullopt;
  }

  void tell(const Point& /*point*/, const Answer& /*answer*/) override {}

 private:
  Point next_point() {
    if (!start_points_.empty()) {
      Point point = std::move(start_points_.front());
      start_points_.pop_front();
      return point;
    }
    if (!is_random_) {
      return point_from_unit(space_, sobol_.point(next_index_++));
    }
    Rng rng(seed_, Stream::kSearch, next_index_++);
    std::vector<double> unit(space_.variables.size());
    for (double& value : unit) {
      value = rng.uniform();
    }
    return point_from_unit(space_, unit);
  }

  SearchSpace space_;
  bool is_random_;
  std::uint64_t seed_;
  Sobol sobol_;
  std::deque<Point> start_points_;
  std::set<Point> asked_;
  std::uint32_t next_index_ = 0;
};

void check_settings(const SearchSettings& settings) {
  std::vector<Problem> errors;
  const std::vector<std::string> names(kNames.begin(), kNames.end());
  if (std::ranges::find(names, settings.algorithm) == names.end()) {
    errors.push_back({.kind = Problem::Kind::kOutOfRange,
                      .key = "search.algorithm",
                      .text = "unknown algorithm \"" + settings.algorithm + "\", did you mean \"" +
                              nearest(settings.algorithm, names) +
                              "\"? Allowed: " + join(names, ", ")});
  }
  if (settings.batch < 1) {
    errors.push_back(
        {.kind = Problem::Kind::kOutOfRange, .key = "search.batch", .text = "must be at least 1"});
  }
  if (settings.design < 0) {
    errors.push_back({.kind = Problem::Kind::kOutOfRange,
                      .key = "search.design",
                      .text = "must not be negative"});
  }
  if (!(settings.tolerance > 0.0 && settings.tolerance < 1.0)) {
    errors.push_back({.kind = Problem::Kind::kOutOfRange,
                      .key = "search.tolerance",
                      .text = "must be above 0 and below 1"});
  }
  if (!(settings.watchdog_s > 0.0)) {
    errors.push_back({.kind = Problem::Kind::kOutOfRange,
                      .key = "search.watchdog_s",
                      .text = "must be above 0"});
  }
  throw_if_any(errors);
  GLINT_CHECK(settings.rules >= 1 && settings.rules <= kSearchRules, "rules that there are");
}

/// Rounding has no derivative.
void check_smooth(const SearchSpace& space, const std::string& algorithm) {
  std::vector<Problem> errors;
  for (const Variable& variable : space.variables) {
    if (is_continuous(variable) && variable.step > 0.0 && num_values(variable) > 1.0) {
      errors.push_back(
          {.kind = Problem::Kind::kRelation,
           .key = "variable \"" + variable.name + "\"",
           .text = "has a step of " + shortest(variable.step) + ", but search.algorithm " +
                   algorithm +
                   " needs derivatives; allowed: no step, or an algorithm without them"});
    }
  }
  throw_if_any(errors);
}

void check_derivatives(const std::string& algorithm, int num_objectives) {
  if (algorithm != "gp") {
    throw ConfigError(
        "search.derivatives: is available only with auto or gp, not with " + algorithm +
        (is_gradient_method(algorithm) ? ", which takes derivatives in any case" : "") +
        "; allowed: false");
  }
  if (num_objectives > 1) {
    throw ConfigError("search.derivatives: works with a single objective only, there are " +
                      std::to_string(num_objectives) + "; allowed: false");
  }
}

void check_objectives(const std::string& algorithm, int num_objectives) {
  GLINT_CHECK(num_objectives >= 1, "a search has an objective");
  if (num_objectives > 1 && !takes_several_objectives(algorithm)) {
    throw ConfigError(
        "search.algorithm: " + algorithm + " works with a single objective only, there are " +
        std::to_string(num_objectives) + "; allowed: gp, nsga2, nspso, sobol, random");
  }
  if (num_objectives == 1 && needs_several_objectives(algorithm)) {
    throw ConfigError("search.algorithm: " + algorithm +
                      " needs several objectives, there is one; allowed: auto, gp, cmaes and "
                      "others (docs/theory/search.md)");
  }
}

GaussianSearchPlan gaussian_plan(const SearchSpace& space,
                                 const SearchSettings& settings,
                                 int num_limits,
                                 int num_objectives,
                                 std::vector<double> reference,
                                 ExactValues exact) {
  if (settings.rules > 3) {
    exact.take_logs_of_limits();
  }
  return {.seed = settings.seed,
          .is_noisy = settings.is_noisy,
          .num_design = design_size(space, settings),
          .num_limits = num_limits,
          .num_objectives = num_objectives,
          .reference = std::move(reference),
          .exact = settings.rules > 2 ? std::move(exact) : ExactValues(),
          .takes_derivatives = settings.derivatives,
          .rules = settings.rules};
}

MultiStartPlan multi_start_plan(const std::string& method,
                                const SearchSpace& space,
                                const SearchSettings& settings,
                                int num_limits,
                                int num_objectives) {
  const bool needs_design = settings.design > 0 || has_discrete(space) ||
                            (settings.algorithm == "auto" && is_local_method(method));
  return {.method = method,
          .seed = settings.seed,
          .batch = settings.batch,
          .num_design = needs_design ? design_size(space, settings) : 0,
          .num_limits = is_gradient_method(method) ? num_limits : 0,
          .num_objectives = num_objectives,
          .tolerance = settings.tolerance,
          .patience_s = settings.watchdog_s};
}

}  // namespace

std::vector<Event> Algorithm::take_events() {
  return std::exchange(events_, {});
}

void Algorithm::add_event(EventKind kind, int run, std::string text) {
  events_.push_back({.kind = kind, .value = static_cast<double>(run), .text = std::move(text)});
}

void Algorithm::add_model_event(std::vector<double> parameters) {
  std::string text = std::to_string(parameters.size()) + " parameters of models";
  events_.push_back(
      {.kind = EventKind::kModel, .text = std::move(text), .objectives = std::move(parameters)});
}

std::span<const std::string_view> algorithm_names() {
  return kNames;
}

bool needs_gradient(std::string_view algorithm) {
  return is_gradient_method(algorithm);
}

bool takes_several_objectives(std::string_view algorithm) {
  return !is_nlopt_method(algorithm) && algorithm != "cmaes";
}

bool needs_several_objectives(std::string_view algorithm) {
  return is_population_of_several(algorithm);
}

int design_size(const SearchSpace& space, const SearchSettings& settings) {
  int size = settings.design;
  if (size == 0) {
    double combinations = 1.0;
    for (const Variable& variable : space.variables) {
      combinations *= is_continuous(variable) ? 1.0 : num_values(variable);
    }
    size = settings.derivatives ? kDesignWithDerivatives
                                : std::max(8, 2 * static_cast<int>(space.variables.size()) + 2);
    if (has_discrete(space)) {
      const double mixed = std::min(kMaxMixedDesign, kPointsPerCombination * combinations);
      size = std::max(size, static_cast<int>(mixed));
    }
  }
  return (size + settings.batch - 1) / settings.batch * settings.batch;
}

std::string resolved_algorithm(const SearchSpace& space,
                               const SearchSettings& settings,
                               int num_objectives) {
  if (settings.algorithm != "auto") {
    return settings.algorithm;
  }
  if (num_objectives > 1) {
    return "gp";
  }
  if (settings.is_noisy && settings.rules > 1) {
    return "gp";
  }
  if (settings.derivatives) {
    return "gp";
  }
  if (space.variables.size() <= 2 && !has_discrete(space)) {
    return "direct_l";
  }
  return settings.is_noisy ? "cobyla" : "bobyqa";
}

FailurePolicy failure_policy(const SearchSpace& space,
                             const SearchSettings& settings,
                             int num_objectives) {
  const std::string name = resolved_algorithm(space, settings, num_objectives);
  const bool fits_model = name == "bobyqa" || name == "cobyla" || name == "mlsl";
  return fits_model ? FailurePolicy::kNearest : FailurePolicy::kWorst;
}

std::unique_ptr<Algorithm> make_algorithm(const SearchSpace& space,
                                          const SearchSettings& settings,
                                          std::vector<Point> start_points,
                                          int num_limits,
                                          int num_objectives,
                                          std::vector<double> reference,
                                          ExactValues exact) {
  check(space);
  check_settings(settings);
  check_objectives(resolved_algorithm(space, settings, num_objectives), num_objectives);
  if (space.variables.empty()) {
    throw ConfigError("variables: a search needs at least one variable");
  }
  for (Point& point : start_points) {
    point = canonical(space, point);
  }
  const std::string name = resolved_algorithm(space, settings, num_objectives);
  if (settings.derivatives) {
    check_derivatives(name, num_objectives);
  }
  if (name == "gp") {
    const GaussianSearchPlan plan = gaussian_plan(
        space, settings, num_limits, num_objectives, std::move(reference), std::move(exact));
    return std::make_unique<GaussianSearch>(space, plan, std::move(start_points));
  }
  if (!is_nlopt_method(name) && !is_pagmo_method(name)) {
    return std::make_unique<Sampling>(space, settings, std::move(start_points));
  }
  if (needs_gradient(name)) {
    check_smooth(space, name);
  }
  return std::make_unique<MultiStart>(
      space,
      multi_start_plan(name, space, settings, num_limits, num_objectives),
      std::move(start_points),
      is_pagmo_method(name) ? pagmo_body : nlopt_body);
}

}  // namespace glint
