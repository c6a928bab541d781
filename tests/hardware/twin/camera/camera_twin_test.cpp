// SPDX-License-Identifier: GPL-3.0-or-later
//
// The product's camera against the simulated one, over the wire.
#include "hardware/twin/camera/camera_twin.h"

#include <gmock/gmock.h>

#include <thread>

#include "core/error.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/camera/find_cameras.h"
#include "hardware/gige/discovery.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/twin_process.h"
#include "tests/support/process_sockets.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

CameraConfiguration configuration_of(PixelFormat format) {
  return {.format = format, .exposure_us = 1000.0, .packet_size = 9000};
}

/// Frames in which something is wrong.
struct Counted {
  int incomplete = 0;
  int wrong = 0;  ///< bytes, or the number of the picture
  std::vector<std::uint64_t> ids;
};

/// Takes pictures that must be number 0, 1, ...
Counted count_wrong(Camera& camera, PixelFormat format, int frames) {
  Counted counted;
  TestPatternSource patterns(kTwinWidth, kTwinHeight);
  for (int i = 0; i < frames; ++i) {
    const Frame frame = camera.capture();
    if (!frame.is_complete()) {
      ++counted.incomplete;
      continue;
    }
    const auto number = static_cast<std::uint64_t>(i);
    counted.wrong += frame.codes == *patterns.finished({.bits = bits_of(format)}, number) ? 0 : 1;
    counted.ids.push_back(frame.frame_id);
  }
  return counted;
}

class EachFormat : public testing::TestWithParam<PixelFormat> {};

INSTANTIATE_TEST_SUITE_P(CameraTwin,
                         EachFormat,
                         testing::Values(PixelFormat::kMono8, PixelFormat::kMono12),
                         [](const auto& format) { return std::string(name_of(format.param)); });

// Picture ids begin at 65500 and go on with 1 after 65535.
TEST_P(EachFormat, SixtyNumberedPicturesComeWithEveryByteRight) {
  const std::uint32_t address = test_address(1);
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  camera.configure(configuration_of(GetParam()));
  camera.start();
  const Counted counted = count_wrong(camera, GetParam(), 60);
  EXPECT_EQ(counted.incomplete, 0);
  EXPECT_EQ(counted.wrong, 0);
  ASSERT_THAT(counted.ids, SizeIs(60));
  EXPECT_EQ(counted.ids.front(), 65500U);
  EXPECT_EQ(counted.ids[35], 65535U);
  EXPECT_EQ(counted.ids[36], 1U);
}

TEST(CameraTwin, ShowsAllFormatsAndRegions) {
  const std::uint32_t address = test_address(2);
  const TwinProcess process(address, 1);
  AravisCamera camera(ipv4_text(address));
  EXPECT_THAT(camera.description().formats, SizeIs(kPixelFormats.size()));
  const SensorRegion region = {.x_px = 101, .y_px = 7, .width_px = 333, .height_px = 55};
  std::uint64_t number = 0;
  for (const PixelFormat format : kPixelFormats) {
    CameraConfiguration configuration = configuration_of(format);
    configuration.region = region;
    camera.configure(configuration);
    camera.start();
    const Frame frame = camera.capture();
    ASSERT_TRUE(frame.is_complete()) << name_of(format) << ": " << frame.what;
    ASSERT_EQ(frame.codes.width(), region.width_px);
    ASSERT_EQ(frame.codes.height(), region.height_px);
    const auto whole = test_pattern(kTwinWidth, kTwinHeight, bits_of(format), number++);
    EXPECT_EQ(frame.codes(0, 0), whole(101, 7)) << name_of(format);
    EXPECT_EQ(frame.codes(332, 54), whole(433, 61)) << name_of(format);
    camera.stop();
  }
}

// Binned pixels are fewer, and a region of before leaves offsets behind.
TEST(CameraTwin, ShowsTheWholeSensorWithAndWithoutBinning) {
  const std::uint32_t address = test_address(33);
  const TwinProcess process(address, 1);
  AravisCamera camera(ipv4_text(address));
  CameraConfiguration configuration = configuration_of(PixelFormat::kMono8);
  configuration.region = SensorRegion{.x_px = 1500, .y_px = 1200, .width_px = 64, .height_px = 48};
  camera.configure(configuration);
  configuration.region.reset();
  for (std::uint64_t number = 0; number < 2; ++number) {
    const int binning = number == 0 ? 2 : 1;
    configuration.features = {{"BinningHorizontal", std::to_string(binning)},
                              {"BinningVertical", std::to_string(binning)}};
    camera.configure(configuration);
    camera.start();
    const Frame frame = camera.capture();
    ASSERT_TRUE(frame.is_complete()) << frame.what;
    ASSERT_EQ(frame.codes.width(), kTwinWidth / binning);
    ASSERT_EQ(frame.codes.height(), kTwinHeight / binning);
    const auto whole = test_pattern(kTwinWidth, kTwinHeight, 8, number);
    const int mean = (whole(10, 20) + whole(11, 20) + whole(10, 21) + whole(11, 21)) / 4;
    EXPECT_EQ(frame.codes(10 / binning, 20 / binning), binning == 2 ? mean : whole(10, 20));
    camera.stop();
  }
  configuration.features = {{"BinningHorizontal", "5"}};
  EXPECT_THROW(camera.configure(configuration), ConfigError);
}

TEST(CameraTwin, TellsWhatItIs) {
  const std::uint32_t address = test_address(3);
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  const CameraDescription& description = camera.description();
  EXPECT_EQ(description.id, "Glint-TWIN01");
  EXPECT_EQ(description.address, ipv4_text(address));
  EXPECT_EQ(description.sensor_width_px, kTwinWidth);
  EXPECT_EQ(description.sensor_height_px, kTwinHeight);
  EXPECT_TRUE(description.is_gain_in_db);
  EXPECT_EQ(description.max_gain, 24.0);
  EXPECT_EQ(description.min_exposure_us, 10.0);
  EXPECT_TRUE(description.has_software_trigger);
  camera.configure({.exposure_us = 2500.5,
                    .gain_db = 6.25,
                    .packet_size = 4000,
                    .features = {{"BlackLevel", "12.5"}}});
  EXPECT_EQ(camera.description().packet_size, 4000);
  camera.start();
  const auto before = std::chrono::system_clock::now();
  const Frame frame = camera.capture();
  const auto after = std::chrono::system_clock::now();
  ASSERT_TRUE(frame.is_complete()) << frame.what;
  EXPECT_GE(frame.host_time, before);
  EXPECT_LE(frame.host_time, after);
  EXPECT_EQ(frame.exposure_us, 2500.5);
  EXPECT_EQ(frame.gain, 6.25);
  EXPECT_GT(frame.camera_time_ns, 0U);
}

std::string configure_refusal(Camera& camera, const CameraConfiguration& configuration) {
  return text_thrown_by<ConfigError>([&] { camera.configure(configuration); });
}

TEST(CameraTwin, RefusesWhatIsOutOfRange) {
  const std::uint32_t address = test_address(4);
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  EXPECT_THROW(camera.configure({.exposure_us = 5.0}), ConfigError);
  EXPECT_THROW(camera.configure({.gain_db = 25.0}), ConfigError);
  EXPECT_THROW(camera.configure({.features = {{"BlackLevel", "-1"}}}), ConfigError);
  EXPECT_THROW(camera.configure({.features = {{"SensorWidth", "100"}}}), ConfigError)
      << "nobody may set it";
  EXPECT_THAT(configure_refusal(camera, {.packet_size = 70000}),
              testing::HasSubstr("packet_bytes: "));
  camera.configure({.exposure_us = 10.0});
}

TEST(CameraTwin, IsFoundByItsAddressAndOpenedByItsId) {
  const std::uint32_t address = free_camera_address();
  const TwinProcess process(address);
  const std::vector<FoundCamera> cameras = find_cameras_at({}, 500);
  const auto found = std::ranges::find(cameras, ipv4_text(address), &FoundCamera::address);
  ASSERT_NE(found, cameras.end());
  EXPECT_EQ(found->id, "Glint-TWIN01");
  EXPECT_EQ(found->model, "CameraTwin");
  AravisCamera camera(found->id);
  EXPECT_EQ(camera.description().address, found->address);
  camera.configure(configuration_of(PixelFormat::kMono8));
  camera.start();
  EXPECT_TRUE(camera.capture().is_complete());
}

TEST(CameraTwin, TakesTextsWithBlanksAndQuotes) {
  const std::uint32_t address = free_camera_address();
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  for (const std::string text : {"left of line", "Gain=3 it's"}) {
    camera.configure({.gain_db = 6.0, .features = {{"DeviceUserID", text}}});
    const std::vector<FoundCamera> cameras = find_cameras_at({}, 500);
    const auto found = std::ranges::find(cameras, ipv4_text(address), &FoundCamera::address);
    ASSERT_NE(found, cameras.end());
    EXPECT_EQ(found->user_name, text);
  }
  camera.start();
  EXPECT_EQ(camera.capture().gain, 6.0);
}

// Twins on free addresses take no other than are looked at.
TEST(CameraTwin, IsFoundAtTheLastOfTheAddressesToo) {
  const std::uint32_t address = kFirstLoopback + kLoopbackAddresses - 1;
  const TwinProcess process(address);
  const std::vector<FoundCamera> cameras = find_cameras_at({}, 500);
  const auto found = std::ranges::find(cameras, ipv4_text(address), &FoundCamera::address);
  EXPECT_NE(found, cameras.end());
}

TEST(CameraTwin, ListensOnThisMachineAlone) {
  const std::uint32_t address = test_address(5);
  const TwinProcess process(address);
  AravisCamera camera(ipv4_text(address));
  camera.configure(configuration_of(PixelFormat::kMono8));
  camera.start();
  EXPECT_TRUE(camera.capture().is_complete());
  const std::vector<ProcessSocket> sockets = sockets_of(process.id());
  EXPECT_THAT(sockets, SizeIs(2));
  for (const ProcessSocket& socket : sockets) {
    EXPECT_TRUE(socket.is_on_loopback()) << socket.text();
  }
  TestPatternSource source(64, 48);
  EXPECT_THROW(CameraTwin({.address = 0xc0a80001}, source), ConfigError);
}

TEST(CameraTwin, GivesControlToOneClientAndTakesItBackFromASilentOne) {
  const std::uint32_t address = test_address(6);
  const TwinProcess process(address);
  auto first = std::make_unique<AravisCamera>(ipv4_text(address));
  EXPECT_THROW(open_aravis_driver(ipv4_text(address)), IoError);
  first->close();
  EXPECT_NO_THROW(open_aravis_driver(ipv4_text(address)));
}

/// A source whose picture is finished when a test says so.
class HesitantSource final : public PictureSource {
 public:
  void prepare(const CaptureSettings&) override { ++prepared; }

  SensorPicture finished(const CaptureSettings&, std::uint64_t) override {
    return is_ready ? std::make_shared<const Image<std::uint16_t>>(64, 48, std::uint16_t{9})
                    : nullptr;
  }

  bool is_finished(const CaptureSettings&) override { return is_ready; }

  std::atomic<bool> is_ready = true;
  std::atomic<int> prepared = 0;
};

TEST(CameraTwin, RefusesATriggerWithoutAFinishedPictureByName) {
  HesitantSource source;
  const CameraTwin twin({.address = test_address(7), .sensor_width_px = 64, .sensor_height_px = 48},
                        source);
  AravisCamera camera(ipv4_text(test_address(7)));
  camera.configure({.exposure_us = 1000.0});
  camera.start();
  EXPECT_TRUE(camera.capture().is_complete());
  source.is_ready = false;
  const Frame refused = camera.capture();
  EXPECT_EQ(refused.status, FrameStatus::kRefused);
  EXPECT_THAT(refused.what, HasSubstr("refuses the trigger"));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(twin.counts().last_refusal, TwinRefusal::kNoFinishedPicture);
  EXPECT_EQ(name_of(twin.counts().last_refusal), "trigger_without_picture");
  source.is_ready = true;
  EXPECT_TRUE(camera.capture().is_complete());
}

// The picture takes 1.5 s, more than the client waits for an ordinary answer.
TEST(CameraTwin, AnswersAStartWhenThePictureIsThere) {
  HesitantSource source;
  source.is_ready = false;
  const CameraTwin twin({.address = test_address(8), .sensor_width_px = 64, .sensor_height_px = 48},
                        source);
  AravisCamera camera(ipv4_text(test_address(8)));
  camera.configure({.exposure_us = 1000.0});
  std::jthread rendering([&] {
    std::this_thread::sleep_for(milliseconds(1500));
    source.is_ready = true;
  });
  camera.start();
  EXPECT_TRUE(source.is_ready);
  EXPECT_TRUE(camera.capture().is_complete());
  EXPECT_EQ(twin.counts().refused, 0U);
}

}  // namespace
}  // namespace glint
