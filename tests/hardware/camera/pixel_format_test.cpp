// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/pixel_format.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "core/rng.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Codes = std::vector<std::uint16_t>;

Codes codes_of(const std::vector<std::uint8_t>& bytes, PixelFormat format, int count) {
  const Image<std::uint16_t> image = unpacked(bytes, format, count, 1);
  return {image.values().begin(), image.values().end()};
}

TEST(PixelFormat, OneByteEachIsTheCodeItself) {
  EXPECT_THAT(codes_of({0, 127, 255}, PixelFormat::kMono8, 3), ElementsAre(0, 127, 255));
}

// 0xbc + 256 * 0x0a = 2748.
TEST(PixelFormat, TwoBytesBeginWithTheLowerOne) {
  EXPECT_THAT(codes_of({0xbc, 0x0a, 0xff, 0x0f}, PixelFormat::kMono12, 2), ElementsAre(2748, 4095));
}

// 0xABC and 0x123: AB (upper 8 of the first), 3C (lower 4 of second and first), 12.
TEST(PixelFormat, PackedTwelveBitsLieInThreeBytes) {
  EXPECT_THAT(codes_of({0xab, 0x3c, 0x12}, PixelFormat::kMono12Packed, 2),
              ElementsAre(0xabc, 0x123));
  EXPECT_THAT(packed(Codes{0xabc, 0x123}, PixelFormat::kMono12Packed),
              ElementsAre(0xab, 0x3c, 0x12));
}

// 0x2AB = 683: upper 8 bits 0xAA, lower two 3; 0x155 = 341: 0x55 and 1. Between: 1 * 16 + 3 = 0x13.
TEST(PixelFormat, PackedTenBitsLieInThreeBytes) {
  EXPECT_THAT(codes_of({0xaa, 0x13, 0x55}, PixelFormat::kMono10Packed, 2),
              ElementsAre(0x2ab, 0x155));
  EXPECT_THAT(packed(Codes{0x2ab, 0x155}, PixelFormat::kMono10Packed),
              ElementsAre(0xaa, 0x13, 0x55));
}

// 0xABC then 0x123 from the lowest bit: BC, then A in the low half and 3 in the high one, then 12.
TEST(PixelFormat, TwelveBitsWithoutGapsBeginWithTheLowestBit) {
  EXPECT_THAT(codes_of({0xbc, 0x3a, 0x12}, PixelFormat::kMono12p, 2), ElementsAre(0xabc, 0x123));
  EXPECT_THAT(packed(Codes{0xabc, 0x123}, PixelFormat::kMono12p), ElementsAre(0xbc, 0x3a, 0x12));
}

// 1, 2, 3, 1023 in ten bits each: 1 + 2*2^10 + 3*2^20 + 1023*2^30 = 0xFFC0300801, low byte first.
TEST(PixelFormat, TenBitsWithoutGapsBeginWithTheLowestBit) {
  EXPECT_THAT(codes_of({0x01, 0x08, 0x30, 0xc0, 0xff}, PixelFormat::kMono10p, 4),
              ElementsAre(1, 2, 3, 1023));
}

TEST(PixelFormat, SizesCountTheLastByteInFull) {
  EXPECT_EQ(bytes_of(PixelFormat::kMono8, 5), 5U);
  EXPECT_EQ(bytes_of(PixelFormat::kMono16, 5), 10U);
  EXPECT_EQ(bytes_of(PixelFormat::kMono12Packed, 5), 9U);  // two and a half pairs
  EXPECT_EQ(bytes_of(PixelFormat::kMono12p, 5), 8U);       // 60 bits
  EXPECT_EQ(bytes_of(PixelFormat::kMono10p, 5), 7U);       // 50 bits
  EXPECT_EQ(bytes_of(PixelFormat::kMono12, 2448 * 2050), 10036800U);
}

TEST(PixelFormat, UnpackingInvertsPackingForAnyCodesAndCounts) {
  Rng random(3, Stream::kTest, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    const PixelFormat format = kPixelFormats.at(random.next_u32() % kPixelFormats.size());
    Codes codes(1 + random.next_u32() % 40);
    for (std::uint16_t& code : codes) {
      code =
          static_cast<std::uint16_t>(random.next_u32() & ((1U << unsigned(bits_of(format))) - 1));
    }
    const auto bytes = packed(codes, format);
    EXPECT_EQ(bytes.size(), bytes_of(format, codes.size()));
    EXPECT_EQ(codes_of(bytes, format, static_cast<int>(codes.size())), codes) << name_of(format);
  }
}

TEST(PixelFormat, TooFewBytesAreAnError) {
  try {
    unpacked(std::vector<std::uint8_t>(11), PixelFormat::kMono12, 3, 2);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("3 x 2 pixels in Mono12 has 11 bytes, must have 12"));
  }
}

TEST(PixelFormat, NumbersReadBack) {
  for (const PixelFormat format : kPixelFormats) {
    EXPECT_EQ(pixel_format_of_number(genicam_number(format)), format);
  }
  EXPECT_FALSE(pixel_format_of_number(0x01080009).has_value());
}

}  // namespace
}  // namespace glint
