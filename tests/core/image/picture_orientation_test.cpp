// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/picture_orientation.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "tests/support/oriented_tiff.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

// Codes stay where the file has them, whatever it says.
TEST(PictureOrientation, IsWhatTheFileSays) {
  const TemporaryFolder folder;
  Image<std::uint8_t> codes(3, 2);
  codes(2, 0) = 200;
  for (const int orientation : {1, 3, 6, 8}) {
    const auto file = folder / "oriented.tif";
    write_file(file, test::oriented_tiff(codes, static_cast<std::uint32_t>(orientation)));
    EXPECT_EQ(picture_orientation(file), orientation);
    const Picture picture = read_picture(file);
    ASSERT_EQ(picture.width(), 3);
    EXPECT_EQ(std::get<Image<std::uint8_t>>(picture.pixels)(2, 0), 200);
  }
}

TEST(PictureOrientation, IsThatOfTheStoredPictureWhereTheFileSaysNothing) {
  const TemporaryFolder folder;
  write_png(folder / "plain.png", ImageF(3, 2, 0.5F), PixelDepth::k8Bit);
  EXPECT_EQ(picture_orientation(folder / "plain.png"), 1);
  write_file(folder / "none.png", "no picture");
  EXPECT_THROW(picture_orientation(folder / "none.png"), ConfigError);
}

}  // namespace
}  // namespace glint
