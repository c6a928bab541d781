// SPDX-License-Identifier: GPL-3.0-or-later
//
// Packets that get lost, double, out of order or late on their way.
#include "hardware/twin/camera/bad_cable.h"

#include <gmock/gmock.h>

#include <thread>

#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/started_camera.h"
#include "tests/hardware/twin/camera/twin_process.h"

namespace glint {
namespace {

using std::chrono::milliseconds;

/// The number of the pattern that a frame shows; empty: none of those below `end`.
std::optional<std::uint64_t> number_of(const Frame& frame, std::uint64_t end) {
  for (std::uint64_t number = 0; number < end; ++number) {
    if (frame.codes(0, 0) == test_pattern(1, 1, 8, number)(0, 0) &&
        frame.codes == test_pattern(kTwinWidth, kTwinHeight, 8, number)) {
      return number;
    }
  }
  return std::nullopt;
}

/// Pictures taken through a cable: how many came, and whether one came twice or out of order.
struct Delivered {
  int complete = 0;
  int named = 0;  ///< did not come, and were said not to
  bool is_in_order = true;
};

Delivered deliver(Camera& camera, int frames) {
  Delivered delivered;
  std::optional<std::uint64_t> last;
  for (int i = 0; i < frames; ++i) {
    const Frame frame = camera.capture();
    if (!frame.is_complete()) {
      ++delivered.named;
      continue;
    }
    ++delivered.complete;
    const auto number = number_of(frame, 250);
    delivered.is_in_order = delivered.is_in_order && number && (!last || *number > *last);
    last = number;
  }
  return delivered;
}

class LossyCable : public testing::Test {
 protected:
  TwinProcess process_{test_address(21)};
  BadCable cable_{test_address(21), test_address(22)};
};

TEST_F(LossyCable, OnePercentLostIsDeliveredInFull) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.dropped = 0.01});
  const Delivered delivered = deliver(*camera, 20);
  EXPECT_EQ(delivered.complete, 20);
  EXPECT_TRUE(delivered.is_in_order);
  EXPECT_GT(cable_.counts().resent, 0U);
}

TEST_F(LossyCable, FivePercentLostIsDeliveredOrNamed) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.dropped = 0.05});
  const Delivered delivered = deliver(*camera, 10);
  EXPECT_EQ(delivered.complete + delivered.named, 10);
  EXPECT_GE(delivered.complete, 8);
  EXPECT_TRUE(delivered.is_in_order);
}

TEST_F(LossyCable, DoubledAndSwappedPacketsDoNoHarm) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.doubled = 0.01, .swapped = 0.01});
  const Delivered delivered = deliver(*camera, 10);
  EXPECT_EQ(delivered.complete, 10);
  EXPECT_TRUE(delivered.is_in_order);
  EXPECT_GT(cable_.counts().doubled, 0U);
  EXPECT_GT(cable_.counts().swapped, 0U);
}

// Without any answer to requests nearly every try lacks a packet: it is said, never shown.
TEST_F(LossyCable, WithoutResentPacketsIncompleteFramesAreNamed) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.dropped = 0.05, .answers_resend = false});
  const Frame frame = camera->capture();
  EXPECT_EQ(frame.status, FrameStatus::kIncomplete);
  EXPECT_EQ(frame.retakes, kMostRetakes);
  EXPECT_TRUE(frame.codes.empty());
  cable_.set_faults({});
  EXPECT_TRUE(camera->capture().is_complete());
}

// The first picture comes 1.3 s late: it belongs to an older trigger by then.
TEST_F(LossyCable, ALatePictureIsThrownAway) {
  const auto camera = started_camera(test_address(22));
  EXPECT_TRUE(camera->capture().is_complete());  // number 0
  cable_.set_faults({.delay = milliseconds(1300)});
  std::jthread repair([&] {
    std::this_thread::sleep_for(milliseconds(600));
    cable_.set_faults({});
  });
  const Frame frame = camera->capture();
  ASSERT_TRUE(frame.is_complete()) << frame.what;
  EXPECT_GE(frame.retakes, 1);
  EXPECT_EQ(frame.late_frames, 1);
  EXPECT_EQ(number_of(frame, 10), 2U);
}

}  // namespace
}  // namespace glint
