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
#include <kdl/chain.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/frames.hpp>

#include "core/rng.h"
#include "core/units.h"
#include "hardware/robot/kinematics/arm.h"

namespace glint {
namespace {

constexpr int kPoses = 5000;
constexpr int kStarts = 10;
constexpr double kMPerMm = 1e-3;

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

KDL::Chain chain_of(const Arm& arm) {
  KDL::Chain chain;
  for (const DhRow& row : arm.table()) {
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::RotZ),
                     KDL::Frame::DH(row.a_mm * kMPerMm, row.alpha_rad, row.d_mm * kMPerMm, 0.0)));
  }
  return chain;
}

KDL::Frame frame_of(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d r = pose.linear();
  const Eigen::Vector3d t = kMPerMm * pose.translation();
  return {KDL::Rotation(
              r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
          KDL::Vector(t.x(), t.y(), t.z())};
}

bool reaches(const Arm& arm, const JointVector& joints_rad, const Eigen::Isometry3d& pose) {
  const JointVector left = pose_difference(arm.forward(joints_rad), pose);
  return left.head<3>().norm() < 1e-3 && left.tail<3>().norm() < 1e-5;
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
      found += all.empty() || !reaches(arm, all[0], pose) ? 0.0 : 1.0;
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
  const KDL::Chain chain = chain_of(arm);
  KDL::ChainIkSolverPos_LMA solver(chain, 1e-7, 500);
  double found = 0.0;
  for (auto _ : state) {
    found = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const KDL::Frame frame = frame_of(poses[i]);
      KDL::JntArray start(6);
      KDL::JntArray result(6);
      bool is_solved = false;
      for (std::uint64_t k = 0; k < kStarts && !is_solved; ++k) {
        start.data = random_joints(1000000 + kStarts * i + k);
        is_solved = solver.CartToJnt(start, frame, result) >= 0;
      }
      found += is_solved && reaches(arm, JointVector(result.data), poses[i]) ? 1.0 : 0.0;
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
