// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fifty views around a part of 51,000 triangles planned for a UR3, against single distances by FCL
// over the same pairs of bodies at random poses of the arm. The goal is that planning takes no more
// than 500,000 such distances: `fcl_queries` is the ratio of the two times, in units of one query.
#include <ctime>

#include <benchmark/benchmark.h>

#include "hardware/planning/clearance.h"
#include "hardware/planning/view_planner.h"
#include "tests/hardware/planning/planned_cell.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"

namespace glint {
namespace {

constexpr std::uint64_t kViews = 50;
constexpr std::uint64_t kPoses = 200;
constexpr int kRows = 113;  ///< of the ball: 50,624 triangles
constexpr double kAll = 1e6;

PlanningCell large_cell() {
  PlanningCell cell = planned_cell();
  cell.standing[0].mesh = ball_mesh({300.0, 0.0, 60.0}, 40.0, kRows);
  return cell;
}

/// Seconds of CPU time that a distance of a moving to a standing body takes.
double query_s() {
  const PlanningCell cell = large_cell();
  const ClearanceCheck check(cell);
  const std::vector<SolidBody>& bodies = check.bodies();
  const MeshDistances distances(bodies);
  const std::clock_t start = std::clock();
  for (std::uint64_t i = 0; i < kPoses; ++i) {
    const LinkFrames frames = cell.arm.arm.frames(random_joints(i));
    for (std::size_t a = 0; a < bodies.size(); ++a) {
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (bodies[a].kind == SolidBody::Kind::kStanding && bodies[b].link > 0) {
          benchmark::DoNotOptimize(distances.distance_mm(
              a, frames[0], b, frames[static_cast<std::size_t>(bodies[b].link)], kAll));
        }
      }
    }
  }
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC /
         static_cast<double>(distances.num_queries());
}

void plan_fifty(benchmark::State& state) {
  const PlanningCell cell = large_cell();
  std::vector<ViewRequest> views;
  for (std::uint64_t i = 0; i < kViews; ++i) {
    views.push_back(random_view(i));
  }
  const double one_s = query_s();
  ViewPlan plan;
  PlanEffort effort;
  std::clock_t spent = 0;
  for (auto _ : state) {
    const std::clock_t start = std::clock();
    plan = plan_views(cell, views, {.has_nearest = state.range(0) != 0}, &effort);
    spent += std::clock() - start;
  }
  const double plan_s =
      static_cast<double>(spent) / CLOCKS_PER_SEC / static_cast<double>(state.iterations());
  state.counters["fcl_queries"] = plan_s / one_s;
  state.counters["asked"] = static_cast<double>(effort.distance_queries);
  state.counters["query_us"] = 1e6 * one_s;
  state.counters["planned"] = plan.reach_share * static_cast<double>(kViews);
}

BENCHMARK(plan_fifty)
    ->Name("plan/fifty_views")
    ->ArgName("nearest")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint
