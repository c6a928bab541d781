// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs as a Gaussian process search was told them, and what of them its models know. All of it
// follows from the designs in the order of telling.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "optimizer/algorithm/answer.h"
#include "optimizer/problem/space.h"
#include "optimizer/surrogate/gaussian_process.h"

namespace glint {

struct ToldDesign {
  Point point;
  std::vector<double> values;                     ///< objectives, then limits; empty: failed
  std::vector<double> errors;                     ///< of values; NaN: not known
  std::vector<UnitDerivatives> derivatives = {};  ///< of values; empty: none are taken
  double merit = 0.0;
};

/// What the model of success is told; a design is held for good where it stays below 0, so three
/// quarters of the way from a failure to a success.
inline constexpr double kFailure = 1.5;
inline constexpr double kSuccess = -0.5;

/// Models know as many at most; beyond, so many of them are kept when they are chosen anew.
inline constexpr std::size_t kMaxModelPoints = 800;
inline constexpr std::size_t kKeptModelPoints = 600;

struct ModelData {
  std::vector<Point> all;  ///< those of success
  std::vector<double> failures;
  std::vector<Point> points;  ///< those of objectives and limits
  std::vector<std::vector<double>> values;
  std::vector<std::vector<double>> errors;
  std::vector<std::size_t> told;  ///< which of the designs points are
};

/// All designs; when there are too many, a third of them first: the front of those within the
/// limits (spread_rows() of it), then the best; and others evenly in the order of telling.
/// @param num_values  objectives and limits
/// @param num_front   of the objectives whose front is kept: all; 0: none is
ModelData model_data(std::span<const ToldDesign> designs,
                     std::size_t num_values,
                     std::size_t num_front = 0);

int num_known(const UnitDerivatives& derivatives);

/// How many derivatives a model may know: 300 in all, shared by the values that have any.
int derivatives_per_model(std::span<const ToldDesign> designs, std::size_t num_values);

/// Derivatives of one value at the points of the data: of those nearest to the one of the best
/// merit, as many as there is room for. @param designs  with derivatives; or empty, as is the
/// result then
std::vector<UnitDerivatives> nearest_derivatives(const SearchSpace& space,
                                                 std::span<const ToldDesign> designs,
                                                 const ModelData& data,
                                                 std::size_t value,
                                                 int room);

/// NaN for variables that are not smooth at this point. @param gradient  empty: not known
UnitDerivatives unit_derivatives(const SearchSpace& space,
                                 const Point& point,
                                 const std::vector<double>& gradient);

/// What each model expects of each design, a row per design; an empty one where it failed.
std::vector<std::vector<Expectation>> expected_rows_of(std::span<const GaussianProcess> models,
                                                       std::span<const ToldDesign> designs);

/// How the models of such designs are fitted, by the rules of the search (SearchSettings::rules).
GaussianProcessSettings model_settings(int rules, bool is_noisy, bool takes_derivatives);

}  // namespace glint
