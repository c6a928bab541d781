// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inverse kinematics of 5,000 random reachable poses of a UR3: all branches in closed form, against
// KDL's solver after Levenberg and Marquardt, which is given up to ten random starts and finds one
// solution. `poses_found` counts poses for which the solution reaches the pose to 1e-6 m;
// `solutions` is the mean number of them. The ratio of the two times a pose is the factor.
#include <array>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <kdl/chainiksolverpos_lma.hpp>

#include "core/rng.h"
#include "core/units.h"
#include "hardware/robot/kinematics/arm.h"
#include "tests/hardware/robot/kinematics/kdl_arm.h"

namespace glint {
namespace {

constexpr int kPoses = 5000;
constexpr int kStarts = 10;

JointVector random_joints(std::uint64_t index) {
  Rng rng(1, Stream::kTest, index);
  JointVector joints_rad;
  for (double& angle : joints_rad) {
    angle = rng.uniform(-kPi, kPi);
  }
  return joints_rad;
}

std::vector<Eigen::Isometry3d> random_poses(const Arm& arm) {
  std::vector<Eigen::Isometry3d> poses;
  for (std::uint64_t i = 0; i < kPoses; ++i) {
    poses.push_back(arm.forward(random_joints(i)));
  }
  return poses;
}

void closed_form(benchmark::State& state) {
  const Arm arm(ArmModel::kUr3);
  const std::vector<Eigen::Isometry3d> poses = random_poses(arm);
  double found = 0.0;
  double solutions = 0.0;
  for (auto _ : state) {
    found = 0.0;
    solutions = 0.0;
    for (const Eigen::Isometry3d& pose : poses) {
      const ArmSolutions all = arm.inverse(pose);
      solutions += all.size();
      found += all.empty() || !test::reaches(arm, all[0], pose) ? 0.0 : 1.0;
    }
  }
  state.counters["poses_found"] = found;
  state.counters["solutions"] = solutions / kPoses;
  state.counters["us_a_pose"] = benchmark::Counter(
      1e-6 * kPoses, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void kdl_lma(benchmark::State& state) {
  const Arm arm(ArmModel::kUr3);
  const std::vector<Eigen::Isometry3d> poses = random_poses(arm);
  const KDL::Chain chain = test::chain_of(arm);
  KDL::ChainIkSolverPos_LMA solver(chain, 1e-7, 500);
  double found = 0.0;
  for (auto _ : state) {
    found = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const KDL::Frame frame = test::frame_of(poses[i]);
      KDL::JntArray start(6);
      KDL::JntArray result(6);
      bool is_solved = false;
      for (std::uint64_t k = 0; k < kStarts && !is_solved; ++k) {
        start.data = random_joints(1000000 + kStarts * i + k);
        is_solved = solver.CartToJnt(start, frame, result) >= 0;
      }
      found += is_solved && test::reaches(arm, JointVector(result.data), poses[i]) ? 1.0 : 0.0;
    }
  }
  state.counters["poses_found"] = found;
  state.counters["solutions"] = found / kPoses;
  state.counters["us_a_pose"] = benchmark::Counter(
      1e-6 * kPoses, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(closed_form)->Name("cell/inverse/closed_form")->Unit(benchmark::kMillisecond);
BENCHMARK(kdl_lma)->Name("cell/inverse/kdl_lma")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint
