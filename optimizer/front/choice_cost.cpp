// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/choice_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

using Rows = std::span<const std::vector<double>>;
using Ranges = std::span<const ObjectiveRange>;

double weight_of(const FrontChoice& choice, std::size_t objective) {
  return choice.weights.empty() ? 1.0 : choice.weights[objective];
}

double squared_distance(const std::vector<double>& parts) {
  double sum = 0.0;
  for (const double part : parts) {
    sum += std::max(part, 0.0) * std::max(part, 0.0);
  }
  return sum;
}

double weighted_sum(const std::vector<double>& parts, const FrontChoice& choice) {
  double sum = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    sum += weight_of(choice, i) * parts[i];
  }
  return sum;
}

/// The largest weighted shortfall, in parts of the ranges; below 0 where all is reached by more.
double shortfall(std::span<const double> row, Ranges ranges, const FrontChoice& choice) {
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < choice.aspirations.size(); ++i) {
    const double width = ranges[i].width;
    if (choice.aspirations[i]) {
      const double missing = row[i] - *choice.aspirations[i];
      largest = std::max(largest, weight_of(choice, i) * missing / (width > 0.0 ? width : 1.0));
    }
  }
  return std::isfinite(largest) ? largest : 0.0;
}

}  // namespace

std::vector<ObjectiveRange> objective_ranges(Rows rows) {
  std::vector<ObjectiveRange> ranges;
  for (std::size_t i = 0; i < rows.front().size(); ++i) {
    double low = rows.front()[i];
    double high = low;
    for (const std::vector<double>& row : rows) {
      low = std::min(low, row[i]);
      high = std::max(high, row[i]);
    }
    ranges.push_back({.best = low, .width = high - low});
  }
  return ranges;
}

std::vector<double> parts_of(std::span<const double> row, Ranges ranges) {
  std::vector<double> parts(row.size());
  for (std::size_t i = 0; i < row.size(); ++i) {
    parts[i] = ranges[i].width > 0.0 ? (row[i] - ranges[i].best) / ranges[i].width : 0.0;
  }
  return parts;
}

std::array<double, 2> choice_order(std::span<const double> row,
                                   Ranges ranges,
                                   const FrontChoice& choice) {
  const std::vector<double> parts = parts_of(row, ranges);
  switch (choice.rule) {
    case ChoiceRule::kWeights:
      return {weighted_sum(parts, choice), 0.0};
    case ChoiceRule::kAspirations:
      return {std::max(0.0, shortfall(row, ranges, choice)), squared_distance(parts)};
    case ChoiceRule::kKnee:
      break;
  }
  return {squared_distance(parts), 0.0};
}

std::size_t compromise_of(Rows front, Ranges ranges, const FrontChoice& choice) {
  std::size_t best = 0;
  std::array<double, 2> least = choice_order(front[0], ranges, choice);
  for (std::size_t row = 1; row < front.size(); ++row) {
    const std::array<double, 2> cost = choice_order(front[row], ranges, choice);
    if (cost < least) {
      best = row;
      least = cost;
    }
  }
  return best;
}

double choice_cost(std::span<const double> row, Ranges ranges, const FrontChoice& choice) {
  if (choice.rule == ChoiceRule::kAspirations) {
    return shortfall(row, ranges, choice);
  }
  const double cost = choice_order(row, ranges, choice)[0];
  return choice.rule == ChoiceRule::kKnee ? std::sqrt(cost) : cost;
}

}  // namespace glint
