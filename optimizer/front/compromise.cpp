// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/compromise.h"

#include <algorithm>
#include <array>

namespace glint {
namespace {

using Rows = std::span<const std::vector<double>>;

double weight_of(const FrontChoice& choice, std::size_t objective) {
  return choice.weights.empty() ? 1.0 : choice.weights[objective];
}

struct ValueRange {
  double best = 0.0;
  double width = 0.0;
};

ValueRange range_of(Rows front, std::size_t objective) {
  double low = front.front()[objective];
  double high = low;
  for (const std::vector<double>& row : front) {
    low = std::min(low, row[objective]);
    high = std::max(high, row[objective]);
  }
  return {.best = low, .width = high - low};
}

double squared_distance(const std::vector<double>& parts) {
  double sum = 0.0;
  for (const double part : parts) {
    sum += part * part;
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

/// The largest weighted shortfall, in parts of the front's ranges; 0 where all is reached.
double shortfall(Rows front, std::size_t row, const FrontChoice& choice) {
  double largest = 0.0;
  for (std::size_t i = 0; i < choice.aspirations.size(); ++i) {
    const double width = range_of(front, i).width;
    if (choice.aspirations[i]) {
      const double missing = front[row][i] - *choice.aspirations[i];
      largest = std::max(largest, weight_of(choice, i) * missing / (width > 0.0 ? width : 1.0));
    }
  }
  return largest;
}

/// What a rule makes small, first by the first number.
std::array<double, 2> cost_of(Rows front,
                              std::size_t row,
                              const std::vector<double>& parts,
                              const FrontChoice& choice) {
  switch (choice.rule) {
    case ChoiceRule::kWeights:
      return {weighted_sum(parts, choice), 0.0};
    case ChoiceRule::kAspirations:
      return {shortfall(front, row, choice), squared_distance(parts)};
    case ChoiceRule::kKnee:
      break;
  }
  return {squared_distance(parts), 0.0};
}

}  // namespace

std::string_view choice_rule_name(ChoiceRule rule) {
  constexpr std::array<std::string_view, 3> kNames = {"knee", "weights", "aspirations"};
  return kNames[static_cast<std::size_t>(rule)];
}

std::vector<std::vector<double>> given_up(std::span<const std::vector<double>> front) {
  std::vector<std::vector<double>> parts(front.begin(), front.end());
  for (std::size_t i = 0; i < front.front().size(); ++i) {
    const ValueRange range = range_of(front, i);
    for (std::vector<double>& row : parts) {
      row[i] = range.width > 0.0 ? (row[i] - range.best) / range.width : 0.0;
    }
  }
  return parts;
}

std::size_t compromise_of(std::span<const std::vector<double>> front, const FrontChoice& choice) {
  const std::vector<std::vector<double>> parts = given_up(front);
  std::size_t best = 0;
  for (std::size_t row = 1; row < front.size(); ++row) {
    if (cost_of(front, row, parts[row], choice) < cost_of(front, best, parts[best], choice)) {
      best = row;
    }
  }
  return best;
}

}  // namespace glint
