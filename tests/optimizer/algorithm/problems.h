// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small spaces and functions for the tests of the optimiser.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/rng.h"
#include "optimizer/algorithm/algorithm.h"
#include "optimizer/problem/space.h"
#include "optimizer/search/search.h"
#include "tests/support/temporary_folder.h"

namespace glint::test {

inline SearchSpace box(int num_dimensions, double low, double high) {
  SearchSpace space;
  for (int i = 0; i < num_dimensions; ++i) {
    space.variables.push_back({.name = "x" + std::to_string(i), .low = low, .high = high});
  }
  return space;
}

/// Every kind of variable: float, log, stepped, integer, choice, and two conditional ones.
inline SearchSpace mixed_space() {
  using Kind = Variable::Kind;
  return {
      {{.name = "length", .low = -3.0, .high = 5.0},
       {.name = "period", .low = 0.1, .high = 100.0, .is_log = true},
       {.name = "angle", .low = 0.0, .high = 90.0, .step = 7.5},
       {.name = "positions", .kind = Kind::kInteger, .low = 3.0, .high = 12.0},
       {.name = "shape", .kind = Kind::kChoice, .choices = {"flat", "round", "free"}},
       {.name = "radius", .low = 10.0, .high = 20.0, .when_name = "shape", .when_value = "round"},
       {.name = "knots",
        .kind = Kind::kInteger,
        .low = 2.0,
        .high = 9.0,
        .when_name = "shape",
        .when_value = "free"}}};
}

/// Smooth in the continuous variables, best at shape "round".
inline double mixed_value(const Point& p) {
  const double shape = p[4] == 1.0 ? 0.0 : 1.5;
  return std::pow(p[0] - 1.0, 2) + std::pow(std::log10(p[1]), 2) + 1e-3 * std::pow(p[2] - 30.0, 2) +
         0.1 * std::abs(p[3] - 6.0) + shape + 0.05 * std::pow(p[5] - 17.0, 2) +
         0.1 * std::abs(p[6] - 4.0);
}

/// The same without rounding, for methods that need derivatives.
inline SearchSpace smooth_mixed_space() {
  SearchSpace space = mixed_space();
  space.variables[2].step = 0.0;
  return space;
}

/// Of mixed_value(), by the variables' own units; not known by choices and integers.
inline std::vector<double> mixed_gradient(const Point& p) {
  const double log_10 = std::log(10.0);
  const double unknown = std::nan("");
  return {2.0 * (p[0] - 1.0),
          2.0 * std::log10(p[1]) / (p[1] * log_10),
          2e-3 * (p[2] - 30.0),
          unknown,
          unknown,
          0.1 * (p[5] - 17.0),
          unknown};
}

/// A space that the algorithm accepts, with every kind of variable that it can be given.
inline SearchSpace mixed_space_for(std::string_view algorithm) {
  return needs_gradient(algorithm) ? smooth_mixed_space() : mixed_space();
}

inline std::size_t num_objectives_for(std::string_view algorithm) {
  return needs_several_objectives(algorithm) ? 2 : 1;
}

/// With as many objectives as it needs.
inline std::unique_ptr<Algorithm> make_for(const SearchSpace& space,
                                           const SearchSettings& settings,
                                           const std::vector<Point>& start_points) {
  const auto num_objectives = static_cast<int>(num_objectives_for(settings.algorithm));
  return make_algorithm(space, settings, start_points, 0, num_objectives);
}

inline bool is_allowed(const SearchSpace& space, const Point& point) {
  return point == canonical(space, point);
}

/// The same noise for the same evaluation, whatever happened before.
inline double noise(int trial) {
  return 0.05 * Rng(99, Stream::kTest, static_cast<std::uint64_t>(trial)).normal();
}

inline StudyIdentity identity(const std::string& hash = "abc") {
  return {.config_hash = hash, .config_text = "[part]\n", .code_version = "test", .seed = 7};
}

}  // namespace glint::test
