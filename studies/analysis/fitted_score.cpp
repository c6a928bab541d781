// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/fitted_score.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

namespace glint {
namespace {

/// More make a fit slow and tell little more.
constexpr std::size_t kMaxPoints = 400;

struct Data {
  std::vector<Point> points;
  std::vector<double> values;
  std::vector<double> errors;  ///< NaN where not known
  std::size_t num_trials = 0;  ///< that tell the score
};

double finite_score(const Scores& scores, const std::string& name) {
  const auto found = scores.find(name);
  return found != scores.end() && std::isfinite(found->second)
             ? found->second
             : std::numeric_limits<double>::quiet_NaN();
}

/// Of a design that was evaluated again: the mean, and its standard error. @param count  with it
void add_again(Data& data, std::size_t at, double count, double value, double error) {
  data.values[at] += (value - data.values[at]) / count;
  data.errors[at] = std::hypot((count - 1.0) * data.errors[at], error) / count;
}

/// A design counts once, or it would be predicted without itself by what it is told again.
Data data_of(const SearchSpace& space, std::span<const Trial> trials, const std::string& score) {
  Data data;
  std::map<Point, std::size_t> place_of;
  std::vector<double> counts;
  for (const Trial& trial : trials) {
    if (!trial.outcome || trial.outcome->is_failed) {
      continue;
    }
    const double value = finite_score(trial.outcome->scores, score);
    if (std::isnan(value)) {
      continue;
    }
    ++data.num_trials;
    const double error = finite_score(trial.outcome->scores, score + ".error");
    const Point point = canonical(space, trial.point);
    const auto [place, is_new] = place_of.try_emplace(point, data.points.size());
    if (!is_new) {
      add_again(data, place->second, ++counts[place->second], value, error);
      continue;
    }
    data.points.push_back(point);
    data.values.push_back(value);
    data.errors.push_back(error);
    counts.push_back(1.0);
  }
  return data;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sum;
}

/// Those that lie farthest from one another, beginning with the first.
Data spread_out(const SearchSpace& space, const Data& data) {
  if (data.points.size() <= kMaxPoints) {
    return data;
  }
  std::vector<std::vector<double>> units;
  for (const Point& point : data.points) {
    units.push_back(unit_from_point(space, point));
  }
  std::vector<double> gaps(units.size(), std::numeric_limits<double>::infinity());
  Data kept;
  std::size_t next = 0;
  while (kept.points.size() < kMaxPoints) {
    kept.points.push_back(data.points[next]);
    kept.values.push_back(data.values[next]);
    kept.errors.push_back(data.errors[next]);
    for (std::size_t k = 0; k < units.size(); ++k) {
      gaps[k] = std::min(gaps[k], distance(units[k], units[next]));
    }
    gaps[next] = -1.0;  // not again
    next = static_cast<std::size_t>(std::ranges::max_element(gaps) - gaps.begin());
  }
  return kept;
}

}  // namespace

FittedScore fit_score(const SearchSpace& space,
                      std::span<const Trial> trials,
                      const std::string& score) {
  const Data all = data_of(space, trials, score);
  Data data = spread_out(space, all);
  const std::size_t left_out = all.points.size() - data.points.size();
  FittedScore fitted = {.score = score,
                        .points = std::move(data.points),
                        .values = std::move(data.values),
                        .model = GaussianProcess(space),
                        .left_out = static_cast<int>(left_out),
                        .without = static_cast<int>(trials.size() - all.num_trials)};
  if (!fitted.points.empty()) {
    fitted.model.fit(fitted.points, fitted.values, data.errors);
  }
  return fitted;
}

}  // namespace glint
