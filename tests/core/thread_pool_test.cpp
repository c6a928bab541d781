// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/thread_pool.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <latch>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/rng.h"

namespace glint {
namespace {

/// A sum whose last bits depend on the order in which its terms are added.
double order_sensitive_sum(ThreadPool& pool) {
  const auto partial = [](std::int64_t chunk) {
    Rng rng(1, Stream::kTest, static_cast<std::uint64_t>(chunk));
    double sum = 0.0;
    for (int i = 0; i < 100; ++i) {
      sum += std::exp(30.0 * rng.normal());
    }
    return sum;
  };
  const std::vector<double> sums = pool.map<double>(300, partial);
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

TEST(ThreadPool, GivesTheSameBytesFor1And2And7Threads) {
  const tbb::global_control allow_more_than_the_machine_has(
      tbb::global_control::max_allowed_parallelism, 7);
  ThreadPool one(1);
  const double expected = order_sensitive_sum(one);
  for (const int threads : {2, 7}) {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      ASSERT_EQ(order_sensitive_sum(pool), expected) << threads << " threads";
    }
  }
}

TEST(ThreadPool, WorksOnSeveralThreadsAtOnce) {
  const tbb::global_control allow_more_than_the_machine_has(
      tbb::global_control::max_allowed_parallelism, 7);
  ThreadPool pool(7);
  std::mutex mutex;
  std::set<std::thread::id> seen;
  pool.for_each(64, [&](std::int64_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::lock_guard lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_GT(seen.size(), 1U);
  EXPECT_LE(seen.size(), 7U);
}

TEST(ThreadPool, CallsEachIndexOnce) {
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.num_threads(), threads);
    std::vector<std::atomic<int>> calls(10007);
    pool.for_each(10007, [&](std::int64_t i) { ++calls[static_cast<std::size_t>(i)]; });
    for (const auto& count : calls) {
      ASSERT_EQ(count.load(), 1);
    }
  }
}

TEST(ThreadPool, MapsInIndexOrder) {
  ThreadPool pool(3);
  const auto squares = pool.map<std::int64_t>(1000, [](std::int64_t i) { return i * i; });
  ASSERT_EQ(squares.size(), 1000U);
  for (std::int64_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(squares[static_cast<std::size_t>(i)], i * i);
  }
}

TEST(ThreadPool, DoesNothingForNothing) {
  for (const int threads : {1, 2}) {
    ThreadPool pool(threads);
    int calls = 0;
    pool.for_each(0, [&](std::int64_t) { ++calls; });
    EXPECT_EQ(calls, 0);
    EXPECT_TRUE(pool.map<int>(0, [](std::int64_t) { return 1; }).empty());
  }
}

TEST(ThreadPool, RethrowsWhatABodyThrowsAndWorksOn) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    const auto throw_at_17 = [](std::int64_t i) {
      if (i == 17) {
        throw std::runtime_error("seventeen");
      }
    };
    EXPECT_THAT([&] { pool.for_each(100, throw_at_17); },
                ::testing::ThrowsMessage<std::runtime_error>("seventeen"));
    EXPECT_EQ(pool.map<int>(3, [](std::int64_t) { return 1; }).size(), 3U);
  }
}

TEST(ThreadPool, MayBeUsedFromInsideItself) {
  ThreadPool pool(2);
  std::atomic<int> calls = 0;
  pool.for_each(10, [&](std::int64_t) { pool.for_each(10, [&](std::int64_t) { ++calls; }); });
  EXPECT_EQ(calls.load(), 100);
}

// Else a caller that holds a lock may meet itself. One thread has done its half of a loop and waits
// for the other half, which lasts as long as there is another loop to help with.
TEST(ThreadPool, AThreadThatWaitsForALoopBeginsNothingOfAnother) {
  ThreadPool pool(3);
  std::latch both_halves(2);
  std::atomic<bool> is_over = false;
  std::thread::id waiting;
  std::jthread first([&] {
    waiting = std::this_thread::get_id();
    pool.for_each(2, [&](std::int64_t) {
      both_halves.arrive_and_wait();
      if (std::this_thread::get_id() != waiting) {
        is_over.wait(false);
      }
    });
  });
  both_halves.wait();
  std::atomic<int> helped = 0;
  pool.for_each(50, [&](std::int64_t) {
    helped += std::this_thread::get_id() == waiting ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  is_over = true;
  is_over.notify_all();
  EXPECT_EQ(helped.load(), 0);
}

TEST(ThreadPoolDeathTest, RefusesToHaveNoThread) {
  EXPECT_DEATH(ThreadPool(0), "a pool needs a thread");
}

TEST(HardwareThreads, IsAtLeastOne) {
  EXPECT_GE(hardware_threads(), 1);
}

}  // namespace
}  // namespace glint
