// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/analysis/evidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "core/text.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {
namespace {

constexpr std::uint64_t kProbeSeed = 77;
constexpr std::uint64_t kDesignSeed = 78;
constexpr int kProbes = 256;
constexpr double kSlack = 1.1;

double squared_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sum;
}

std::vector<std::vector<double>> even_points(int count, int dimension) {
  const Sobol sequence(kDesignSeed, dimension);
  std::vector<std::vector<double>> points;
  for (int k = 0; k < count; ++k) {
    points.push_back(sequence.point(static_cast<std::uint32_t>(k)));
  }
  return points;
}

int covering_count(int dimension) {
  return std::max(10, 5 * dimension);
}

double allowed_emptiness(int dimension) {
  return kSlack * emptiness(even_points(covering_count(dimension), dimension), dimension);
}

/// How many even points more it takes to cover the box.
int lacking_points(std::span<const std::vector<double>> points, int dimension) {
  const double allowed = allowed_emptiness(dimension);
  std::vector<std::vector<double>> all(points.begin(), points.end());
  const auto even = even_points(covering_count(dimension), dimension);
  for (int count = 0; count < covering_count(dimension); ++count) {
    if (emptiness(all, dimension) <= allowed) {
      return count;
    }
    all.push_back(even[static_cast<std::size_t>(count)]);
  }
  return covering_count(dimension);
}

}  // namespace

std::string Evidence::reason() const {
  std::vector<std::string> reasons;
  if (is_constant) {
    reasons.push_back(fmt::format("all {} designs have the same value", points));
  } else if (!(q2 >= kNeededQ2)) {
    reasons.push_back(fmt::format(
        "without itself a design is predicted with Q2 = {:.2f}, {} are needed", q2, kNeededQ2));
  }
  if (!is_covered) {
    reasons.push_back(fmt::format("{} designs leave parts of the box empty", points));
  }
  return join(reasons, "; ");
}

double emptiness(std::span<const std::vector<double>> points, int dimension) {
  const Sobol places(kProbeSeed, dimension);
  double sum = 0.0;
  for (int k = 0; k < kProbes; ++k) {
    const std::vector<double> place = places.point(static_cast<std::uint32_t>(k));
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& point : points) {
      nearest = std::min(nearest, squared_distance(place, point));
    }
    sum += std::sqrt(nearest) / kProbes;
  }
  return sum;
}

Evidence evidence_of(std::optional<double> q2,
                     std::span<const std::vector<double>> points,
                     int dimension) {
  Evidence evidence = {
      .q2 = q2.value_or(0.0), .is_constant = !q2, .points = static_cast<int>(points.size())};
  const int lacking =
      dimension == 0 ? static_cast<int>(points.empty()) : lacking_points(points, dimension);
  evidence.is_covered = lacking == 0;
  evidence.wanted = lacking;
  if (q2 && !(*q2 >= kNeededQ2)) {
    evidence.wanted =
        std::max({lacking, evidence.points, 10 * std::max(1, dimension) - evidence.points});
  }
  return evidence;
}

}  // namespace glint
