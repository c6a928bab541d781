// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/gaussian_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/error.h"

namespace glint {

namespace {

constexpr int kMaxRepeats = 5000;
constexpr int kNumGlobal = 200;
constexpr int kNumLocal = 200;
constexpr int kNumRefined = 60;
/// Widths, as parts of a variable's range, of candidates around the best design and of rounds
/// around the most promising candidate.
constexpr std::array<double, 2> kLocalWidths = {0.15, 0.03};
constexpr std::array<double, 3> kRefinedWidths = {0.1, 0.03, 0.01};
constexpr std::size_t kMaxPoints = 800;
constexpr std::size_t kKeptPoints = 600;
/// Keeps the random numbers of questions apart from the other users of the study's seed.
constexpr std::uint64_t kAskSeeds = 1ULL << 35;

/// What the model of success is told; a design is held for good where it stays below 0, so three
/// quarters of the way from a failure to a success.
constexpr double kFailure = 1.5;
constexpr double kSuccess = -0.5;

GaussianProcessSettings model_settings(bool is_noisy) {
  return {.is_noisy = is_noisy, .max_steps = 20};
}

}  // namespace

GaussianSearch::GaussianSearch(const SearchSpace& space,
                               const GaussianSearchPlan& plan,
                               std::vector<Point> start_points)
    : space_(space),
      plan_(plan),
      sobol_(plan.seed, static_cast<int>(space.variables.size())),
      design_(start_points.begin(), start_points.end()) {}

std::optional<Point> GaussianSearch::ask() {
  std::optional<Point> point = next_point();
  ++num_asks_;
  if (point) {
    asked_.insert(*point);
    pending_.push_back(*point);
  }
  return point;
}

std::optional<Point> GaussianSearch::next_point() {
  if (!design_.empty()) {
    Point point = std::move(design_.front());
    design_.pop_front();
    return point;
  }
  if (num_asks_ < static_cast<std::uint64_t>(plan_.num_design) || num_succeeded_ < 2) {
    return fresh_sobol_point();
  }
  update_models();
  std::optional<Point> point = promising_point();
  return point ? point : fresh_sobol_point();
}

std::optional<Point> GaussianSearch::fresh_sobol_point() {
  for (int i = 0; i < kMaxRepeats; ++i) {
    Point point = point_from_unit(space_, sobol_.point(next_sobol_++));
    if (!asked_.contains(point)) {
      return point;
    }
  }
  return std::nullopt;
}

void GaussianSearch::tell(const Point& point, const Answer& answer) {
  GLINT_CHECK(!pending_.empty() && pending_.front() == point, "told in the order of asking");
  pending_.erase(pending_.begin());
  Told told{.point = point, .merit = answer.merit};
  if (!answer.is_failed) {
    told.values =
        answer.objectives.empty() ? std::vector<double>{answer.objective.value} : answer.objectives;
    told.errors = answer.errors;
    told.errors.resize(told.values.size(), std::nan(""));
    for (std::size_t i = 0; i < answer.limits.size(); ++i) {
      told.values.push_back(answer.limits[i].value);
      const bool is_known = i < answer.limit_errors.size();
      told.errors.push_back(is_known ? answer.limit_errors[i] : std::nan(""));
    }
    GLINT_CHECK(
        told.values.size() == static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits),
        "told as many objectives and limits as announced");
    ++num_succeeded_;
  }
  told_.push_back(std::move(told));
}

void GaussianSearch::update_models() {
  if (told_.size() >= next_refit_) {
    refit();
    return;
  }
  for (; num_in_models_ < told_.size(); ++num_in_models_) {
    add_to_models(told_[num_in_models_]);
  }
}

/// All; when there are too many, the best third, and others evenly in the order of telling.
std::vector<std::size_t> GaussianSearch::told_to_model() const {
  std::vector<std::size_t> indices(told_.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  if (indices.size() <= kMaxPoints) {
    return indices;
  }
  std::ranges::stable_sort(indices, [this](std::size_t a, std::size_t b) {
    const bool fails_a = told_[a].values.empty();
    const bool fails_b = told_[b].values.empty();
    return fails_a != fails_b ? fails_b : told_[a].merit < told_[b].merit;
  });
  std::vector<std::size_t> kept(indices.begin(), indices.begin() + kKeptPoints / 3);
  std::vector<std::size_t> others(indices.begin() + kKeptPoints / 3, indices.end());
  std::ranges::sort(others);
  const std::size_t room = kKeptPoints - kept.size();
  for (std::size_t i = 0; i < room; ++i) {
    kept.push_back(others[i * others.size() / room]);
  }
  std::ranges::sort(kept);
  return kept;
}

void GaussianSearch::refit() {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  const bool has_failures = num_succeeded_ < told_.size();
  while (models_.size() < num_values) {
    models_.emplace_back(space_, model_settings(plan_.is_noisy));
  }
  if (has_failures && models_.size() == num_values) {
    models_.emplace_back(space_, model_settings(true));
  }
  const std::vector<std::size_t> indices = told_to_model();
  std::vector<Point> all;
  std::vector<double> failures;
  model_points_.clear();
  for (const std::size_t index : indices) {
    const bool is_failed = told_[index].values.empty();
    all.push_back(told_[index].point);
    failures.push_back(is_failed ? kFailure : kSuccess);
    if (!is_failed) {
      model_points_.push_back(told_[index].point);
    }
  }
  for (std::size_t k = 0; k < num_values; ++k) {
    std::vector<double> values;
    std::vector<double> errors;
    for (const std::size_t index : indices) {
      if (!told_[index].values.empty()) {
        values.push_back(told_[index].values[k]);
        errors.push_back(told_[index].errors[k]);
      }
    }
    models_[k].fit(model_points_, values, errors);
  }
  if (models_.size() > num_values) {
    models_[num_values].fit(all, failures);
  }
  num_in_models_ = told_.size();
  const std::size_t step = std::min(told_.size() / 4, kMaxPoints - kKeptPoints);
  next_refit_ = told_.size() + std::max<std::size_t>(2, step);
}

void GaussianSearch::add_to_models(const Told& told) {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  const bool is_failed = told.values.empty();
  for (std::size_t k = 0; k < num_values && !is_failed; ++k) {
    models_[k].add(told.point, told.values[k], told.errors[k]);
  }
  if (models_.size() > num_values) {
    models_[num_values].add(told.point, is_failed ? kFailure : kSuccess);
  }
  if (!is_failed) {
    model_points_.push_back(told.point);
  }
}

std::vector<GaussianProcess> GaussianSearch::models_with_pending() const {
  std::vector<GaussianProcess> models = models_;
  for (GaussianProcess& model : models) {
    for (const Point& point : pending_) {
      model.add(point, model.predict(point).mean);
    }
  }
  return models;
}

/// Numbers are moved by a normal step, choices drawn anew. @param is_sparse  only some variables
Point GaussianSearch::neighbour(const Point& point, double width, bool is_sparse, Rng& rng) const {
  std::vector<double> unit = unit_from_point(space_, point);
  const double rate = std::max(0.3, 4.0 / static_cast<double>(unit.size()));
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const bool is_moved = !is_sparse || rng.uniform() < rate;
    const bool is_choice = space_.variables[i].kind == Variable::Kind::kChoice;
    const double step = width * rng.normal();
    const double anew = rng.uniform();
    if (is_choice) {
      unit[i] = is_moved && rng.uniform() < 0.3 ? anew : unit[i];
    } else if (is_moved) {
      const double cell = 1.0 / num_values(space_.variables[i]);
      unit[i] = std::clamp(unit[i] + step * std::max(1.0, cell / width), 0.0, 1.0);
    }
  }
  return point_from_unit(space_, unit);
}

std::vector<Point> GaussianSearch::first_candidates(const Point& best, Rng& rng) const {
  std::vector<Point> points;
  std::vector<double> unit(space_.variables.size());
  for (int i = 0; i < kNumGlobal; ++i) {
    for (double& value : unit) {
      value = rng.uniform();
    }
    points.push_back(point_from_unit(space_, unit));
  }
  for (int i = 0; i < kNumLocal; ++i) {
    points.push_back(neighbour(best, kLocalWidths[i % 2 == 0 ? 0 : 1], true, rng));
  }
  return points;
}

/// Empty: all candidates have been asked before.
std::optional<Point> GaussianSearch::promising_point() {
  Rng rng(plan_.seed, Stream::kSearch, kAskSeeds + num_asks_);
  std::vector<double> low(static_cast<std::size_t>(plan_.num_objectives),
                          std::numeric_limits<double>::infinity());
  std::vector<double> high(low.size(), -std::numeric_limits<double>::infinity());
  for (const Told& told : told_) {
    for (std::size_t k = 0; k < low.size() && !told.values.empty(); ++k) {
      low[k] = std::min(low[k], told.values[k]);
      high[k] = std::max(high[k], told.values[k]);
    }
  }
  const bool has_pending = !pending_.empty();
  const std::vector<GaussianProcess> extended =
      has_pending ? models_with_pending() : std::vector<GaussianProcess>{};
  const std::span<const GaussianProcess> models = has_pending ? extended : models_;
  const Acquisition acquisition(models, plan_.num_objectives, low, high, rng);
  std::vector<Point> known = model_points_;
  known.insert(known.end(), pending_.begin(), pending_.end());

  std::optional<Point> best;
  double best_score = -std::numeric_limits<double>::infinity();
  const auto consider = [&](std::vector<Point> points) {
    std::erase_if(points, [this](const Point& point) { return asked_.contains(point); });
    if (points.empty()) {
      return;
    }
    const Eigen::VectorXd scores = acquisition.scores(models.front().encoding().rows(points));
    Eigen::Index at = 0;
    const double score = scores.maxCoeff(&at);
    if (!best || score > best_score) {
      best = points[static_cast<std::size_t>(at)];
      best_score = score;
    }
  };
  const Point& center = known[static_cast<std::size_t>(acquisition.best_point())];
  consider(first_candidates(center, rng));
  for (const double width : kRefinedWidths) {
    std::vector<Point> points;
    for (int i = 0; i < kNumRefined && best; ++i) {
      points.push_back(neighbour(*best, width, false, rng));
    }
    consider(std::move(points));
  }
  return best;
}

}  // namespace glint
