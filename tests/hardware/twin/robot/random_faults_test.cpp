// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random sequences of motions and faults on the injected clock: every motion has a result in time,
// no arm moves after a stop, and a sequence gives the same results again.
#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"
#include "tests/support/count_from.h"

namespace glint {
namespace {

std::string run_sequence(std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 7);
  TwinHarness harness(seed % 2 == 0 ? ArmModel::kUr3 : ArmModel::kUr3e);
  std::string outcomes;
  bool is_cut = false;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 2; ++k) {
      if (rng.uniform() < 0.4) {
        const Fault fault = random_fault(rng);
        is_cut = is_cut || fault.kind == FaultKind::kCut;
        harness.twin.add_fault(fault);
      }
    }
    JointVector goal_rad = test_start_rad();
    for (double& angle : goal_rad) {
      angle += rng.uniform(-0.4, 0.4);
    }
    const double start_s = harness.now_s();
    const auto result = harness.move(goal_rad, rng.uniform(0.3, 1.0));
    EXPECT_TRUE(result.has_value()) << "seed " << seed << ": hangs";
    if (!result) {
      return outcomes;
    }
    EXPECT_LT(harness.now_s() - start_s, 30.0);
    outcomes += std::string(name_of(result->outcome)) + " ";
    if (is_stop(result->outcome)) {
      harness.run(0.5);
      if (!is_cut) {
        EXPECT_EQ(harness.motion_rad(0.5), 0.0) << "seed " << seed << ": " << outcomes;
      }
      const std::size_t sent = harness.scripts().size();
      EXPECT_TRUE(is_stop(harness.move(test_start_rad())->outcome));
      EXPECT_EQ(harness.scripts().size(), sent);
      harness.twin.add_fault({.kind = FaultKind::kRelease});
      if (!is_cut) {
        EXPECT_EQ(harness.motion_rad(0.5), 0.0) << "seed " << seed << ", reset: " << outcomes;
      }
      break;
    }
  }
  return outcomes;
}

TEST(RandomFaults, EveryMotionHasAResultAndNothingMovesAfterAStop) {
  const int sequences = count_from("GLINT_NUM_SEQUENCES", 100);
  int stopped = 0;
  int arrived = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(sequences); ++seed) {
    const std::string outcomes = run_sequence(seed);
    stopped += outcomes.find("stop") != std::string::npos ? 1 : 0;
    arrived += outcomes.find("done") != std::string::npos ? 1 : 0;
    if (seed % 10 == 0) {
      EXPECT_EQ(run_sequence(seed), outcomes);
    }
  }
  EXPECT_GT(stopped, sequences / 20);
  EXPECT_GT(arrived, sequences / 10);
}

}  // namespace
}  // namespace glint
