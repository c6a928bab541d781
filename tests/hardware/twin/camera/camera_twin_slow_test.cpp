// SPDX-License-Identifier: GPL-3.0-or-later
//
// A thousand pictures of 5 megapixels in each depth.
#include <algorithm>
#include <map>
#include <vector>

#include <gmock/gmock.h>

#include "core/wall_clock.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/twin_process.h"

namespace glint {
namespace {

constexpr int kFrames = 1000;
constexpr int kBlock = 100;  ///< frames whose rate is taken together

struct Taken {
  int complete = 0;
  int wrong = 0;
  int retakes = 0;
  std::vector<double> block_s;  ///< what each block took, without the check of its bytes
  bool has_packet_sockets = false;

  /// The median over the blocks: some other program may have the machine for a while.
  double frames_per_second() const {
    std::vector<double> sorted = block_s;
    std::ranges::sort(sorted);
    return kBlock / sorted.at(sorted.size() / 2);
  }
};

Taken take_frames(PixelFormat format) {
  const std::uint32_t address = test_address(1);
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  camera.configure({.format = format, .exposure_us = 1000.0, .packet_size = 9000});
  camera.start();
  Taken taken = {.block_s = std::vector<double>(kFrames / kBlock),
                 .has_packet_sockets = camera.description().has_packet_sockets};
  TestPatternSource patterns(kTwinWidth, kTwinHeight);
  for (int number = 0; number < kFrames; ++number) {
    const auto begin = std::chrono::steady_clock::now();
    const Frame frame = camera.capture();
    taken.block_s[static_cast<std::size_t>(number / kBlock)] += seconds_since(begin);
    taken.complete += frame.is_complete() ? 1 : 0;
    taken.retakes += frame.retakes;
    const auto shot = static_cast<std::uint64_t>(number + taken.retakes);
    taken.wrong += frame.codes == *patterns.finished({.bits = bits_of(format)}, shot) ? 0 : 1;
  }
  return taken;
}

/// Taken once for all tests of a format.
const Taken& taken_in(PixelFormat format) {
  static std::map<PixelFormat, Taken> kept;
  const auto found = kept.find(format);
  return found != kept.end() ? found->second
                             : kept.emplace(format, take_frames(format)).first->second;
}

class ThousandFrames : public testing::TestWithParam<PixelFormat> {};

INSTANTIATE_TEST_SUITE_P(CameraTwin,
                         ThousandFrames,
                         testing::Values(PixelFormat::kMono8, PixelFormat::kMono12),
                         [](const auto& format) { return std::string(name_of(format.param)); });

TEST_P(ThousandFrames, ComeWithEveryByteRight) {
  const Taken& taken = taken_in(GetParam());
  EXPECT_EQ(taken.complete, kFrames);
  EXPECT_EQ(taken.wrong, 0);
}

TEST_P(ThousandFrames, ComeAtTenASecondOrMore) {
  const Taken& taken = taken_in(GetParam());
  std::printf("%.1f frames per second, %d taken again\n", taken.frames_per_second(), taken.retakes);
  if (!taken.has_packet_sockets) {
    GTEST_SKIP() << "packet sockets are not allowed here";
  }
  EXPECT_GE(taken.frames_per_second(), 10.0);
}

}  // namespace
}  // namespace glint
