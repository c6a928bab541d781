// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/judge.h"

#include <algorithm>
#include <ctime>
#include <map>
#include <memory>
#include <nlopt.hpp>

#include "core/error.h"
#include "optimizer/algorithm/algorithm.h"
#include "optimizer/front/front.h"
#include "tests/optimizer/quality/memory_growth.h"
#include "tests/optimizer/quality/optuna_peer.h"

namespace glint::quality {

namespace {

using Vector = std::vector<double>;

constexpr std::size_t kEarlyCheck = 50;
constexpr std::size_t kFirstCheck = 100;
constexpr std::size_t kSecondCheck = 300;
constexpr std::size_t kLongSearch = 10000;

double cpu_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Of the first objective, without noise, by central differences; at the edge of the box as well.
Vector gradient_of(const Task& task, const Vector& x) {
  constexpr double kStep = 1e-5;
  Vector gradient;
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vector above = x;
    Vector below = x;
    above[i] += kStep;
    below[i] -= kStep;
    gradient.push_back((task.truth(above)[0] - task.truth(below)[0]) / (2.0 * kStep));
  }
  return gradient;
}

/// Of all designs that were told, of one objective.
std::vector<Vector> expected_means(Algorithm& algorithm) {
  std::vector<Vector> means;
  for (const std::vector<Expectation>& row : algorithm.expected_objectives()) {
    means.push_back(row.empty() ? Vector{} : Vector{row[0].mean});
  }
  return means;
}

Result glint_search(const std::string& name,
                    Judge& judge,
                    const Task& task,
                    int instance,
                    bool is_noisy,
                    std::size_t evaluations,
                    bool has_derivatives = false) {
  const auto algorithm = make_algorithm(task.space,
                                        {.algorithm = name,
                                         .seed = static_cast<std::uint64_t>(instance),
                                         .is_noisy = is_noisy,
                                         .derivatives = has_derivatives},
                                        {},
                                        0,
                                        task.num_objectives,
                                        task.reference);
  const bool has_expected = is_noisy && task.num_objectives == 1;
  const double start = cpu_ms();
  Result result;
  while (judge.count() < evaluations) {
    const std::optional<Point> point = algorithm->ask();
    if (!point) {
      break;
    }
    const Vector seen = judge.evaluate(*point);
    algorithm->tell(*point,
                    {.merit = seen[0],
                     .objective = {seen[0], has_derivatives ? gradient_of(task, *point) : Vector{}},
                     .objectives = seen});
    const auto score_at = [&](std::size_t check, auto& score) {
      if (judge.count() == check) {
        score =
            judge.score(check, has_expected ? expected_means(*algorithm) : std::vector<Vector>());
      }
    };
    score_at(kEarlyCheck, result.after_50);
    score_at(kFirstCheck, result.after_100);
    score_at(kSecondCheck, result.after_300);
  }
  result.own_ms = (cpu_ms() - start) / static_cast<double>(judge.count());
  return result;
}

/// For its memory alone, in a process that has run no other search.
Result long_search(
    const std::string& name, Judge& judge, const Task& task, int instance, bool is_noisy) {
  const MemoryGrowth growth;
  glint_search(name, judge, task, instance, is_noisy, kLongSearch);
  return {.peak_mb = growth.mb()};
}

struct Budgeted {
  Judge* judge = nullptr;
  std::size_t evaluations = 0;
};

double evaluate_for_nlopt(unsigned n, const double* x, double* /*gradient*/, void* data) {
  const auto& own = *static_cast<Budgeted*>(data);
  if (own.judge->count() >= own.evaluations) {
    throw nlopt::forced_stop();
  }
  return own.judge->evaluate(Vector(x, x + n)).front();
}

/// As the reference study ran it: random starts, steps of 0.2, until the budget is spent.
void nlopt_search(const std::string& name,
                  Judge& judge,
                  const Task& task,
                  int instance,
                  std::size_t evaluations) {
  static const std::map<std::string, nlopt::algorithm> kMethods = {
      {"cobyla", nlopt::LN_COBYLA},
      {"bobyqa", nlopt::LN_BOBYQA},
      {"direct_l", nlopt::GN_DIRECT_L},
      {"direct_l_rand", nlopt::GN_DIRECT_L_RAND}};
  const nlopt::algorithm method = kMethods.at(name);
  nlopt::srand(static_cast<unsigned long>(instance) + 1);
  Rng rng(static_cast<std::uint64_t>(instance), Stream::kTest, 2000);
  Budgeted budgeted{&judge, evaluations};
  for (int starts = 0; judge.count() < evaluations && starts < 500; ++starts) {
    nlopt::opt optimizer(method, static_cast<unsigned>(task.space.variables.size()));
    optimizer.set_lower_bounds(0.0);
    optimizer.set_upper_bounds(1.0);
    optimizer.set_min_objective(&evaluate_for_nlopt, &budgeted);
    optimizer.set_xtol_abs(method == nlopt::LN_COBYLA || method == nlopt::LN_BOBYQA ? 1e-3 : 0.0);
    optimizer.set_initial_step(0.2);
    Vector x(task.space.variables.size());
    for (double& value : x) {
      value = rng.uniform();
    }
    double value = 0.0;
    try {
      optimizer.optimize(x, value);
    } catch (const nlopt::forced_stop&) {
      return;
    } catch (const nlopt::roundoff_limited&) {
      continue;
    }
  }
}

void optuna_search(const std::string& name,
                   Judge& judge,
                   const Task& task,
                   int instance,
                   std::size_t evaluations) {
  OptunaPeer peer(task.space, name, static_cast<std::uint64_t>(instance));
  while (judge.count() < evaluations) {
    peer.tell(judge.evaluate(peer.ask()).front());
  }
}

}  // namespace

Judge::Judge(const Task& task, double noise, int instance)
    : task_(task), noise_(noise), rng_(static_cast<std::uint64_t>(instance), Stream::kTest, 77) {}

Vector Judge::evaluate(const Vector& x) {
  truths_.push_back(task_.truth(x));
  Vector seen = truths_.back();
  for (std::size_t k = 0; k < seen.size(); ++k) {
    seen[k] += noise_ * task_.spread[k] * rng_.normal();
  }
  seen_.push_back(seen);
  return seen;
}

double Judge::score(std::size_t count, const std::vector<Vector>& expected) const {
  const std::vector<Vector>& by = expected.empty() ? seen_ : expected;
  GLINT_CHECK(by.size() >= count && truths_.size() >= count, "as many evaluations as asked for");
  const std::vector<Vector> judged(by.begin(), by.begin() + static_cast<std::ptrdiff_t>(count));
  if (task_.num_objectives == 1) {
    const auto best = std::ranges::min_element(judged);
    return 100.0 * truths_[static_cast<std::size_t>(best - judged.begin())][0] / task_.median;
  }
  std::vector<Vector> recommended;
  for (const std::size_t index : front_of(judged)) {
    recommended.push_back(truths_[index]);
  }
  return 100.0 * hypervolume(recommended, task_.reference) / task_.full_volume;
}

Result run_method(
    const std::string& method, const Task& task, double noise, int instance, int evaluations) {
  Judge judge(task, noise, instance);
  const auto limit = static_cast<std::size_t>(evaluations);
  const std::size_t colon = method.find(':');
  const std::string name = method.substr(colon + 1);
  if (method.substr(0, colon) == "glint") {
    return glint_search(name, judge, task, instance, noise > 0.0, limit);
  }
  if (method.substr(0, colon) == "derivatives") {
    return glint_search(name, judge, task, instance, noise > 0.0, limit, true);
  }
  if (method.substr(0, colon) == "growth") {
    return long_search(name, judge, task, instance, noise > 0.0);
  }
  if (method.substr(0, colon) == "optuna") {
    optuna_search(name, judge, task, instance, limit);
  } else {
    GLINT_CHECK(method.substr(0, colon) == "nlopt", "a method of Glint, NLopt or Optuna");
    nlopt_search(name, judge, task, instance, limit);
  }
  Result result{.after_50 = judge.score(std::min(judge.count(), kEarlyCheck), {}),
                .after_100 = judge.score(std::min(judge.count(), kFirstCheck), {})};
  result.after_300 =
      judge.count() >= kSecondCheck ? judge.score(kSecondCheck, {}) : result.after_100;
  return result;
}

}  // namespace glint::quality
