// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/drawing.h"

#include <cctype>
#include <locale>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "studies/drawing/svg_page.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two upright panels 200 mm apart and 150 mm high over a flat part, camera 600 mm away.
CrossSection upright_panels() {
  return {.panels_yz_mm = {{{-100, 0}, {-100, 150}}, {{100, 0}, {100, 150}}},
          .part_yz_mm = {{-25, 0}, {25, 0}, {25, 6}, {-25, 6}},
          .camera_mm = {0, 0, 600},
          .view_half_angle_rad = 0.05,
          .slot_mm = 20,
          .length_mm = 100,
          .part_length_mm = 80,
          .period_mm = 10,
          .duty = 0.5,
          .step_mm = 1.25,
          .positions = 8,
          .title = "upright"};
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

/// The first fault of the markup: a tag that does not close what was opened last, an attribute
/// without quotes, a bare special character. Empty when there is none.
std::string markup_fault(const std::string& text) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while (at < text.size()) {
    if (text[at] == '&' && text.find(';', at) > at + 5) {
      return "bare & at " + std::to_string(at);
    }
    if (text[at] != '<') {
      ++at;
      continue;
    }
    const auto end = text.find('>', at);
    if (end == std::string::npos) {
      return "unfinished tag";
    }
    const std::string tag = text.substr(at + 1, end - at - 1);
    if (tag.find('<') != std::string::npos || count_of(tag, "\"") != 2 * count_of(tag, "=\"")) {
      return "bad tag " + tag;
    }
    const bool is_closing = tag.front() == '/';
    const std::string name = tag.substr(is_closing, tag.find_first_of(" /", 1) - is_closing);
    if (is_closing) {
      if (open.empty() || open.back() != tag.substr(1)) {
        return "misplaced </" + tag.substr(1);
      }
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
    at = end + 1;
  }
  return open.empty() ? "" : "open " + open.back();
}

// 200 mm in a view 308 units wide: 1.54 units/mm; 150 mm high are then 231 of the 240 units there.
// The view starts 64 units from the left, so the walls stand at 64 and 64 + 200 * 1.54 = 372.
TEST(CrossSectionSvg, DrawsTwoHundredMillimetresTwoHundredTimesTheScaleWide) {
  const CrossSection section = upright_panels();
  EXPECT_DOUBLE_EQ(cross_section_scale(section), 1.54);
  // Title down to 32, walls 118 below it from 150 to 150 + 231 = 381.
  const std::string svg = cross_section_svg(section);
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"64,381 64,150\""));
  EXPECT_THAT(svg, HasSubstr("<polyline points=\"372,381 372,150\""));
}

// A wall 400 mm wide and 800 mm high is limited by its height: 240 / 800 = 0.3.
TEST(CrossSectionSvg, FitsHighWallsByTheirHeight) {
  EXPECT_DOUBLE_EQ(cross_section_scale({.panels_yz_mm = {{{-200, 0}, {200, 800}}}}), 0.3);
}

TEST(CrossSectionSvg, WritesWidthHeightSlotLengthPeriodAndCameraDistance) {
  const std::string svg = cross_section_svg(upright_panels());
  for (const char* words : {">200 mm<",
                            ">150 mm<",
                            ">144 mm<",  // 150 - 6 above the part
                            ">slot 20 mm<",
                            ">100 mm<",
                            ">period 10 mm<",
                            ">camera 600 mm away<",
                            ">period 10 mm, bright share 0.5<",
                            ">8 images, step 1.25 mm<",
                            ">y<",
                            ">z<",
                            ">x<"}) {
    EXPECT_THAT(svg, HasSubstr(words));
  }
}

// 100 mm of wall hold ten periods of 10 mm. The view's scale is min(308/100, 240/150) = 1.6, its
// middle 64 + 154 = 218: the stripe from 0 to 5 mm goes from 218 to 218 + 5 * 1.6 = 226, over 240
// units.
TEST(CrossSectionSvg, DrawsEveryBrightStripeToScale) {
  const std::string svg = cross_section_svg(upright_panels());
  EXPECT_EQ(count_of(svg, "class=\"stripe\""), 10U);
  EXPECT_THAT(svg, HasSubstr("points=\"226,749 226,509 218,509 218,749\" class=\"stripe\""));
}

TEST(CrossSectionSvg, SaysSoWhereStripesAreTooFineToDraw) {
  CrossSection section = upright_panels();
  section.period_mm = 0.1;
  const std::string svg = cross_section_svg(section);
  EXPECT_EQ(count_of(svg, "class=\"stripe\""), 0U);
  EXPECT_THAT(svg, HasSubstr("too fine to draw"));
}

// The camera 160 mm up, 10 mm above the walls, has room in the picture: only a far one is broken
// off.
TEST(CrossSectionSvg, BreaksTheAxisOnlyForAFarCamera) {
  const std::string break_fill = "fill=\"#ffffff\"/>";
  CrossSection near = upright_panels();
  near.camera_mm = {0, 0, 160};
  EXPECT_EQ(count_of(cross_section_svg(near), break_fill), 0U);
  EXPECT_EQ(count_of(cross_section_svg(upright_panels()), break_fill), 1U);
}

TEST(CrossSectionSvg, EscapesTheTitle) {
  CrossSection section = upright_panels();
  section.title = "a<b & \"c\"\x01";
  const std::string svg = cross_section_svg(section);
  EXPECT_THAT(svg, HasSubstr("<title>a&lt;b &amp; &quot;c&quot; </title>"));
  EXPECT_EQ(markup_fault(svg), "");
}

TEST(CrossSectionSvg, IsADocumentEvenWithNothingToDraw) {
  const std::string svg = cross_section_svg({});
  EXPECT_EQ(cross_section_scale({}), 0.0);
  EXPECT_THAT(svg, HasSubstr("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(markup_fault(svg), "");
}

struct CommaPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(CrossSectionSvg, DoesNotDependOnTheLocale) {
  const std::string expected = cross_section_svg(upright_panels());
  const std::locale before = std::locale::global(std::locale(std::locale(), new CommaPoint));
  const std::string actual = cross_section_svg(upright_panels());
  std::locale::global(before);
  EXPECT_EQ(actual, expected);
}

CrossSection random_section(Rng& rng) {
  const auto between = [&](double low, double high) { return low + (high - low) * rng.uniform(); };
  CrossSection section;
  for (int panel = 0; panel < 2; ++panel) {
    section.panels_yz_mm.emplace_back();
    const int count = 1 + static_cast<int>(4 * rng.uniform());
    for (int i = 0; i < count; ++i) {
      section.panels_yz_mm.back().emplace_back(between(-500, 500), between(-50, 500));
    }
  }
  for (int i = 0; i < 4; ++i) {
    section.part_yz_mm.emplace_back(between(-50, 50), between(-20, 20));
  }
  section.camera_mm = {between(-50, 50), between(-900, 900), between(-100, 1500)};
  section.view_half_angle_rad = between(0, 0.5);
  section.slot_mm = between(-10, 50);
  section.length_mm = between(0, 1000);
  section.part_length_mm = between(-100, 500);
  section.period_mm = between(-1, 60);
  section.duty = rng.uniform();
  section.orientation_rad = rng.uniform() < 0.5 ? 0.0 : between(-3, 3);
  section.positions = static_cast<int>(between(0, 5));
  return section;
}

TEST(CrossSectionSvg, IsWellFormedAndFiniteForAnyLighting) {
  Rng rng(7, Stream::kTest, 0);
  for (int round = 0; round < 1000; ++round) {
    const CrossSection section = random_section(rng);
    const std::string svg = cross_section_svg(section);
    ASSERT_EQ(markup_fault(svg), "") << "round " << round;
    ASSERT_THAT(svg, Not(HasSubstr("nan"))) << "round " << round;
    ASSERT_THAT(svg, Not(HasSubstr("\"inf"))) << "round " << round;
    ASSERT_THAT(svg, Not(HasSubstr(",inf"))) << "round " << round;
    ASSERT_EQ(svg, cross_section_svg(section));
  }
}

TEST(MarkupFault, SeesWrongNestingAndBareCharacters) {
  EXPECT_EQ(markup_fault("<a><b x=\"1\"/>t &amp; u</a>"), "");
  EXPECT_NE(markup_fault("<a><b></a></b>"), "");
  EXPECT_NE(markup_fault("<a>t & u, v, w, x</a>"), "");
  EXPECT_NE(markup_fault("<a x=1\"/>"), "");
  EXPECT_NE(markup_fault("<a>"), "");
}

// The longest round bar of at most 90 units: at 1.6 units/mm 50 mm are 80 units, 100 mm too long;
// at 0.5 units/mm 100 mm are 50 and 200 mm already 100.
TEST(SvgPage, ScaleBarIsTheLongestRoundLengthThatFits) {
  SvgPage page;
  page.scale_bar({10, 5}, 1.6);
  EXPECT_THAT(page.document(100, 10, ""), HasSubstr("<line x1=\"10\" y1=\"5\" x2=\"90\" y2=\"5\""));
  EXPECT_THAT(page.document(100, 10, ""), HasSubstr(">50 mm<"));
  SvgPage coarse;
  coarse.scale_bar({0, 0}, 0.5);
  EXPECT_THAT(coarse.document(100, 10, ""), HasSubstr(">100 mm<"));
}

}  // namespace
}  // namespace glint
