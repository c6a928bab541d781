// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board_files.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "tests/hardware/board/board_scene.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

const Board kFiledBoard = {.cols = 5, .rows = 4, .square_mm = 6.6};

/// A board that fills a picture of 240 x 200 pixels.
Image<std::uint8_t> filed_photograph() {
  BoardScene scene = {.board = kFiledBoard};
  scene.camera = {
      .width_px = 240, .height_px = 200, .focal_px = {600.0, 600.0}, .center_px = {120.0, 100.0}};
  Rng rng(3, Stream::kTest, 0);
  scene.camera_from_board = random_pose(kFiledBoard, 150.0, 0.2, 0.2, 2.0, rng);
  return photographed(scene, rng);
}

/// As a camera of so many bits would have put it into the lower end of 16.
void write_codes(const fs::path& file, const Image<std::uint8_t>& picture, int bits) {
  ImageF values(picture.width(), picture.height());
  std::ranges::transform(picture.values(), values.values().begin(), [&](std::uint8_t code) {
    const double largest = std::ldexp(1.0, bits) - 1.0;
    return static_cast<float>(std::round(code / 255.0 * largest) / 65535.0);
  });
  write_png(file, values, PixelDepth::k16Bit);
}

BoardsInFiles found_in(const std::vector<fs::path>& files) {
  ThreadPool pool(1);
  return find_boards(files, kFiledBoard, pool, [](std::size_t, const Picture&) {});
}

TEST(BoardFiles, CodesOfTenBitsAreNotDark) {
  const TemporaryFolder folder;
  const Image<std::uint8_t> photograph = filed_photograph();
  write_codes(folder / "ten.png", photograph, 10);
  write_codes(folder / "all.png", photograph, 16);
  const BoardsInFiles all = found_in({folder / "all.png"});
  ASSERT_TRUE(all.views[0].is_accepted()) << all.views[0].why;
  EXPECT_EQ(all.code_bits, 0);
  const BoardsInFiles ten = found_in({folder / "ten.png"});
  ASSERT_TRUE(ten.views[0].is_accepted()) << ten.views[0].why;
  EXPECT_EQ(ten.code_bits, 10);
  EXPECT_LE(ten.largest_code, 1023);
  EXPECT_NEAR(ten.views[0].contrast, all.views[0].contrast, 2e-3);
  ASSERT_EQ(ten.views[0].picture_px.size(), all.views[0].picture_px.size());
  for (std::size_t i = 0; i < ten.views[0].picture_px.size(); ++i) {
    EXPECT_LT((ten.views[0].picture_px[i] - all.views[0].picture_px[i]).norm(), 0.01) << i;
  }
  // Beside one of 16 bits it is a dark picture.
  const BoardsInFiles both = found_in({folder / "all.png", folder / "ten.png"});
  EXPECT_EQ(both.code_bits, 0);
  EXPECT_EQ(both.views[1].outcome, BoardOutcome::kDark);
}

TEST(BoardFiles, ClippedCodesOfTwelveBitsAreSaturated) {
  const TemporaryFolder folder;
  write_codes(folder / "clipped.png", Image<std::uint8_t>(80, 60, 255), 12);
  const BoardsInFiles clipped = found_in({folder / "clipped.png"});
  EXPECT_EQ(clipped.code_bits, 12);
  EXPECT_EQ(clipped.largest_code, 4095);
  EXPECT_EQ(clipped.views[0].outcome, BoardOutcome::kSaturated) << clipped.views[0].why;
}

TEST(BoardFiles, OfOtherSizesAreNamed) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", ImageF(80, 60, 0.5F), PixelDepth::k8Bit);
  write_png(folder / "b.png", ImageF(60, 80, 0.5F), PixelDepth::k8Bit);
  EXPECT_THAT(
      [&] {
        found_in({folder / "a.png", folder / "b.png"});
      },
      testing::ThrowsMessage<ConfigError>(testing::HasSubstr("b.png: has 60 x 80 pixels")));
}

}  // namespace
}  // namespace glint
