// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/image_io.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/rng.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Random values, a few of them outside [0, 1].
ImageF random_image(int width_px, int height_px) {
  ImageF image(width_px, height_px);
  Rng rng(21, Stream::kTest, 0);
  for (float& value : image.values()) {
    value = static_cast<float>(rng.uniform(-0.1, 1.1));
  }
  return image;
}

float clamped(float value) {
  return std::min(std::max(value, 0.0F), 1.0F);
}

TEST(Image, IsRowMajor) {
  Image<int> image(3, 2);
  image(2, 0) = 5;
  image(0, 1) = 7;
  EXPECT_THAT(image.values(), ElementsAre(0, 0, 5, 7, 0, 0));
  EXPECT_EQ(image.row(1), &image(0, 1));
  EXPECT_EQ(image.size(), 6U);
  EXPECT_TRUE(Image<int>().empty());
}

TEST(WritePng, ComesBackToHalfACodeIn8Bit) {
  const TemporaryFolder folder;
  const ImageF image = random_image(61, 37);
  write_png(folder / "a.png", image, PixelDepth::k8Bit);
  const ImageF read = read_image(folder / "a.png");
  ASSERT_EQ(read.width(), 61);
  ASSERT_EQ(read.height(), 37);
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_NEAR(read.values()[i], clamped(image.values()[i]), 0.5 / 255 + 1e-6);
  }
  EXPECT_EQ(folder.count(), 1);
}

TEST(WritePng, ComesBackToHalfACodeIn16Bit) {
  const TemporaryFolder folder;
  const ImageF image = random_image(61, 37);
  write_png(folder / "a.png", image, PixelDepth::k16Bit);
  const ImageF read = read_image(folder / "a.png");
  for (std::size_t i = 0; i < image.size(); ++i) {
    ASSERT_NEAR(read.values()[i], clamped(image.values()[i]), 0.5 / 65535 + 1e-7);
  }
}

// 0.5 * 255 = 127.5 rounds to 128; 128 / 255 = 0.50196. NaN, which no camera records, is black.
TEST(WritePng, RoundsAndClampsHandWorkedValues) {
  const TemporaryFolder folder;
  ImageF image(4, 1);
  image.values() = {-3.0F, 0.5F, 7.0F, std::numeric_limits<float>::quiet_NaN()};
  write_png(folder / "a.png", image, PixelDepth::k8Bit);
  const ImageF read = read_image(folder / "a.png");
  EXPECT_THAT(read.values(), ElementsAre(0.0F, 128.0F / 255.0F, 1.0F, 0.0F));
}

TEST(WriteMaskPng, WritesBlackAndWhite) {
  const TemporaryFolder folder;
  Mask mask(2, 2);
  mask(1, 0) = 1;
  mask(0, 1) = 1;
  write_mask_png(folder / "m.png", mask);
  EXPECT_THAT(read_image(folder / "m.png").values(), ElementsAre(0.0F, 1.0F, 1.0F, 0.0F));
}

TEST(WriteExr, ComesBackExactly) {
  const TemporaryFolder folder;
  ImageF image = random_image(61, 37);
  image(0, 0) = 1e-30F;
  image(1, 0) = 12345.678F;
  write_exr(folder / "a.exr", image);
  EXPECT_EQ(read_image(folder / "a.exr"), image);
}

TEST(WriteImage, GivesTheSameBytesTwice) {
  const TemporaryFolder folder;
  const ImageF image = random_image(61, 37);
  for (const std::string name : {"1", "2"}) {
    write_png(folder / (name + ".png"), image, PixelDepth::k8Bit);
    write_png(folder / (name + "_16.png"), image, PixelDepth::k16Bit);
    write_exr(folder / (name + ".exr"), image);
  }
  for (const std::string suffix : {".png", "_16.png", ".exr"}) {
    EXPECT_EQ(read_file(folder / ("1" + suffix)), read_file(folder / ("2" + suffix))) << suffix;
  }
}

// No stamp of the present: whatever date stands in the file is the fixed one.
TEST(WriteExr, CarriesAFixedDate) {
  const TemporaryFolder folder;
  write_exr(folder / "a.exr", random_image(5, 5));
  const std::string bytes = read_file(folder / "a.exr");
  const auto date = bytes.find("capDate");
  ASSERT_NE(date, std::string::npos);
  EXPECT_THAT(bytes.substr(date, 60), HasSubstr("2000:01:01 00:00:00"));
}

TEST(WriteImage, SaysWhenItCannotBeWrittenAndLeavesNothing) {
  const TemporaryFolder folder;
  const ImageF image = random_image(5, 5);
  EXPECT_THAT(text_thrown_by<IoError>(
                  [&] { write_png(folder / "missing" / "a.png", image, PixelDepth::k8Bit); }),
              HasSubstr("missing/a.png: cannot be written: "));
  EXPECT_THROW(write_exr(folder / "missing" / "a.exr", image), IoError);
  EXPECT_THROW(write_mask_png(folder / "missing" / "a.png", Mask(2, 2)), IoError);
  EXPECT_THROW(write_png(folder / "a.png", ImageF(), PixelDepth::k8Bit), IoError);
  EXPECT_EQ(folder.count(), 0);
}

TEST(WriteImage, SaysWhenTheDiskIsFullAndLeavesNothing) {
  const TemporaryFolder folder;
  const ImageF image = random_image(200, 200);
  fill_disk_under(folder / "a.png");
  EXPECT_THROW(write_png(folder / "a.png", image, PixelDepth::k16Bit), IoError);
  fill_disk_under(folder / "a.exr");
  EXPECT_THROW(write_exr(folder / "a.exr", image), IoError);
  EXPECT_EQ(folder.count(), 0);
}

TEST(ReadImage, SaysWhatCannotBeRead) {
  const TemporaryFolder folder;
  write_file(folder / "garbage.png", "this is no picture at all");
  write_file(folder / "empty.exr", "");
  EXPECT_THAT(text_thrown_by<IoError>([&] { read_image(folder / "garbage.png"); }),
              HasSubstr("garbage.png: cannot be read as a picture: "));
  EXPECT_THROW(read_image(folder / "empty.exr"), IoError);
  EXPECT_THROW(read_image(folder / "none.png"), IoError);
  EXPECT_THROW(read_image(folder.path()), IoError);
}

TEST(ReadImage, SaysWhenAnExrIsCutShort) {
  const TemporaryFolder folder;
  write_exr(folder / "whole.exr", random_image(200, 200));
  const std::string bytes = read_file(folder / "whole.exr");
  write_file(folder / "cut.exr", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(read_image(folder / "cut.exr"), IoError);
}

#ifndef __SANITIZE_ADDRESS__  // OpenImageIO's PNG reader leaks its message when it fails
TEST(ReadImage, SaysWhenAPngIsCutShort) {
  const TemporaryFolder folder;
  const std::string bytes = png_bytes(random_image(200, 200));
  write_file(folder / "cut.png", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(read_image(folder / "cut.png"), IoError);
}
#endif

TEST(ReadPicture, KeepsCodesAndDepth) {
  const TemporaryFolder folder;
  ImageF image(2, 1);
  image.values() = {0.2F, 1.0F};
  write_png(folder / "8.png", image, PixelDepth::k8Bit);
  write_png(folder / "16.png", image, PixelDepth::k16Bit);
  write_exr(folder / "f.exr", image);
  const Picture small = read_picture(folder / "8.png");
  EXPECT_THAT(std::get<Image<std::uint8_t>>(small.pixels).values(), ElementsAre(51, 255));
  EXPECT_EQ(small.bits, 8);
  EXPECT_EQ(small.channels, 1);
  EXPECT_FALSE(small.is_float);
  EXPECT_FALSE(small.has_more);
  const Picture deep = read_picture(folder / "16.png");
  EXPECT_THAT(std::get<Image<std::uint16_t>>(deep.pixels).values(), ElementsAre(13107, 65535));
  EXPECT_EQ(deep.bits, 16);
  const Picture real = read_picture(folder / "f.exr");
  EXPECT_EQ(std::get<ImageF>(real.pixels), image);
  EXPECT_TRUE(real.is_float);
  for (const Picture* picture : {&small, &deep, &real}) {
    EXPECT_EQ(picture->width(), 2);
    EXPECT_EQ(picture->height(), 1);
    EXPECT_THAT(linear_values(picture->pixels).values(), ElementsAre(0.2F, 1.0F));
  }
}

// The format is told by the first bytes: names may be wrong. PNM: 51/255 = 0.2; of three colours
// (0.2126 * 51 + 0.7152 * 102 + 0.0722 * 204) / 255 = 0.38636.
TEST(ReadPicture, ReadsPnmUnderAnyName) {
  const TemporaryFolder folder;
  write_file(folder / "grey.png", std::string("P5\n2 1\n255\n\x33\xff", 13));
  EXPECT_THAT(linear_values(read_picture(folder / "grey.png").pixels).values(),
              ElementsAre(0.2F, 1.0F));
  write_file(folder / "colour", std::string("P6\n1 1\n255\n\x33\x66\xcc", 14));
  const Picture colour = read_picture(folder / "colour");
  EXPECT_EQ(colour.channels, 3);
  EXPECT_NEAR(std::get<ImageF>(colour.pixels)(0, 0), 0.38636F, 1e-5F);
}

TEST(ReadPicture, SaysWhatIsNoPicture) {
  const TemporaryFolder folder;
  write_file(folder / "text.png", "this is no picture at all");
  write_file(folder / "empty.png", "");
  for (const char* name : {"text.png", "empty.png"}) {
    EXPECT_EQ(
        text_thrown_by<ConfigError>([&] { read_picture(folder / name); }),
        (folder / name).string() + ": is no picture; allowed are PNG, JPEG, TIFF, PNM and OpenEXR");
  }
  EXPECT_THAT(text_thrown_by<IoError>([&] { read_picture(folder / "none.png"); }),
              HasSubstr("none.png: the picture cannot be read: No such file"));
  EXPECT_THAT(text_thrown_by<IoError>([&] { read_picture(folder.path()); }),
              HasSubstr("is a folder"));
}

#ifndef __SANITIZE_ADDRESS__  // OpenImageIO's PNG reader leaks its message when it fails
TEST(ReadPicture, SaysWhenAFileIsCutShort) {
  const TemporaryFolder folder;
  const ImageF image = random_image(120, 90);
  write_png(folder / "a.png", image, PixelDepth::k8Bit);
  write_exr(folder / "a.exr", image);
  write_file(folder / "a.pgm", "P5\n120 90\n255\n" + std::string(120 * 90, 'x'));
  for (const char* name : {"a.png", "a.exr", "a.pgm"}) {
    const std::string bytes = read_file(folder / name);
    for (const double share : {0.1, 0.5, 0.95}) {
      write_file(
          folder / name,
          bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
      EXPECT_THAT(text_thrown_by<ConfigError>([&] { read_picture(folder / name); }),
                  HasSubstr(std::string(name) + ": the picture is "))
          << share;
    }
  }
}
#endif

// A head of a few bytes may promise any size: memory is not taken on its word.
TEST(ReadPicture, RefusesPromisesOfTooManyPixels) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    write_file(folder / name, bytes);
    return text_thrown_by<ConfigError>([&] { read_picture(folder / name); });
  };
  EXPECT_THAT(refusal("a.pgm", "P5\n100000 100000\n255\nx"), HasSubstr("more than is allowed"));
  EXPECT_THAT(refusal("b.pgm", "P5\n200000 2\n255\nx"), HasSubstr("more than is allowed"));
  EXPECT_THAT(refusal("c.pgm", "P5\n10000 10000\n255\nx"),
              HasSubstr("c.pgm: the picture is damaged: 20 bytes cannot hold 10000 x 10000"));
}

TEST(PngBytes, KeepColours) {
  const TemporaryFolder folder;
  ImageRgb image(2, 1);
  image(0, 0) = {255, 0, 0};
  image(1, 0) = {0, 255, 0};
  write_file(folder / "a.png", png_bytes(image));
  const Picture picture = read_picture(folder / "a.png");
  EXPECT_EQ(picture.channels, 3);
  EXPECT_NEAR(std::get<ImageF>(picture.pixels)(0, 0), 0.2126F, 1e-6F);
  EXPECT_NEAR(std::get<ImageF>(picture.pixels)(1, 0), 0.7152F, 1e-6F);
}

TEST(PngBytes, AreAWholePngFile) {
  const TemporaryFolder folder;
  const ImageF image = random_image(31, 17);
  const std::string bytes = png_bytes(image);
  EXPECT_THAT(bytes, StartsWith("\x89PNG\r\n"));
  EXPECT_EQ(bytes, png_bytes(image));
  write_file(folder / "a.png", bytes);
  write_png(folder / "b.png", image, PixelDepth::k8Bit);
  EXPECT_EQ(read_image(folder / "a.png"), read_image(folder / "b.png"));
}

// RFC 4648, section 10.
TEST(Base64, GivesThePublishedAnswers) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

// (1 + 2 + 6 + 7) / 4 = 4 and (3 + 4 + 8 + 9) / 4 = 6; the fifth column and third row are left out.
TEST(Reduce, AveragesHandWorkedBlocksAndDropsTheRemainder) {
  ImageF image(5, 3);
  image.values() = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const ImageF small = reduce(image, 2);
  EXPECT_EQ(small.width(), 2);
  EXPECT_EQ(small.height(), 1);
  EXPECT_THAT(small.values(), ElementsAre(4.0F, 6.0F));
  EXPECT_EQ(reduce(image, 1), image);
  EXPECT_TRUE(reduce(image, 4).empty());
}

TEST(ReduceDeathTest, RefusesAFactorBelowOne) {
  EXPECT_DEATH(reduce(ImageF(2, 2), 0), "a reduction factor counts pixels");
}

}  // namespace
}  // namespace glint
