// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/jobs.h"

#include <atomic>
#include <latch>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(Jobs, DoesEachPieceOnce) {
  for (const int jobs : {0, 1, 3, 100}) {
    std::vector<std::atomic<int>> done(50);
    run_jobs(done.size(), jobs, [&](std::size_t i) { ++done[i]; });
    for (const std::atomic<int>& count : done) {
      EXPECT_EQ(count, 1) << jobs;
    }
  }
  run_jobs(0, 4, [](std::size_t) { FAIL(); });
}

// Each waits until all three have begun: with fewer threads this would never end.
TEST(Jobs, RunsAsManyAtATimeAsAskedFor) {
  std::latch begun(3);
  run_jobs(3, 3, [&](std::size_t) { begun.arrive_and_wait(); });
}

TEST(Jobs, OneAtATimeGoesInOrderAndStopsAtAnError) {
  std::vector<std::size_t> order;
  const auto work = [&](std::size_t i) {
    order.push_back(i);
    if (i == 2) {
      throw std::runtime_error("two");
    }
  };
  EXPECT_THROW(run_jobs(5, 1, work), std::runtime_error);
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2}));
}

TEST(Jobs, TellsTheErrorOfTheFirstPieceThatFailed) {
  std::latch begun(2);
  try {
    run_jobs(2, 2, [&](std::size_t i) {
      begun.arrive_and_wait();
      throw std::runtime_error(std::to_string(i));
    });
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "0");
  }
}

TEST(Jobs, LeavesTheRestOutWhenItIsEnded) {
  int count = 0;
  run_jobs(
      10, 1, [&](std::size_t) { ++count; }, [&] { return count == 4; });
  EXPECT_EQ(count, 4);
}

}  // namespace
}  // namespace glint
