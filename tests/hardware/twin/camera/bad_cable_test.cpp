// SPDX-License-Identifier: GPL-3.0-or-later
//
// Packets that get lost, double, out of order or late on their way.
#include "hardware/twin/camera/bad_cable.h"

#include <gmock/gmock.h>

#include <thread>

#include "core/error.h"
#include "hardware/twin/camera/cable_text.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/started_camera.h"
#include "tests/hardware/twin/camera/twin_process.h"
#include "tests/support/count_from.h"

namespace glint {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

/// The smallest number from `first` on whose pattern a frame shows; patterns of 8 bits come again
/// after 256. Empty: it shows none.
std::optional<std::uint64_t> number_of(const Frame& frame, std::uint64_t first) {
  static TestPatternSource patterns(kTwinWidth, kTwinHeight);
  for (std::uint64_t number = first; number < first + 256; ++number) {
    if (frame.codes(0, 0) == test_pattern(1, 1, 8, number)(0, 0) &&
        frame.codes == *patterns.finished({.bits = 8}, number)) {
      return number;
    }
  }
  return std::nullopt;
}

/// Pictures taken through a cable: how many came, and whether each was that of its own trigger.
struct Delivered {
  int complete = 0;
  int named = 0;  ///< did not come, and were said not to
  bool is_paired = true;
};

/// Each try is another picture, so a frame shows the number of the tries before it.
Delivered deliver(Camera& camera, int frames) {
  Delivered delivered;
  std::uint64_t tries = 0;
  for (int i = 0; i < frames; ++i) {
    const Frame frame = camera.capture();
    tries += static_cast<std::uint64_t>(frame.retakes);
    if (frame.is_complete()) {
      ++delivered.complete;
      delivered.is_paired = delivered.is_paired && number_of(frame, tries) == tries;
    } else {
      ++delivered.named;
    }
    ++tries;
  }
  return delivered;
}

TEST(CableFaults, AreReadFromWords) {
  const auto faults = parse_cable_faults(" dropped=0.01 doubled=0.5 swapped=1 delay_ms=50 cut=1");
  ASSERT_TRUE(faults.has_value());
  EXPECT_EQ(faults->dropped, 0.01);
  EXPECT_EQ(faults->doubled, 0.5);
  EXPECT_EQ(faults->swapped, 1.0);
  EXPECT_EQ(faults->delay, milliseconds(50));
  EXPECT_TRUE(faults->is_cut);
  EXPECT_TRUE(faults->answers_resend);
  const auto good = parse_cable_faults("");
  ASSERT_TRUE(good.has_value());
  EXPECT_FALSE(good->is_cut);
  EXPECT_EQ(good->dropped, 0.0);
  for (const char* text :
       {"dropped", "dropped=", "dropped=1.1", "dropped=-1", "cut=2", "speed=1", "delay_ms=50ms"}) {
    EXPECT_FALSE(parse_cable_faults(text).has_value()) << text;
  }
}

class LossyCable : public testing::Test {
 protected:
  TwinProcess process_{test_address(21)};
  BadCable cable_{test_address(21), test_address(22)};
};

TEST_F(LossyCable, OnePercentLostIsDeliveredInFull) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.dropped = 0.01});
  const int frames = count_from("GLINT_MANY_FRAMES", 20);
  const Delivered delivered = deliver(*camera, frames);
  EXPECT_EQ(delivered.complete, frames);
  EXPECT_TRUE(delivered.is_paired);
  EXPECT_GT(cable_.counts().resent, 0U);
}

TEST_F(LossyCable, FivePercentLostIsDeliveredOrNamed) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.dropped = 0.05});
  const int frames = count_from("GLINT_MANY_FRAMES", 10);
  const Delivered delivered = deliver(*camera, frames);
  std::printf("%d complete, %d named\n", delivered.complete, delivered.named);
  EXPECT_EQ(delivered.complete + delivered.named, frames);
  EXPECT_GE(delivered.complete, frames * 8 / 10);
  EXPECT_TRUE(delivered.is_paired);
}

TEST_F(LossyCable, DoubledAndSwappedPacketsDoNoHarm) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.doubled = 0.01, .swapped = 0.01});
  const Delivered delivered = deliver(*camera, 10);
  EXPECT_EQ(delivered.complete, 10);
  EXPECT_TRUE(delivered.is_paired);
  EXPECT_GT(cable_.counts().doubled, 0U);
  EXPECT_GT(cable_.counts().swapped, 0U);
}

// Without any answer to requests nearly every try lacks a packet: it is said, never shown.
TEST_F(LossyCable, WithoutResentPacketsIncompleteFramesAreNamed) {
  const auto camera = started_camera(test_address(22));
  cable_.set_faults({.dropped = 0.05, .answers_resend = false});
  const Frame frame = camera->capture();
  EXPECT_EQ(frame.status, FrameStatus::kIncomplete);
  EXPECT_EQ(frame.retakes, kMaxRetakes);
  EXPECT_TRUE(frame.codes.empty());
  cable_.set_faults({});
  EXPECT_TRUE(camera->capture().is_complete());
}

// Packets of the size that the cell asks for do not get through: it is said before any picture is
// taken, with the largest size that does.
TEST_F(LossyCable, PacketsThatAreTooLongAreFoundByTheTestPacket) {
  cable_.set_faults({.longest_packet = 3000});
  AravisCamera camera(ipv4_text(test_address(22)));
  camera.configure({.exposure_us = 1000.0, .packet_size = 9000});
  try {
    camera.start();
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("packet_bytes: "));
    EXPECT_THAT(error.what(), HasSubstr("packets of 9000 bytes do not get through"));
  }
  EXPECT_GT(cable_.counts().dropped, 0U);
  camera.configure({.exposure_us = 1000.0, .packet_size = 2000});
  camera.start();
  EXPECT_TRUE(camera.capture().is_complete());
}

TEST(BadCable, LiesOnThisMachineAlone) {
  constexpr std::uint32_t kElsewhere = 0xc0a80001;  // 192.168.0.1
  EXPECT_THROW(BadCable(kElsewhere, test_address(26)), ConfigError);
  EXPECT_THROW(BadCable(test_address(26), kElsewhere), ConfigError);
  EXPECT_THROW(BadCable(test_address(26), 0), ConfigError) << "any address of the machine";
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
  EXPECT_EQ(number_of(frame, 0), 2U);
}

}  // namespace
}  // namespace glint
