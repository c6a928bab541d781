// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/pagmo_methods.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <string>
#include <utility>
#include <vector>

namespace glint {

namespace {

using Vector = std::vector<double>;

/// Of nsga2 (a multiple of 4) and nspso.
constexpr unsigned kPopulation = 40;
/// More than any budget; the thread is stopped when nobody asks any more.
constexpr unsigned kGenerations = 1000000;
/// CMA-ES ends when its steps and its values differ by less.
constexpr double kTolerance = 1e-9;

/// Thrown out of pagmo when the body is to end.
struct Stopped {};

/// What the copies of a problem share.
struct Shared {
  const MethodRun* run = nullptr;
  const AskTellThread::Call* call = nullptr;
  std::optional<Vector> worst;  ///< by objective, of what was told
  std::size_t num_objectives = 1;
};

Vector told_values(const Answer& answer, Shared& shared) {
  if (shared.num_objectives == 1) {
    return {answer.merit};
  }
  double excess = answer.is_failed ? 1.0 : 0.0;
  for (const ValueWithGradient& limit : answer.limits) {
    excess += std::max(0.0, limit.value);
  }
  const Vector& worst = *shared.worst;
  Vector values = answer.is_failed ? worst : answer.objectives;
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = excess > 0.0 ? std::max(values[k], worst[k]) + excess : values[k];
  }
  return values;
}

/// Asks for the value of a point inside the box.
Vector evaluate(const Vector& x, Shared& shared) {
  Vector point(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double value = std::isfinite(x[i]) ? x[i] : shared.run->start[i];
    point[i] = std::clamp(value, shared.run->low[i], shared.run->high[i]);
  }
  const std::optional<Answer> answer = (*shared.call)(point);
  if (!answer) {
    throw Stopped();
  }
  if (shared.num_objectives > 1 && !answer->is_failed) {
    if (!shared.worst) {
      shared.worst = answer->objectives;
    }
    for (std::size_t k = 0; k < answer->objectives.size(); ++k) {
      (*shared.worst)[k] = std::max((*shared.worst)[k], answer->objectives[k]);
    }
  }
  if (!shared.worst) {
    shared.worst = Vector(shared.num_objectives, answer->merit);
  }
  return told_values(*answer, shared);
}

/// pagmo's user-defined problem.
struct SharedProblem {
  Shared* shared = nullptr;

  Vector fitness(const Vector& x) const { return evaluate(x, *shared); }

  std::pair<Vector, Vector> get_bounds() const { return {shared->run->low, shared->run->high}; }

  Vector::size_type get_nobj() const { return shared->num_objectives; }
};

pagmo::algorithm pagmo_algorithm(const MethodRun& run) {
  const auto seed = static_cast<unsigned>(run.seed);
  if (run.method == "cmaes") {
    constexpr double kOwn = -1.0;  // pagmo's own choice
    return pagmo::algorithm(pagmo::cmaes(kGenerations,
                                         kOwn,
                                         kOwn,
                                         kOwn,
                                         kOwn,
                                         std::max(0.05, run.initial_step),
                                         kTolerance,
                                         kTolerance,
                                         false,
                                         true,
                                         seed));
  }
  if (run.method == "nsga2") {
    return pagmo::algorithm(pagmo::nsga2(kGenerations, 0.95, 10.0, 0.01, 50.0, seed));
  }
  return pagmo::algorithm(
      pagmo::nspso(kGenerations, 0.6, 2.0, 2.0, 1.0, 0.5, 100, "crowding distance", false, seed));
}

unsigned population_of(const MethodRun& run) {
  const double n = static_cast<double>(run.start.size());
  return run.method == "cmaes" ? 4 + static_cast<unsigned>(3.0 * std::log(n + 1.0)) + 1
                               : kPopulation;
}

}  // namespace

bool is_pagmo_method(std::string_view method) {
  return method == "cmaes" || is_population_of_several(method);
}

bool is_population_of_several(std::string_view method) {
  return method == "nsga2" || method == "nspso";
}

AskTellThread::Body pagmo_body(const MethodRun& run) {
  return [run](const AskTellThread::Call& call) -> std::string {
    Shared shared{.run = &run,
                  .call = &call,
                  .worst = {},
                  .num_objectives = static_cast<std::size_t>(run.num_objectives)};
    try {
      pagmo::population population(
          pagmo::problem(SharedProblem{&shared}), 0U, static_cast<unsigned>(run.seed));
      population.push_back(run.start);
      while (population.size() < population_of(run)) {
        population.push_back(population.random_decision_vector());
      }
      pagmo_algorithm(run).evolve(population);
      return "converged";
    } catch (const Stopped&) {
      return "stopped";
    }
  };
}

}  // namespace glint
