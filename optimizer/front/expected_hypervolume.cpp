// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/expected_hypervolume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/error.h"
#include "optimizer/front/front.h"

namespace glint {

namespace {

using Row = std::vector<double>;

/// Below this the series of Mills' ratio is exact to some digits and cancels nothing.
constexpr double kFarTail = -6.0;

double density(double z) {
  return std::exp(-0.5 * z * z) * (0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2);
}

double probability(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// E[max(0, z - standard normal)].
double unit_excess(double z) {
  if (z < kFarTail) {
    const double w = 1.0 / (z * z);
    return density(z) * w * (1.0 - 3.0 * w * (1.0 - 5.0 * w * (1.0 - 7.0 * w)));
  }
  return z * probability(z) + density(z);
}

/// A factor of a box's expectation and its derivatives.
struct Factor {
  double value = 0.0;
  double by_mean = 0.0;
  double by_sigma = 0.0;
};

/// Rows that are better than the reference in everything.
std::vector<Row> rows_inside(std::span<const Row> front, const Row& reference) {
  std::vector<Row> inside;
  for (const Row& row : front) {
    GLINT_CHECK(row.size() == reference.size(), "one number per objective");
    bool is_inside = true;
    for (std::size_t k = 0; k < row.size(); ++k) {
      is_inside = is_inside && row[k] < reference[k];
    }
    if (is_inside) {
      inside.push_back(row);
    }
  }
  return inside;
}

/// Squared distance of two rows in shares of the range.
double squared_distance(const Row& a, const Row& b, const Row& range) {
  double squared = 0.0;
  for (std::size_t k = 0; k < range.size(); ++k) {
    const double part = (a[k] - b[k]) / range[k];
    squared += part * part;
  }
  return squared;
}

}  // namespace

ExpectedHypervolume::ExpectedHypervolume(std::span<const Row> front, Row reference)
    : reference_(std::move(reference)), borders_(reference_.size()), border_of_(reference_.size()) {
  GLINT_CHECK(!reference_.empty(), "at least one objective");
  const std::vector<Row> inside = rows_inside(front, reference_);
  for (const std::size_t index : front_of(inside)) {
    front_.push_back(inside[index]);
  }
  for (std::size_t k = 0; k < reference_.size(); ++k) {
    for (const Row& row : front_) {
      borders_[k].push_back(row[k]);
    }
    borders_[k].push_back(reference_[k]);
    std::ranges::sort(borders_[k]);
    borders_[k].erase(std::unique(borders_[k].begin(), borders_[k].end()), borders_[k].end());
    for (const Row& row : front_) {
      const auto at = std::ranges::lower_bound(borders_[k], row[k]);
      border_of_[k].push_back(static_cast<int>(at - borders_[k].begin()));
    }
  }
  std::vector<std::size_t> rows(front_.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::vector<int> box(2 * reference_.size());
  cut(rows, reference_.size(), box);
}

/// Slices along the last of the objectives: between two neighbouring values of the rows, those at
/// or below the lower one dominate. `box` holds what is cut already.
void ExpectedHypervolume::cut(std::span<const std::size_t> rows,
                              std::size_t num_objectives,
                              std::vector<int>& box) {
  const std::size_t k = num_objectives - 1;
  const int last = static_cast<int>(borders_[k].size()) - 1;
  if (k == 0) {
    box[0] = -1;
    box[1] = last;
    for (const std::size_t row : rows) {
      box[1] = std::min(box[1], border_of_[0][row]);
    }
    boxes_.insert(boxes_.end(), box.begin(), box.end());
    return;
  }
  std::vector<std::size_t> sorted(rows.begin(), rows.end());
  std::ranges::stable_sort(sorted, {}, [&](std::size_t row) { return border_of_[k][row]; });
  box[2 * k] = -1;
  for (std::size_t below = 0; below <= sorted.size(); ++below) {
    box[2 * k + 1] = below < sorted.size() ? border_of_[k][sorted[below]] : last;
    if (box[2 * k + 1] > box[2 * k]) {
      cut(std::span(sorted).first(below), k, box);
      box[2 * k] = below < sorted.size() ? box[2 * k + 1] : last;
    }
  }
}

/// E[max(0, border - objective)] of each border, one objective after the other.
void ExpectedHypervolume::fill_excesses(std::span<const double> means,
                                        std::span<const double> sigmas,
                                        std::vector<double>& excesses) const {
  for (std::size_t k = 0; k < reference_.size(); ++k) {
    for (const double border : borders_[k]) {
      excesses.push_back(sigmas[k] * unit_excess((border - means[k]) / sigmas[k]));
    }
  }
}

double ExpectedHypervolume::value(std::span<const double> means,
                                  std::span<const double> sigmas) const {
  std::vector<double> excesses;
  fill_excesses(means, sigmas, excesses);
  double sum = 0.0;
  for (std::size_t b = 0; b < boxes_.size(); b += 2 * reference_.size()) {
    double product = 1.0;
    std::size_t offset = 0;
    for (std::size_t k = 0; k < reference_.size(); ++k) {
      const int low = boxes_[b + 2 * k];
      const auto high = static_cast<std::size_t>(boxes_[b + 2 * k + 1]);
      product *= excesses[offset + high] -
                 (low < 0 ? 0.0 : excesses[offset + static_cast<std::size_t>(low)]);
      offset += borders_[k].size();
    }
    sum += product;
  }
  return std::max(0.0, sum);
}

ExpectedHypervolume::Gain ExpectedHypervolume::gain(std::span<const double> means,
                                                    std::span<const double> sigmas) const {
  const std::size_t m = reference_.size();
  std::vector<std::vector<Factor>> at(m);
  for (std::size_t k = 0; k < m; ++k) {
    at[k].push_back({});  // of no lower border
    for (const double border : borders_[k]) {
      const double z = (border - means[k]) / sigmas[k];
      at[k].push_back({sigmas[k] * unit_excess(z), -probability(z), density(z)});
    }
  }
  Gain gain{.by_mean = Row(m, 0.0), .by_sigma = Row(m, 0.0)};
  std::vector<Factor> factors(m);
  for (std::size_t b = 0; b < boxes_.size(); b += 2 * m) {
    double product = 1.0;
    for (std::size_t k = 0; k < m; ++k) {
      const Factor& low = at[k][static_cast<std::size_t>(boxes_[b + 2 * k] + 1)];
      const Factor& high = at[k][static_cast<std::size_t>(boxes_[b + 2 * k + 1] + 1)];
      factors[k] = {
          high.value - low.value, high.by_mean - low.by_mean, high.by_sigma - low.by_sigma};
      product *= factors[k].value;
    }
    gain.value += product;
    for (std::size_t k = 0; k < m; ++k) {
      double others = 1.0;
      for (std::size_t j = 0; j < m; ++j) {
        others *= j == k ? 1.0 : factors[j].value;
      }
      gain.by_mean[k] += others * factors[k].by_mean;
      gain.by_sigma[k] += others * factors[k].by_sigma;
    }
  }
  gain.value = std::max(0.0, gain.value);
  return gain;
}

std::vector<std::size_t> spread_rows(std::span<const Row> rows, std::size_t count) {
  std::vector<std::size_t> taken;
  if (rows.size() <= count) {
    taken.resize(rows.size());
    std::iota(taken.begin(), taken.end(), std::size_t{0});
    return taken;
  }
  const std::size_t m = rows.front().size();
  Row range(m, 0.0);
  for (std::size_t k = 0; k < m && taken.size() < count; ++k) {
    const auto value = [k](const Row& row) { return row[k]; };
    const auto best = std::ranges::min_element(rows, {}, value);
    range[k] = std::max(1e-300, std::ranges::max_element(rows, {}, value)->at(k) - best->at(k));
    const auto index = static_cast<std::size_t>(best - rows.begin());
    if (std::ranges::find(taken, index) == taken.end()) {
      taken.push_back(index);
    }
  }
  Row nearest(rows.size(), std::numeric_limits<double>::infinity());
  for (std::size_t seen = 0; taken.size() < count;) {
    for (; seen < taken.size(); ++seen) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        nearest[i] = std::min(nearest[i], squared_distance(rows[i], rows[taken[seen]], range));
      }
    }
    taken.push_back(static_cast<std::size_t>(std::ranges::max_element(nearest) - nearest.begin()));
  }
  std::ranges::sort(taken);
  taken.erase(std::unique(taken.begin(), taken.end()), taken.end());
  return taken;
}

}  // namespace glint
