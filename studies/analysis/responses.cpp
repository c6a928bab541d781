// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/responses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "optimizer/algorithm/sobol.h"

namespace glint {
namespace {

constexpr std::size_t kPlaces = 21;     ///< along a variable
constexpr std::size_t kMapPlaces = 13;  ///< along each of two
constexpr int kOthers = 64;
constexpr int kMapOthers = 32;
constexpr std::uint64_t kSeed = 79;
constexpr double kNormalQuantile = 1.959964;

/// Places in the unit interval along free variable k: one for each value where there are few; else
/// even ones, ends included, of which a logarithmic integer gives its small values but once.
std::vector<double> places_along(const SearchSpace& space,
                                 const Branch& branch,
                                 std::size_t k,
                                 std::size_t most) {
  if (branch.num_values_of(space, k) <= static_cast<double>(most)) {
    return branch.units_of_values(space, k);
  }
  std::vector<double> places;
  std::vector<double> unit(branch.free.size(), 0.5);
  double last = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t place = 0; place < most; ++place) {
    unit[k] = static_cast<double>(place) / static_cast<double>(most - 1);
    const double value = branch.point_at(space, unit)[branch.free[k]];
    if (value != last) {
      places.push_back(unit[k]);
    }
    last = value;
  }
  return places;
}

Band band(double mean, double variance) {
  const double half = kNormalQuantile * std::sqrt(std::max(0.0, variance));
  return {.mean = mean, .low = mean - half, .high = mean + half};
}

}  // namespace

ResponseModel::ResponseModel(const GaussianProcess& model,
                             const SearchSpace& space,
                             const Branch& branch,
                             std::optional<Point> best)
    : model_(model), space_(space), branch_(branch), best_(std::move(best)) {}

Band ResponseModel::average_at(const std::vector<double>& place, int count) const {
  const Sobol sequence(kSeed, static_cast<int>(place.size()));
  std::vector<Point> points;
  for (int k = 0; k < count; ++k) {
    std::vector<double> unit = sequence.point(static_cast<std::uint32_t>(k));
    for (std::size_t i = 0; i < unit.size(); ++i) {
      unit[i] = std::isnan(place[i]) ? unit[i] : place[i];
    }
    points.push_back(branch_.point_at(space_, unit));
  }
  const JointPosterior joint = model_.predict_jointly(points);
  return band(joint.mean.mean(), joint.covariance.mean());
}

Response ResponseModel::over(std::size_t k) const {
  Response response = {.variable = branch_.free[k], .at = {}, .average = {}, .at_best = {}};
  std::vector<double> place(branch_.free.size(), std::numeric_limits<double>::quiet_NaN());
  for (const double unit : places_along(space_, branch_, k, kPlaces)) {
    place[k] = unit;
    response.average.push_back(average_at(place, kOthers));
    std::vector<double> at_middle(branch_.free.size(), 0.5);
    at_middle[k] = unit;
    response.at.push_back(branch_.point_at(space_, at_middle)[response.variable]);
    if (best_) {
      std::vector<double> all = branch_.unit_of(space_, *best_);
      all[k] = unit;
      const Posterior at_best = model_.predict(branch_.point_at(space_, all));
      response.at_best.push_back(band(at_best.mean, at_best.variance));
    }
  }
  return response;
}

ResponseMap ResponseModel::over_pair(std::span<const Importance> importance) const {
  std::vector<std::size_t> order(importance.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    order[k] = k;
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return importance[a].index.total.value > importance[b].index.total.value;
  });
  const std::size_t x = order[0];
  const std::size_t y = order[1];
  ResponseMap map = {
      .x = branch_.free[x], .y = branch_.free[y], .at_x = {}, .at_y = {}, .values = {}};
  std::vector<double> middle(branch_.free.size(), 0.5);
  std::vector<double> place(branch_.free.size(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<double> along_x = places_along(space_, branch_, x, kMapPlaces);
  for (const double at_x : along_x) {
    middle[x] = at_x;
    map.at_x.push_back(branch_.point_at(space_, middle)[map.x]);
  }
  for (const double at_y : places_along(space_, branch_, y, kMapPlaces)) {
    middle[y] = at_y;
    map.at_y.push_back(branch_.point_at(space_, middle)[map.y]);
    for (const double at_x : along_x) {
      place[x] = at_x;
      place[y] = at_y;
      map.values.push_back(average_at(place, kMapOthers));
    }
  }
  return map;
}

}  // namespace glint
