// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/robust/robust_proposals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "core/rng.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/algorithm/proposal.h"
#include "optimizer/algorithm/sobol.h"
#include "optimizer/robust/built_merit.h"
#include "optimizer/surrogate/gaussian_process.h"

namespace glint {
namespace {

/// More make a fit slow; the best half of them is kept, others evenly in the order of asking.
constexpr std::size_t kMaxPoints = 400;
constexpr std::uint32_t kEvenPoints = 256;
/// Many designs are looked at with the first offsets only.
constexpr std::size_t kFewOffsets = 16;
constexpr std::size_t kRefined = 6;
constexpr std::array<double, 3> kWidths = {0.1, 0.03, 0.01};  // parts of a variable's range
constexpr int kSteps = 16;
/// Parts of a range, in the variable that differs most.
constexpr double kApart = 0.05;
constexpr double kApartFromWinner = 0.01;
/// Half of the proposals trust the models, half keep limits by so many standard deviations of them.
constexpr std::array<double, 2> kCautions = {0.0, 2.0};
/// Keeps the numbers drawn here apart from those of a search with the same seed.
constexpr std::uint64_t kProposalSeeds = 1ULL << 42;

/// What the search holds of a trial: expected scores where it has a model, else those seen.
/// @param trial  whose scores can be judged
double searched_merit(const RobustTask& task, const BuiltMerit& merit, const Trial& trial) {
  if (!is_likely_feasible(task.goal, trial, task.limits)) {
    return kNoMerit;
  }
  Scores scores = trial.outcome->scores;
  const std::vector<Objective> objectives = objectives_of(task.goal);
  if (const auto known = task.expected.find(trial.number); known != task.expected.end()) {
    for (std::size_t k = 0; k < objectives.size(); ++k) {
      scores[objectives[k].name] = known->second[k].mean;
    }
  }
  return merit.of_objectives(scores);
}

/// A limited score may be infinite, of which no model can be fitted.
bool can_be_modelled(const Goal& goal, const Trial& trial) {
  return trial.outcome && !trial.outcome->is_failed &&
         problem_with(goal, trial.outcome->scores).empty() &&
         std::ranges::all_of(named_scores(goal), [&](const std::string& name) {
           return std::isfinite(trial.outcome->scores.at(name));
         });
}

std::vector<const Trial*> trials_to_model(const RobustTask& task) {
  std::vector<const Trial*> done;
  for (const Trial& trial : task.trials) {
    if (can_be_modelled(task.goal, trial)) {
      done.push_back(&trial);
    }
  }
  if (done.size() <= kMaxPoints) {
    return done;
  }
  const BuiltMerit merit(task.goal, task.trials, task.front);
  std::ranges::stable_sort(
      done, {}, [&](const Trial* one) { return searched_merit(task, merit, *one); });
  std::vector<const Trial*> kept(done.begin(), done.begin() + kMaxPoints / 2);
  std::vector<const Trial*> others(done.begin() + kMaxPoints / 2, done.end());
  std::ranges::sort(others, {}, &Trial::number);
  for (std::size_t i = 0; i < kMaxPoints / 2; ++i) {
    kept.push_back(others[i * others.size() / (kMaxPoints / 2)]);
  }
  return kept;
}

/// What the models say of one built design: scores, and how far limits may be off.
struct Modelled {
  Scores scores;
  Scores low;
  Scores high;
};

/// The models of all scores that the goal names.
class BuiltModel {
 public:
  BuiltModel(const RobustTask& task, const std::vector<const Trial*>& trials)
      : task_(task), merit_(task.goal, task.trials, task.front) {
    std::vector<Point> points;
    for (const Trial* trial : trials) {
      points.push_back(canonical(task.space, trial->point));
    }
    for (const std::string& name : named_scores(task.goal)) {
      std::vector<double> values;
      std::vector<double> errors;
      for (const Trial* trial : trials) {
        const Scores& scores = trial->outcome->scores;
        const auto error = scores.find(name + ".error");
        values.push_back(scores.at(name));
        errors.push_back(error != scores.end() ? error->second : std::nan(""));
      }
      auto [model, is_new] =
          models_.try_emplace(name, task.space, GaussianProcessSettings{.is_noisy = task.is_noisy});
      model->second.fit(points, values, errors);
    }
  }

  /// @param count    offsets that are looked at, from the first one on
  /// @param caution  standard deviations of the models by which limits are to be kept
  Standing standing(const Point& point, std::size_t count, double caution) const {
    std::vector<double> merits;
    for (const Modelled& one : modelled(point, count, caution)) {
      const bool is_kept = is_feasible(task_.goal, one.low) && is_feasible(task_.goal, one.high);
      merits.push_back(is_kept ? merit_.of(one.scores) : std::numeric_limits<double>::infinity());
    }
    return standing_of(std::move(merits));
  }

 private:
  std::vector<Modelled> modelled(const Point& point, std::size_t count, double caution) const {
    std::vector<Point> built;
    for (std::size_t k = 0; k < std::min(count, task_.offsets.size()); ++k) {
      built.push_back(moved(point, task_.offsets[k]));
    }
    std::vector<Modelled> result(built.size());
    for (const auto& [name, model] : models_) {
      const std::vector<Posterior> posteriors = model.predict(built);
      for (std::size_t k = 0; k < built.size(); ++k) {
        const double off = caution * std::sqrt(posteriors[k].variance);
        result[k].scores[name] = posteriors[k].mean;
        result[k].low[name] = posteriors[k].mean - off;
        result[k].high[name] = posteriors[k].mean + off;
      }
    }
    return result;
  }

  /// Beyond a variable's limits the models know nothing.
  Point moved(const Point& point, const Point& offset) const {
    Point built = point;
    for (std::size_t i = 0; i < built.size(); ++i) {
      if (offset[i] != 0.0) {
        const Variable& variable = task_.space.variables[i];
        built[i] = std::clamp(built[i] + offset[i], variable.low, variable.high);
      }
    }
    return built;
  }

  const RobustTask& task_;
  BuiltMerit merit_;
  std::map<std::string, GaussianProcess> models_;
};

struct Candidate {
  Point point;
  Standing standing;
};

void sort_by_standing(std::vector<Candidate>& candidates) {
  std::ranges::stable_sort(candidates, {}, &Candidate::standing);
}

/// The largest difference in one variable, in parts of its range; a choice counts 1.
double distance(const SearchSpace& space, const Point& a, const Point& b) {
  const std::vector<double> unit_a = unit_from_point(space, a);
  const std::vector<double> unit_b = unit_from_point(space, b);
  double largest = 0.0;
  for (std::size_t i = 0; i < unit_a.size(); ++i) {
    const bool is_choice = space.variables[i].kind == Variable::Kind::kChoice;
    const double apart = std::abs(unit_a[i] - unit_b[i]);
    largest = std::max(largest, is_choice && apart > 0.0 ? 1.0 : apart);
  }
  return largest;
}

bool is_apart(const SearchSpace& space, const Point& point, const std::vector<Candidate>& taken) {
  return std::ranges::all_of(
      taken, [&](const Candidate& other) { return distance(space, point, other.point) >= kApart; });
}

/// All designs that are worth a look, by the first offsets.
std::vector<Candidate> first_candidates(const RobustTask& task,
                                        const BuiltModel& model,
                                        const std::vector<const Trial*>& trials,
                                        double caution) {
  std::set<Point> points;
  for (const Trial* trial : trials) {
    points.insert(canonical(task.space, trial->point));
  }
  const Sobol even(task.seed + kProposalSeeds, static_cast<int>(task.space.variables.size()));
  for (std::uint32_t k = 0; k < kEvenPoints; ++k) {
    points.insert(point_from_unit(task.space, even.point(k)));
  }
  std::vector<Candidate> candidates;
  for (const Point& point : points) {
    candidates.push_back({.point = point, .standing = model.standing(point, kFewOffsets, caution)});
  }
  sort_by_standing(candidates);
  return candidates;
}

/// Steps that are kept where the models like them, shorter and shorter.
Candidate refined(
    const RobustTask& task, const BuiltModel& model, const Point& point, double caution, Rng& rng) {
  const std::size_t all = task.offsets.size();
  Candidate best{.point = point, .standing = model.standing(point, all, caution)};
  for (const double width : kWidths) {
    for (int step = 0; step < kSteps; ++step) {
      Point next = neighbour(task.space, best.point, width, step % 2 == 1, rng);
      const Standing standing = model.standing(next, all, caution);
      if (standing < best.standing) {
        best = {.point = std::move(next), .standing = standing};
      }
    }
  }
  return best;
}

/// What is found about the best of all candidates, the best first.
std::vector<Candidate> best_ones(const RobustTask& task,
                                 const BuiltModel& model,
                                 const std::vector<const Trial*>& trials,
                                 double caution,
                                 Rng& rng) {
  std::vector<Candidate> starts;
  for (const Candidate& candidate : first_candidates(task, model, trials, caution)) {
    if (starts.size() < kRefined && is_apart(task.space, candidate.point, starts)) {
      starts.push_back(candidate);
    }
  }
  std::vector<Candidate> found;
  for (const Candidate& start : starts) {
    found.push_back(refined(task, model, start.point, caution, rng));
  }
  sort_by_standing(found);
  return found;
}

}  // namespace

std::vector<Proposal> propose_robust(const RobustTask& task, const Point& winner, int count) {
  constexpr std::size_t kMinTrials = 3;
  const std::vector<const Trial*> trials = trials_to_model(task);
  if (trials.size() < kMinTrials) {
    return {};
  }
  const BuiltModel model(task, trials);
  Rng rng(task.seed, Stream::kSearch, kProposalSeeds);
  std::vector<Candidate> taken;
  for (const double caution : kCautions) {
    const auto share = static_cast<std::ptrdiff_t>(kCautions.size());
    const std::ptrdiff_t wanted =
        std::min<std::ptrdiff_t>(count, std::ssize(taken) + count / share);
    for (Candidate& candidate : best_ones(task, model, trials, caution, rng)) {
      if (std::ssize(taken) < wanted && is_apart(task.space, candidate.point, taken) &&
          distance(task.space, candidate.point, winner) >= kApartFromWinner) {
        taken.push_back(std::move(candidate));
      }
    }
  }
  std::vector<Proposal> proposals;
  for (Candidate& candidate : taken) {
    proposals.push_back(
        {.point = std::move(candidate.point), .modelled = candidate.standing.reached});
  }
  return proposals;
}

}  // namespace glint
