// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_marks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"

namespace glint {
namespace {

FoundDefect lying_defect(DefectKind kind) {
  FoundDefect defect;
  defect.x_px = 50.0;
  defect.y_px = 30.0;
  defect.length_px = 20.0;
  defect.width_px = 4.0;
  defect.kind = kind;
  return defect;
}

double reach(const DefectMark& mark, int axis) {
  double maximum = 0.0;
  for (const Eigen::Vector2d& point : mark.outline) {
    maximum = std::max(maximum, std::abs(point[axis] - (axis == 0 ? 50.0 : 30.0)));
  }
  return maximum;
}

// Half of 20 and of 4 px, and 3.5 px of space.
TEST(MarksOf, StandAboutTheDefect) {
  for (const DefectKind kind : {DefectKind::kHole, DefectKind::kScratch}) {
    FoundDefect defect = lying_defect(kind);
    const std::vector<DefectMark> lying = marks_of(std::vector{defect});
    EXPECT_NEAR(reach(lying[0], 0), 13.5, 1e-9);
    EXPECT_NEAR(reach(lying[0], 1), 5.5, 1e-9);
    defect.angle_rad = 0.5 * kPi;
    const std::vector<DefectMark> upright = marks_of(std::vector{defect});
    EXPECT_NEAR(reach(upright[0], 0), 5.5, 1e-9);
    EXPECT_NEAR(reach(upright[0], 1), 13.5, 1e-9);
  }
  const std::vector<DefectMark> two =
      marks_of(std::vector{lying_defect(DefectKind::kHole), lying_defect(DefectKind::kScratch)});
  EXPECT_EQ(two[1].number, 2);
  EXPECT_EQ(two[1].outline.size(), 4U) << "a rectangle about a scratch";
  EXPECT_GT(two[0].outline.size(), 12U) << "an ellipse about a hole";
}

TEST(MissedMarks, StandAboutWhatWasMissed) {
  const std::vector<KnownDefect> known = {
      {.from_px = {5, 5}, .to_px = {5, 5}, .radius_px = 2.0},
      {.from_px = {45, 30}, .to_px = {55, 30}, .radius_px = 2.0}};
  const std::vector<DefectMark> marks =
      missed_marks(known, {.blob_of_defect = {0, -1}, .defect_of_blob = {0}});
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].number, 2);
  EXPECT_NEAR(reach(marks[0], 0), 10.5, 1e-9);  // 5 + 2 + 3.5
  EXPECT_NEAR(reach(marks[0], 1), 5.5, 1e-9);
}

TEST(ShownAspect, SpreadsTheRegionAndDarkensTheRest) {
  ImageF aspect(10, 1, 0.4F);
  Mask region(10, 1, 1);
  for (int x = 0; x < 5; ++x) {
    aspect(x, 0) = 0.5F;
  }
  aspect(9, 0) = 0.5F;
  region(9, 0) = 0;
  const ImageF shown = shown_aspect(aspect, region);
  EXPECT_NEAR(shown(0, 0), 1.0F, 1e-6F);
  EXPECT_NEAR(shown(7, 0), 0.0F, 1e-6F);
  EXPECT_NEAR(shown(9, 0), 0.45F, 1e-6F);
}

// 100 px are enlarged four times at most; the line runs where the outline is and nowhere else.
TEST(Overlay, DrawsLinesInTheirColours) {
  const ImageF grey(100, 60, 0.5F);
  const ImageRgb plain = overlay(grey, {});
  EXPECT_EQ(plain.width(), 400);
  EXPECT_EQ(plain(200, 100), (std::array<std::uint8_t, 3>{128, 128, 128}));
  const ImageRgb drawn = overlay(grey, marks_of(std::vector{lying_defect(DefectKind::kScratch)}));
  EXPECT_EQ(drawn(200, 120), plain(200, 120)) << "the defect itself stays to be seen";
  const auto line = drawn(200, 4 * 30 + 22);  // 5.5 px below the middle
  EXPECT_LT(line[0], 60);
  EXPECT_GT(line[2], 200);
  EXPECT_EQ(drawn(20, 20), plain(20, 20));
}

}  // namespace
}  // namespace glint
