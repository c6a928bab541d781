// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/exr_layers.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/exr_reader.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using test::channels_of;

/// Different in every pixel; more rows than are written at a time.
ImageF ramp(float factor) {
  ImageF image(7, 150);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] = factor * static_cast<float>(i) - 3.0F;
  }
  return image;
}

TEST(ExrChannels, ComeBackByNameBitForBit) {
  const TemporaryFolder folder;
  const ImageF first = ramp(0.1F);
  const ImageF second = ramp(-7e5F);
  const std::vector<ExrChannel> channels = {exr_channel("ring.3.R", first),
                                            exr_channel("Y", second),
                                            {.name = "row", .fill = [](int y, float* row) {
                                               for (int x = 0; x < 7; ++x) {
                                                 row[x] = static_cast<float>(100 * y + x);
                                               }
                                             }}};
  write_exr_channels(folder / "a.exr", 7, 150, channels);
  const auto read = channels_of(folder / "a.exr");
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read.at("ring.3.R"), first);
  EXPECT_EQ(read.at("Y"), second);
  EXPECT_EQ(read.at("row")(6, 149), 14906.0F);
  write_exr_channels(folder / "b.exr", 7, 150, channels);
  EXPECT_EQ(read_file(folder / "a.exr"), read_file(folder / "b.exr"));
  EXPECT_EQ(folder.count(), 2) << "no temporary file is left";
}

// In another order than in the file, with others between them; more rows than are read at a time.
TEST(ExrChannels, AreReadInAnyOrder) {
  const TemporaryFolder folder;
  std::vector<ImageF> images;
  std::vector<ExrChannel> channels;
  for (int c = 0; c < 5; ++c) {
    images.emplace_back(3, 700);
    for (std::size_t i = 0; i < images.back().size(); ++i) {
      images.back().values()[i] = static_cast<float>(10 * i) + static_cast<float>(c);
    }
  }
  for (std::size_t c = 0; c < images.size(); ++c) {
    channels.push_back(exr_channel("layer." + std::to_string(c), images[c]));
  }
  write_exr_channels(folder / "a.exr", 3, 700, channels);
  const std::vector<std::string> names = {"layer.4", "layer.1", "layer.1"};
  const std::vector<ImageF> read = read_exr_channels(folder / "a.exr", names);
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[0], images[4]);
  EXPECT_EQ(read[1], images[1]);
  EXPECT_EQ(read[2], images[1]);
  EXPECT_TRUE(read_exr_channels(folder / "a.exr", {}).empty());
  const std::vector<std::string> wrong = {"layer.1", "layer.5"};
  EXPECT_THROW(read_exr_channels(folder / "a.exr", wrong), ConfigError);
}

/// Bytes that this program has read so far, of whatever file; 0 where the system does not tell.
std::size_t bytes_read() {
  std::ifstream counters("/proc/self/io");
  std::string name;
  std::size_t bytes = 0;
  return counters >> name >> bytes && name == "rchar:" ? bytes : 0;
}

// Noise that hardly packs: 7 channels of 10 cost one pass over the file, not seven.
TEST(ExrChannels, AreReadInOnePass) {
  if (bytes_read() == 0) {
    GTEST_SKIP() << "the system does not count what is read";
  }
  const TemporaryFolder folder;
  ImageF noise(300, 400);
  std::uint32_t state = 1;
  for (float& value : noise.values()) {
    state = 1664525U * state + 1013904223U;
    value = static_cast<float>(state);
  }
  std::vector<ExrChannel> channels;
  std::vector<std::string> names;
  for (int c = 0; c < 10; ++c) {
    channels.push_back(exr_channel("c" + std::to_string(c), noise));
    names.push_back(channels.back().name);
  }
  names.resize(7);
  write_exr_channels(folder / "a.exr", 300, 400, channels);
  const auto size = std::filesystem::file_size(folder / "a.exr");
  ASSERT_GT(size, 300'000U);
  const std::size_t before = bytes_read();
  EXPECT_EQ(read_exr_channels(folder / "a.exr", names).back(), noise);
  EXPECT_LT(bytes_read() - before, size * 3 / 2);
}

TEST(ExrChannels, OfOneNameAreOurMistake) {
  const TemporaryFolder folder;
  const ImageF image(2, 2);
  const std::vector<ExrChannel> channels = {exr_channel("R", image), exr_channel("R", image)};
  EXPECT_DEATH(write_exr_channels(folder / "a.exr", 2, 2, channels), "channels have own names");
}

TEST(ExrChannels, TellWhereTheyCannotBeWritten) {
  const ImageF image(2, 2);
  const ExrChannel channel = exr_channel("R", image);
  EXPECT_THROW(write_exr_channels("/nowhere/a.exr", 2, 2, {&channel, 1}), IoError);
  EXPECT_THROW(write_tiff("/nowhere/a.tif", {&image, 1}), IoError);
}

TEST(Tiff, HoldsClampedCodesOfSixteenBits) {
  const TemporaryFolder folder;
  std::vector<ImageF> channels(3, ImageF(2, 1));
  channels[0].values() = {0.5F, 2.0F};
  channels[1].values() = {-1.0F, std::numeric_limits<float>::quiet_NaN()};
  channels[2].values() = {1.0F / 65535.0F, 0.25F};
  write_tiff(folder / "a.tif", channels);
  const auto read = channels_of(folder / "a.tif");
  ASSERT_EQ(read.size(), 3U);
  // 0.5 * 65535 = 32767.5 is rounded up; 0.25 * 65535 = 16383.75.
  EXPECT_FLOAT_EQ(read.at("R")(0, 0), 32768.0F / 65535.0F);
  EXPECT_EQ(read.at("R")(1, 0), 1.0F);
  EXPECT_EQ(read.at("G")(0, 0), 0.0F);
  EXPECT_EQ(read.at("G")(1, 0), 0.0F);
  EXPECT_FLOAT_EQ(read.at("B")(0, 0), 1.0F / 65535.0F);
  EXPECT_FLOAT_EQ(read.at("B")(1, 0), 16384.0F / 65535.0F);
  write_tiff(folder / "b.tif", channels);
  EXPECT_EQ(read_file(folder / "a.tif"), read_file(folder / "b.tif"));
}

TEST(RgbOf, TakesOneImageAsGrey) {
  std::vector<ImageF> grey(1, ImageF(1, 1, 0.2F));
  EXPECT_EQ(rgb_of(grey)(0, 0), (std::array<std::uint8_t, 3>{51, 51, 51}));
}

}  // namespace
}  // namespace glint
