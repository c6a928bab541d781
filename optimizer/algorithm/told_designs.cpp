// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/told_designs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "optimizer/algorithm/merit.h"
#include "optimizer/front/expected_hypervolume.h"
#include "optimizer/front/front.h"

namespace glint {

namespace {

constexpr int kMaxDerivatives = 300;

bool keeps_told_limits(const ToldDesign& told, std::size_t num_objectives) {
  return !told.values.empty() &&
         std::all_of(told.values.begin() + static_cast<std::ptrdiff_t>(num_objectives),
                     told.values.end(),
                     [](double limit) { return limit <= MeritFunction::kLimitMargin; });
}

/// So many designs of the front of those within the limits; none without objectives.
std::vector<std::size_t> told_front(std::span<const ToldDesign> designs,
                                    std::size_t num_objectives,
                                    std::size_t count) {
  std::vector<std::size_t> feasible;
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < designs.size() && num_objectives > 0; ++i) {
    if (keeps_told_limits(designs[i], num_objectives)) {
      const auto begin = designs[i].values.begin();
      feasible.push_back(i);
      rows.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(num_objectives));
    }
  }
  std::vector<std::size_t> front;
  std::vector<std::vector<double>> on_front;
  for (const std::size_t row : front_of(rows)) {
    front.push_back(feasible[row]);
    on_front.push_back(rows[row]);
  }
  std::vector<std::size_t> kept;
  for (const std::size_t row : spread_rows(on_front, count)) {
    kept.push_back(front[row]);
  }
  return kept;
}

std::vector<std::size_t> to_model(std::span<const ToldDesign> designs, std::size_t num_front) {
  std::vector<std::size_t> indices(designs.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  if (indices.size() <= kMaxModelPoints) {
    return indices;
  }
  std::ranges::stable_sort(indices, [&](std::size_t a, std::size_t b) {
    const bool fails_a = designs[a].values.empty();
    const bool fails_b = designs[b].values.empty();
    return fails_a != fails_b ? fails_b : designs[a].merit < designs[b].merit;
  });
  std::vector<std::size_t> kept = told_front(designs, num_front, kKeptModelPoints / 3);
  std::erase_if(indices, [&](std::size_t i) { return std::ranges::binary_search(kept, i); });
  const auto best =
      indices.begin() + static_cast<std::ptrdiff_t>(kKeptModelPoints / 3 - kept.size());
  kept.insert(kept.end(), indices.begin(), best);
  std::vector<std::size_t> others(best, indices.end());
  std::ranges::sort(others);
  const std::size_t room = kKeptModelPoints - kept.size();
  for (std::size_t i = 0; i < room; ++i) {
    kept.push_back(others[i * others.size() / room]);
  }
  std::ranges::sort(kept);
  return kept;
}

}  // namespace

ModelData model_data(std::span<const ToldDesign> designs,
                     std::size_t num_values,
                     std::size_t num_front) {
  ModelData data{.values = std::vector<std::vector<double>>(num_values),
                 .errors = std::vector<std::vector<double>>(num_values)};
  for (const std::size_t index : to_model(designs, num_front)) {
    const ToldDesign& told = designs[index];
    const bool is_failed = told.values.empty();
    data.all.push_back(told.point);
    data.failures.push_back(is_failed ? kFailure : kSuccess);
    if (is_failed) {
      continue;
    }
    data.points.push_back(told.point);
    data.told.push_back(index);
    for (std::size_t k = 0; k < num_values; ++k) {
      data.values[k].push_back(told.values[k]);
      data.errors[k].push_back(told.errors[k]);
    }
  }
  return data;
}

int num_known(const UnitDerivatives& derivatives) {
  return static_cast<int>(std::ranges::count_if(
      derivatives, [](double derivative) { return std::isfinite(derivative); }));
}

int derivatives_per_model(std::span<const ToldDesign> designs, std::size_t num_values) {
  int count = 0;
  for (std::size_t k = 0; k < num_values; ++k) {
    const auto has_any = [k](const ToldDesign& told) {
      return k < told.derivatives.size() && num_known(told.derivatives[k]) > 0;
    };
    count += std::ranges::any_of(designs, has_any) ? 1 : 0;
  }
  return count > 0 ? kMaxDerivatives / count : 0;
}

std::vector<UnitDerivatives> nearest_derivatives(const SearchSpace& space,
                                                 std::span<const ToldDesign> designs,
                                                 const ModelData& data,
                                                 std::size_t value,
                                                 int room) {
  if (designs.empty() || data.told.empty()) {
    return {};
  }
  const auto merit = [&](std::size_t told) { return designs[told].merit; };
  const std::size_t best = *std::ranges::min_element(data.told, {}, merit);
  const std::vector<double> center = unit_from_point(space, designs[best].point);
  std::vector<double> distances;
  for (const Point& point : data.points) {
    const std::vector<double> unit = unit_from_point(space, point);
    double squared = 0.0;
    for (std::size_t i = 0; i < unit.size(); ++i) {
      squared += (unit[i] - center[i]) * (unit[i] - center[i]);
    }
    distances.push_back(squared);
  }
  std::vector<std::size_t> order(data.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return distances[i]; });
  std::vector<UnitDerivatives> derivatives(data.points.size());
  for (const std::size_t i : order) {
    const UnitDerivatives& known = designs[data.told[i]].derivatives[value];
    room -= num_known(known);
    if (room < 0) {
      break;
    }
    derivatives[i] = known;
  }
  return derivatives;
}

UnitDerivatives unit_derivatives(const SearchSpace& space,
                                 const Point& point,
                                 const std::vector<double>& gradient) {
  UnitDerivatives derivatives = gradient;
  for (std::size_t i = 0; i < derivatives.size(); ++i) {
    derivatives[i] = derivative_at(space, point, i) == 0.0 ? std::nan("") : derivatives[i];
  }
  return derivatives;
}

std::vector<std::vector<Expectation>> expected_rows_of(std::span<const GaussianProcess> models,
                                                       std::span<const ToldDesign> designs) {
  std::vector<Point> points;
  for (const ToldDesign& told : designs) {
    if (!told.values.empty()) {
      points.push_back(told.point);
    }
  }
  std::vector<std::vector<Posterior>> predicted;
  for (const GaussianProcess& model : models) {
    predicted.push_back(model.predict(points));
  }
  std::vector<std::vector<Expectation>> rows;
  std::size_t next = 0;
  for (const ToldDesign& told : designs) {
    std::vector<Expectation> row;
    for (std::size_t k = 0; k < predicted.size() && !told.values.empty(); ++k) {
      const Posterior& posterior = predicted[k][next];
      row.push_back({.mean = posterior.mean, .sd = std::sqrt(posterior.variance)});
    }
    next += told.values.empty() ? 0U : 1U;
    rows.push_back(std::move(row));
  }
  return rows;
}

GaussianProcessSettings model_settings(int rules, bool is_noisy, bool takes_derivatives) {
  /// With more points parameters are sought from the last ones only.
  constexpr int kMaxFreshPoints = 100;
  return rules > 1 ? GaussianProcessSettings{.is_noisy = is_noisy,
                                             .max_steps = 15,
                                             .max_fresh_points = kMaxFreshPoints,
                                             .takes_derivatives = takes_derivatives}
                   : GaussianProcessSettings{.is_noisy = is_noisy, .max_steps = 20};
}

}  // namespace glint
