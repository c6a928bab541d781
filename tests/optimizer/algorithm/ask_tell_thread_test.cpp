// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/ask_tell_thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stdexcept>

#include "optimizer/algorithm/multi_start.h"
#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

using Status = AskTellThread::Status;

/// Who waits for it is still there when the test runner gives up.
constexpr double kAnHour_s = 3600.0;

/// Holds threads until it is opened; shared, because abandoned threads outlive their test.
struct Door {
  std::mutex mutex;
  std::condition_variable opened;
  bool is_open = false;

  void wait() {
    std::unique_lock lock(mutex);
    opened.wait(lock, [this] { return is_open; });
  }

  void open() {
    const std::lock_guard lock(mutex);
    is_open = true;
    opened.notify_all();
  }
};

/// Asks 1, 2, 3, ... and stops asking after `limit` questions without ending.
AskTellThread::Body counting_body(int limit, const std::shared_ptr<Door>& door) {
  return [limit, door](const AskTellThread::Call& call) -> std::string {
    for (int i = 1; i <= limit; ++i) {
      if (!call({static_cast<double>(i) / 100.0})) {
        return "stopped";
      }
    }
    door->wait();
    call({0.99});
    return "late";
  };
}

TEST(AskTellThread, HandsOutQuestionsAndAnswers) {
  std::vector<double> told;
  AskTellThread thread(
      [&told](const AskTellThread::Call& call) -> std::string {
        double x = 0.0;
        while (x < 3.0) {
          told.push_back(call({x, -x})->merit);
          ++x;
        }
        return "had enough";
      },
      10.0);
  double x = 0.0;
  while (x < 3.0) {
    ASSERT_EQ(thread.ask(), Status::kAsked);
    EXPECT_EQ(thread.point(), (std::vector<double>{x, -x}));
    thread.tell({.merit = 10.0 * x});
    ++x;
  }
  EXPECT_EQ(thread.ask(), Status::kFinished);
  EXPECT_EQ(thread.ask(), Status::kFinished);
  EXPECT_EQ(thread.ending(), "had enough");
  EXPECT_EQ(told, (std::vector<double>{0.0, 10.0, 20.0}));
}

TEST(AskTellThread, TakesAnExceptionAsItsEnding) {
  AskTellThread thread(
      [](const AskTellThread::Call&) -> std::string { throw std::runtime_error("no memory"); },
      10.0);
  EXPECT_EQ(thread.ask(), Status::kFinished);
  EXPECT_EQ(thread.ending(), "no memory");
}

TEST(AskTellThread, AbandonsABodyThatNeverAsksAgain) {
  const auto door = std::make_shared<Door>();
  {
    AskTellThread thread(counting_body(2, door), 0.05);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(thread.ask(), Status::kAsked);
      thread.tell({.merit = 0.0});
    }
    EXPECT_EQ(thread.ask(), Status::kAbandoned);
    EXPECT_EQ(thread.ask(), Status::kAbandoned);
  }
  EXPECT_FALSE(door->is_open) << "the body has not ended";
  door->open();
}

TEST(AskTellThread, DestructorNeverHangsWhateverTheBodyDoes) {
  const auto door = std::make_shared<Door>();
  { const AskTellThread never_asked(counting_body(5, door), kAnHour_s); }
  {
    AskTellThread asked(counting_body(5, door), kAnHour_s);
    EXPECT_EQ(asked.ask(), Status::kAsked);
  }
  {
    AskTellThread told(counting_body(5, door), kAnHour_s);
    told.ask();
    told.tell({.merit = 1.0});
  }
  {
    // Does not end when it is asked to: left behind after the patience.
    AskTellThread stubborn(counting_body(1, door), 0.05);
    stubborn.ask();
    stubborn.tell({.merit = 1.0});
  }
  EXPECT_FALSE(door->is_open) << "the stubborn body has not ended";
  door->open();
}

TEST(AskTellThread, StopSaysWhetherTheBodyEnded) {
  const auto door = std::make_shared<Door>();
  AskTellThread obedient(counting_body(5, door), 5.0);
  obedient.ask();
  EXPECT_TRUE(obedient.stop());
  EXPECT_EQ(obedient.ending(), "stopped");
  AskTellThread stubborn(counting_body(0, door), 0.05);
  EXPECT_FALSE(stubborn.stop());
  door->open();
}

TEST(MultiStart, GoesOnWithAnotherRunWhenOneNeverAsksAgain) {
  const auto door = std::make_shared<Door>();
  MultiStart search(
      test::box(1, 0, 1), {.method = "fake", .patience_s = 0.05}, {}, [door](const MethodRun&) {
        return counting_body(3, door);
      });
  int abandoned = 0;
  for (int i = 0; i < 8; ++i) {
    const Point point = *search.ask();
    EXPECT_DOUBLE_EQ(point[0], (i % 3 + 1) / 100.0);
    search.tell(point, 1.0, false);
    for (const Event& event : search.take_events()) {
      abandoned += event.kind == EventKind::kAbandon ? 1 : 0;
    }
  }
  EXPECT_EQ(abandoned, 2);
  door->open();
}

TEST(MultiStart, ReplaysAnAbandonedRunWithoutWaitingForIt) {
  const auto door = std::make_shared<Door>();
  door->open();  // this time the run would answer
  MultiStart search(
      test::box(1, 0, 1), {.method = "fake", .patience_s = 60.0}, {}, [door](const MethodRun&) {
        return counting_body(3, door);
      });
  for (int i = 0; i < 3; ++i) {
    search.tell(*search.ask(), 1.0, false);
  }
  search.abandon_run(0);
  EXPECT_DOUBLE_EQ((*search.ask())[0], 0.01);
}

}  // namespace
}  // namespace glint
