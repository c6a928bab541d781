// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/text.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using ::testing::ElementsAre;

// "radus_mm" -> "radius_mm" is 1 insertion; the others are further away.
TEST(Nearest, FindsTheSmallestEditDistance) {
  const std::vector<std::string> keys = {"length_mm", "radius_mm", "period_mm"};
  EXPECT_EQ(nearest("radus_mm", keys), "radius_mm");
  EXPECT_EQ(nearest("perod_mm", keys), "period_mm");
  EXPECT_EQ(nearest("length_mm", keys), "length_mm");
}

// kitten -> sitting takes 3 edits (k/s, e/i, +g), kitten -> mitten 1, kitten -> "" 6.
TEST(Nearest, CountsSubstitutionsInsertionsAndDeletions) {
  const std::vector<std::string> words = {"", "sitting", "mitten"};
  EXPECT_EQ(nearest("kitten", words), "mitten");
  const std::vector<std::string> far = {"", "sitting"};
  EXPECT_EQ(nearest("kitten", far), "sitting");
}

TEST(Nearest, TakesTheFirstOfEqualsAndNothingFromNothing) {
  const std::vector<std::string> equals = {"ab", "ac"};
  EXPECT_EQ(nearest("ad", equals), "ab");
  EXPECT_EQ(nearest("ad", {}), "");
}

TEST(Shortest, WritesTheShortestTextThatReadsBack) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(90.0), "90");
  EXPECT_EQ(shortest(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(shortest(-0.0), "-0");
  EXPECT_EQ(shortest(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(shortest(-std::numeric_limits<double>::infinity()), "-inf");
  EXPECT_EQ(shortest(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(Shortest, ReadsBackAsTheSameDoubleForAnyBits) {
  Rng rng(11, Stream::kTest, 0);
  for (int i = 0; i < 5000; ++i) {
    const std::uint64_t high = rng.next_u32();
    const auto value = std::bit_cast<double>((high << 32) | rng.next_u32());
    if (!std::isnan(value)) {
      ASSERT_EQ(std::strtod(shortest(value).c_str(), nullptr), value);
    }
  }
}

TEST(Split, KeepsEmptyParts) {
  EXPECT_THAT(split("a.b.c", '.'), ElementsAre("a", "b", "c"));
  EXPECT_THAT(split(".a..", '.'), ElementsAre("", "a", "", ""));
  EXPECT_THAT(split("", '.'), ElementsAre(""));
}

TEST(Join, UndoesSplit) {
  for (const char* text : {"a.b.c", ".a..", "", "abc"}) {
    EXPECT_EQ(join(split(text, '.'), "."), text);
  }
  EXPECT_EQ(join({}, ", "), "");
}

TEST(MarkupText, CanStandInAnElementOrAnAttribute) {
  EXPECT_EQ(markup_text("a<b> & \"c\"\x01\n"), "a&lt;b&gt; &amp; &quot;c&quot; \n");
}

// FIPS 180-2, appendix B.1 and B.2, and the well-known digest of nothing.
TEST(Sha256Hex, GivesThePublishedDigests) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(LengthText, RoundsAsAPersonWould) {
  EXPECT_EQ(length_text(200.0), "200 mm");
  EXPECT_EQ(length_text(618.4661), "618.5 mm");
  EXPECT_EQ(length_text(66.666), "66.67 mm");
  EXPECT_EQ(length_text(1.0 / 3.0), "0.333 mm");
}

}  // namespace
}  // namespace glint
