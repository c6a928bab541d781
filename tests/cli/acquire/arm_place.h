// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the arm of a cell's twin stands after `glint acquire` has ended, however it did.
#pragma once

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "hardware/acquisition/tour.h"
#include "studies/acquire/taught_views.h"
#include "tests/cli/program.h"

namespace glint::test {

/// Joints of all legs of the cell's tour, in its order.
inline Tour tour_of_cell(const TemporaryFolder& folder) {
  Tour tour;
  for (const PlannedPath& path : plan_of_cell_views(read_cell(folder / "cell.toml"), 1.0).paths) {
    for (std::size_t i = tour.empty() ? 0 : 1; i < path.joints_rad.size(); ++i) {
      tour.push_back({.name = path.to, .joints_rad = path.joints_rad[i]});
    }
  }
  return tour;
}

/// After whatever happened the arm is on its path; where the program could say how it ended, it is
/// where that says.
inline void expect_on_its_path(const TemporaryFolder& folder,
                               const Tour& tour,
                               const ProgramResult& result) {
  const nlohmann::json status =
      json_of(folder, {"cell", "status", "cell.toml", "--twin", "twin.json"});
  JointVector joints_rad;
  for (Eigen::Index i = 0; i < 6; ++i) {
    joints_rad[i] =
        status["robot"]["joints_deg"][static_cast<std::size_t>(i)].get<double>() * kRadPerDeg;
  }
  EXPECT_LT(distance_from_tour_rad(tour, joints_rad), kOnTourRad);
  const nlohmann::json told = nlohmann::json::parse(result.out, nullptr, false);
  if (told.is_object() && told.contains("end") && told["end"].is_object() &&
      told["end"]["how"] != "stopped") {
    EXPECT_EQ(told["end"]["where"], "above");
    const JointVector away_rad = tour.front().joints_rad - joints_rad;
    EXPECT_LT(away_rad.cwiseAbs().maxCoeff(), kOnTourRad) << told["end"];
  }
}

}  // namespace glint::test
