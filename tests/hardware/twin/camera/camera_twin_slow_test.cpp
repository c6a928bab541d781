// SPDX-License-Identifier: GPL-3.0-or-later
//
// A thousand pictures of 5 megapixels in each depth.
#include <gmock/gmock.h>

#include "core/wall_clock.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/twin_process.h"

namespace glint {
namespace {

class ThousandFrames : public testing::TestWithParam<PixelFormat> {};

INSTANTIATE_TEST_SUITE_P(CameraTwin,
                         ThousandFrames,
                         testing::Values(PixelFormat::kMono8, PixelFormat::kMono12),
                         [](const auto& format) { return std::string(name_of(format.param)); });

TEST_P(ThousandFrames, ComeWithEveryByteRight) {
  constexpr int kFrames = 1000;
  const std::uint32_t address = test_address(1);
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  camera.configure({.format = GetParam(), .exposure_us = 1000.0, .packet_size = 9000});
  camera.start();
  double taking_s = 0.0;  // without the check of the bytes
  int complete = 0;
  int wrong = 0;
  int retakes = 0;
  for (std::uint64_t number = 0; number < kFrames; ++number) {
    const auto begin = std::chrono::steady_clock::now();
    const Frame frame = camera.capture();
    taking_s += seconds_since(begin);
    complete += frame.is_complete() ? 1 : 0;
    retakes += frame.retakes;
    const auto expected = test_pattern(2448, 2050, bits_of(GetParam()), number + unsigned(retakes));
    wrong += frame.codes == expected ? 0 : 1;
  }
  EXPECT_EQ(complete, kFrames);
  EXPECT_EQ(wrong, 0);
  RecordProperty("frames_per_second", std::to_string(kFrames / taking_s));
  std::printf("%.1f frames per second, %d taken again\n", kFrames / taking_s, retakes);
}

}  // namespace
}  // namespace glint
