// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/wall_plan.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <locale>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "core/csv.h"
#include "core/file.h"
#include "simulator/light/tunnel/tunnel.h"
#include "studies/drawing/dxf_file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A semicylinder of 100 mm with a slot of 20 mm over a flat part.
CrossSection semicylinder() {
  TunnelSettings settings;
  settings.radius_mm = 100.0;
  settings.slot_mm = 20.0;
  return {.panels_yz_mm = Tunnel(settings).outline(1.0),
          .part_yz_mm = {{-25, 0}, {25, 0}, {25, 6}, {-25, 6}},
          .camera_mm = {0, 0, 600},
          .slot_mm = 20,
          .length_mm = 600,
          .title = "\u00d8 200, 90\u00b0\n0\nEOF"};
}

// The slot's edge on a circle of 100 mm: y 10, z sqrt(100^2 - 10^2) = 99.499; from the rim to it
// 90 - asin(0.1) = 84.26 degrees.
TEST(WallArcs, RunFromTheRimToTheEdgeOfTheSlot) {
  const std::vector<std::vector<Arc>> panels = wall_arcs(semicylinder());
  ASSERT_EQ(panels.size(), 2U);
  for (const double side : {-1.0, 1.0}) {
    const std::vector<Arc>& arcs = panels[side < 0.0 ? 0 : 1];
    ASSERT_EQ(arcs.size(), 1U);
    EXPECT_NEAR((arcs[0].from_mm - Vector2d(side * 100.0, 0.0)).norm(), 0.0, 1e-6);
    EXPECT_NEAR((arcs[0].to_mm - Vector2d(side * 10.0, 99.499)).norm(), 0.0, 2e-3);
    EXPECT_NEAR(arcs[0].radius_mm(), 100.0, 0.01);
    EXPECT_NEAR(arcs[0].angle_rad() * kDegPerRad, 84.26, 0.01);
    EXPECT_EQ(arcs[0].bulge, -panels[side < 0.0 ? 1 : 0][0].bulge) << "mirror images";
    EXPECT_GT(side * arcs[0].bulge, 0.0) << "the right one turns counterclockwise";
  }
}

TEST(WallCsv, HasPointsRadiusAndCentreOfEachArc) {
  const std::vector<CsvRow> rows = parse_csv(wall_csv(semicylinder()), "wall.csv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0][5].text, "radius_mm");
  EXPECT_EQ(rows[2][0].text, "2");
  EXPECT_EQ(rows[2][1].text, "100");
  EXPECT_EQ(rows[2][3].text, "10");
  EXPECT_NEAR(*rows[2][5].number(), 100.0, 0.01);
  EXPECT_NEAR(*rows[2][8].number(), 84.26, 0.01);
  EXPECT_EQ(wall_csv(semicylinder()).find('\''), std::string::npos) << "a minus begins no formula";
  EXPECT_THAT(wall_csv(semicylinder()), HasSubstr("\n1,-100,0,-10,99.5,"));
}

TEST(WallLines, NameTheArcsOrTheTable) {
  EXPECT_THAT(
      wall_lines(semicylinder()),
      ElementsAre("Wall at y > 0, the other is its mirror image, (y, z) in mm within 0.1 mm:",
                  "from (100, 0)",
                  HasSubstr("to (10, 99.5), radius 100, centre (")));
  EXPECT_THAT(wall_lines(semicylinder(), 0),
              ElementsAre("wall: 1 arcs, see the table in cross_section.csv"));
  EXPECT_TRUE(wall_lines({}).empty());
}

struct Reading {
  int code = 0;
  std::string text;
};

Reading read_dxf(const std::string& dxf) {
  const TemporaryFolder folder;
  write_file(folder / "a.dxf", dxf);
  const std::string command = "/usr/bin/python3 '" GLINT_SOURCE_DIR
                              "/tests/studies/drawing/read_dxf.py' '" +
                              (folder / "a.dxf").string() + "' 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  Reading reading;
  std::array<char, 4096> block{};
  for (std::size_t count = 0; (count = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
    reading.text.append(block.data(), count);
  }
  const int status = pclose(pipe);
  reading.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return reading;
}

bool has_no_reader(const Reading& reading) {
  return reading.code == 77 || reading.code == 127;
}

TEST(WallDxf, IsReadByAnotherProgramWithoutAFault) {
  const CrossSection section = semicylinder();
  const Reading reading = read_dxf(wall_dxf(section));
  if (has_no_reader(reading)) {
    GTEST_SKIP() << "there is no ezdxf (Debian: python3-ezdxf)";
  }
  EXPECT_EQ(reading.code, 0) << reading.text;
  EXPECT_THAT(reading.text, HasSubstr("version AC1009"));
  // tan(84.26 / 4 degrees) = 0.3853
  EXPECT_THAT(reading.text, HasSubstr("POLYLINE LIGHT 100.000,0.000,0.385"));
  EXPECT_THAT(reading.text, HasSubstr("POLYLINE LIGHT -100.000,0.000,-0.385"));
  EXPECT_THAT(reading.text, HasSubstr("POLYLINE PART -25.000,0.000,0.000000 25.000,0.000"));
  EXPECT_THAT(reading.text, HasSubstr("LINE CAMERA 0.000,0.000 0.000,600.000"));
  EXPECT_THAT(reading.text, HasSubstr("TEXT NOTES %%c 200, 90%%d 0 EOF\n"));
}

TEST(ReadDxf, FindsAFault) {
  DxfFile file;
  file.line("A", Vector2d(0.0, 0.0), Vector2d(1.0, 0.0));
  const Reading sound = read_dxf(file.document());
  if (has_no_reader(sound)) {
    GTEST_SKIP() << "there is no ezdxf (Debian: python3-ezdxf)";
  }
  EXPECT_EQ(sound.code, 0) << sound.text;
  std::string broken = file.document();
  broken.replace(broken.find("LINE\n8\n"), 7, "LINE\nx\n");
  EXPECT_NE(read_dxf(broken).code, 0);
}

struct CommaDecimals : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(WallPlan, DoesNotDependOnTheLocale) {
  const std::string expected = wall_dxf(semicylinder()) + wall_csv(semicylinder());
  const std::locale before = std::locale::global(std::locale(std::locale(), new CommaDecimals));
  const std::string actual = wall_dxf(semicylinder()) + wall_csv(semicylinder());
  std::locale::global(before);
  EXPECT_EQ(actual, expected);
}

TEST(WallPlan, OfNothingIsEmpty) {
  EXPECT_TRUE(wall_arcs({}).empty());
  EXPECT_EQ(parse_csv(wall_csv({}), "wall.csv").size(), 1U);
}

}  // namespace
}  // namespace glint
