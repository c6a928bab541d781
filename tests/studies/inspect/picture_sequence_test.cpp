// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/picture_sequence.h"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/image/image_io.h"
#include "core/rng.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {
namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::HasSubstr;

ImageF even_picture(float grey, int width_px = 12, int height_px = 8) {
  return {width_px, height_px, grey};
}

std::string refusal(const std::vector<fs::path>& files) {
  ThreadPool pool(2);
  return text_thrown_by<ConfigError>([&] { read_sequence(files, pool); });
}

TEST(NaturalLess, CountsAsPeopleDo) {
  EXPECT_TRUE(natural_less("frame_2.png", "frame_10.png"));
  EXPECT_FALSE(natural_less("frame_10.png", "frame_2.png"));
  EXPECT_TRUE(natural_less("frame_002.png", "frame_10.png"));
  EXPECT_TRUE(natural_less("a9b3", "a9b12"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("part2/frame_9", "part10/frame_1"));
  EXPECT_FALSE(natural_less("same", "same"));
  // Numbers of any length: 2^70 and one more.
  EXPECT_TRUE(natural_less("f1180591620717411303424", "f1180591620717411303425"));
}

// A strict order of all texts: of two different ones exactly one comes first, and three never go
// round in a circle.
TEST(NaturalLess, OrdersRandomNames) {
  Rng rng(3, Stream::kTest, 0);
  const auto name = [&] {
    std::string text;
    for (auto left = 1 + rng.next_u32() % 6; left > 0; --left) {
      text += "0012a_"[rng.next_u32() % 6];
    }
    return text;
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string a = name();
    const std::string b = name();
    const std::string c = name();
    ASSERT_EQ(natural_less(a, b) + natural_less(b, a), a == b ? 0 : 1) << a << " " << b;
    if (natural_less(a, b) && natural_less(b, c)) {
      ASSERT_TRUE(natural_less(a, c)) << a << " " << b << " " << c;
    }
  }
}

TEST(PicturesIn, TakesPicturesInNaturalOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"f10.PNG", "f9.png", "notes.txt", ".hidden.png", "f2.tif"}) {
    write_file(folder / name, "x");
  }
  fs::create_directories(folder / "folder.png");
  EXPECT_THAT(pictures_in(folder.path()),
              ElementsAre(folder / "f2.tif", folder / "f9.png", folder / "f10.PNG"));
}

TEST(PicturesIn, SaysWhenThereIsNone) {
  const TemporaryFolder folder;
  write_file(folder / "notes.txt", "x");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { pictures_in(folder.path()); }),
              HasSubstr(folder.path().string() + ": holds no picture; looked for files that end"));
  EXPECT_THROW(pictures_in(folder / "missing"), IoError);
}

// 51/255 and 153/255 have the mean 102/255 = 0.4.
TEST(ReadSequence, SortsAndKeepsTheCodesOf8Bits) {
  const TemporaryFolder folder;
  ThreadPool pool(2);
  write_png(folder / "f2.png", even_picture(0.2F), PixelDepth::k8Bit);
  write_png(folder / "f10.png", even_picture(0.6F), PixelDepth::k8Bit);
  const PictureSequence sequence = read_sequence({folder / "f10.png", folder / "f2.png"}, pool);
  EXPECT_THAT(sequence.files, ElementsAre(folder / "f2.png", folder / "f10.png"));
  EXPECT_THAT(sequence.notes, ElementsAre(HasSubstr("not in the order given")));
  const auto& frames = std::get<std::vector<Image<std::uint8_t>>>(sequence.frames);
  EXPECT_EQ(frames[0](3, 3), 51);
  EXPECT_EQ(frames[1](3, 3), 153);
  EXPECT_EQ(sequence.width(), 12);
  EXPECT_EQ(sequence.height(), 8);
  EXPECT_NEAR(aspect_of(sequence, pool)(3, 3), 0.4F, 1e-6F);
  EXPECT_TRUE(read_sequence({folder / "f2.png", folder / "f10.png"}, pool).notes.empty());
}

TEST(ReadSequence, KeepsTheCodesOf16Bits) {
  const TemporaryFolder folder;
  ThreadPool pool(2);
  write_png(folder / "a.png", even_picture(0.25F), PixelDepth::k16Bit);
  const PictureSequence sequence = read_sequence({folder / "a.png"}, pool);
  EXPECT_EQ(sequence.bits, 16);
  // 0.25 * 65535 = 16383.75
  EXPECT_EQ(std::get<std::vector<Image<std::uint16_t>>>(sequence.frames)[0](0, 0), 16384);
  EXPECT_TRUE(sequence.notes.empty());
}

TEST(ReadSequence, TellsThat12BitsStandIn16) {
  const TemporaryFolder folder;
  ThreadPool pool(2);
  write_png(folder / "a.png", even_picture(4095.0F / 65535.0F), PixelDepth::k16Bit);
  EXPECT_THAT(read_sequence({folder / "a.png"}, pool).notes, ElementsAre(HasSubstr("12 of 16")));
}

TEST(ReadSequence, BringsMixedDepthsToOneScale) {
  const TemporaryFolder folder;
  ThreadPool pool(2);
  write_png(folder / "a.png", even_picture(0.2F), PixelDepth::k8Bit);
  write_png(folder / "b.png", even_picture(0.4F), PixelDepth::k16Bit);
  const PictureSequence sequence = read_sequence({folder / "a.png", folder / "b.png"}, pool);
  EXPECT_NEAR(aspect_of(sequence, pool)(1, 1), 0.3F, 1e-5F);
  EXPECT_THAT(sequence.notes, ElementsAre(HasSubstr("differ in depth")));
}

// 0.2126 * 51 + 0.7152 * 102 + 0.0722 * 204 = 98.52; over 255: 0.38636.
TEST(ReadSequence, TakesTheLuminanceOfColours) {
  const TemporaryFolder folder;
  ThreadPool pool(2);
  write_file(folder / "a.png", png_bytes(ImageRgb(5, 4, {51, 102, 204})));
  const PictureSequence sequence = read_sequence({folder / "a.png"}, pool);
  EXPECT_EQ(sequence.channels, 3);
  EXPECT_NEAR(aspect_of(sequence, pool)(2, 2), 0.38636F, 1e-5F);
  EXPECT_THAT(sequence.notes, ElementsAre(HasSubstr("luminance")));
}

TEST(ReadSequence, RefusesNothing) {
  EXPECT_THAT(refusal({}), HasSubstr("no picture is given"));
}

TEST(ReadSequence, RefusesPicturesOfDifferentSize) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", even_picture(0.5F), PixelDepth::k8Bit);
  write_png(folder / "b.png", even_picture(0.5F, 13), PixelDepth::k8Bit);
  EXPECT_THAT(refusal({folder / "a.png", folder / "b.png"}),
              HasSubstr((folder / "b.png").string() + ": is 13 x 8 pixels, but " +
                        (folder / "a.png").string() + " is 12 x 8"));
}

TEST(ReadSequence, RefusesWhatIsNoNumber) {
  const TemporaryFolder folder;
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    ImageF picture = even_picture(0.5F);
    picture(7, 3) = bad;
    write_exr(folder / "a.exr", picture);
    EXPECT_EQ(refusal({folder / "a.exr"}),
              (folder / "a.exr").string() + ": the value of pixel (7, 3) is no finite number");
  }
}

TEST(ReadSequence, RefusesBlackAndSaturatedPictures) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", even_picture(0.0F), PixelDepth::k8Bit);
  write_png(folder / "b.png", even_picture(1.0F), PixelDepth::k16Bit);
  EXPECT_THAT(refusal({folder / "a.png"}), HasSubstr("a.png: black all over"));
  EXPECT_THAT(refusal({folder / "b.png"}), HasSubstr("b.png: at full scale all over"));
  write_exr(folder / "c.exr", even_picture(-1.0F));
  EXPECT_THAT(refusal({folder / "c.exr"}), HasSubstr("c.exr: black all over"));
  // One black frame among others is a dark stripe.
  write_png(folder / "d.png", even_picture(0.5F), PixelDepth::k8Bit);
  EXPECT_EQ(refusal({folder / "a.png", folder / "d.png"}), "nothing thrown");
}

TEST(ReadSequence, RefusesAFileGivenTwice) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", even_picture(0.5F), PixelDepth::k8Bit);
  EXPECT_EQ(refusal({folder / "a.png", folder / "a.png"}),
            (folder / "a.png").string() + ": is given twice");
}

TEST(ReadMask, IsInsideFromHalfOfItsLargestValue) {
  const TemporaryFolder folder;
  ImageF picture(4, 1);
  picture.values() = {0.0F, 0.1F, 0.3F, 0.5F};
  write_png(folder / "m.png", picture, PixelDepth::k8Bit);
  EXPECT_THAT(read_mask(folder / "m.png").values(), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(read_mask(folder / "m.png", 4, 1).values(), ElementsAre(0, 0, 1, 1));
}

TEST(ReadMask, RefusesAnEmptyMaskAndAnotherSize) {
  const TemporaryFolder folder;
  write_png(folder / "empty.png", even_picture(0.0F), PixelDepth::k8Bit);
  write_png(folder / "mask.png", even_picture(1.0F), PixelDepth::k8Bit);
  EXPECT_EQ(text_thrown_by<ConfigError>([&] { read_mask(folder / "empty.png"); }),
            (folder / "empty.png").string() + ": the mask is empty: no pixel is above 0");
  EXPECT_EQ(
      text_thrown_by<ConfigError>([&] { read_mask(folder / "mask.png", 20, 8); }),
      (folder / "mask.png").string() + ": the mask is 12 x 8 pixels, the pictures are 20 x 8");
  EXPECT_THROW(read_mask(folder / "none.png"), IoError);
}

}  // namespace
}  // namespace glint
