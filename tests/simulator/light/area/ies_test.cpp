// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/ies_table.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "simulator/light/area/read_ies.h"
#include "tests/simulator/light/area/light_scenes.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

/// A file with these planes; intensity = 100 + plane's number.
std::string file_of(const std::string& head,
                    const std::string& units_and_size,
                    const std::vector<double>& planes,
                    const std::string& vertical = "0 45 90") {
  std::string text = head + "1 1000 2 3 " + std::to_string(planes.size()) + " 1 " + units_and_size +
                     "\n1 0.5 20\n" + vertical + "\n";
  for (const double plane : planes) {
    text += fmt::format("{} ", plane);
  }
  for (std::size_t k = 0; k < planes.size(); ++k) {
    text += fmt::format("\n{0},{0}\r\n  {0}", 100 + k);
  }
  return text + "\n";
}

const std::string k1995 = "IESNA:LM-63-1995\n[TEST] none\nTILT=NONE\n";

std::string error_of(const std::string& text) {
  try {
    parse_ies(text, "lamp.ies");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

Vector3d towards(double vertical_deg, double horizontal_deg) {
  const double v = vertical_deg * kRadPerDeg;
  const double h = horizontal_deg * kRadPerDeg;
  return {std::sin(v) * std::cos(h), -std::sin(v) * std::sin(h), std::cos(v)};
}

// Multiplier 2, ballast 1, ballast-lamp factor 0.5: 100 cd. A half space of it: 2 pi 100.
TEST(ParseIes, MultipliesFactorsAndIntegratesFlux) {
  const IesTable table = parse_ies(file_of(k1995, "2 0.1 0.2 0", {0}), "lamp.ies");
  EXPECT_DOUBLE_EQ(table.at(towards(30, 77)), 100.0);
  EXPECT_NEAR(table.flux(), 200.0 * kPi, 1e-9);
  EXPECT_EQ(table.at(towards(91, 0)), 0.0);
  EXPECT_FALSE(table.is_absolute);
  EXPECT_LT((table.size_mm - Vector3d(200.0, 100.0, 0.0)).norm(), 1e-9);  // length, width, height
}

// What stood for a factor up to 1995 is a code since 2019 and 1 in between.
TEST(ParseIes, TakesTheThirdFactorOnlyFromOldFiles) {
  for (const char* head : {"IESNA:LM-63-2002\nTILT=NONE\n", "IES:LM-63-2019\nTILT=NONE\n"}) {
    EXPECT_DOUBLE_EQ(parse_ies(file_of(head, "2 0 0 0", {0}), "").at({0, 0, 1}), 200.0);
  }
  for (const char* head : {"some lamp of 1986\nTILT=NONE\n", "IESNA91\nTILT=NONE\n"}) {
    EXPECT_DOUBLE_EQ(parse_ies(file_of(head, "2 0 0 0", {0}), "").at({0, 0, 1}), 100.0);
  }
}

// One foot is 304.8 mm; negative sizes mean round.
TEST(ParseIes, KnowsFeetAndRoundOpenings) {
  const IesTable feet = parse_ies(file_of(k1995, "1 1 2 0.5", {0}), "");
  EXPECT_LT((feet.size_mm - Vector3d(609.6, 304.8, 152.4)).norm(), 1e-9);
  const IesTable disc = parse_ies(file_of(k1995, "1 -1 0 0", {0}), "");
  EXPECT_TRUE(disc.is_round);
  EXPECT_FALSE(feet.is_round);
}

TEST(ParseIes, UnfoldsEverySymmetry) {
  const IesTable quarter = parse_ies(file_of(k1995, "2 0 0 0", {0, 45, 90}), "");
  const IesTable half = parse_ies(file_of(k1995, "2 0 0 0", {0, 90, 180}), "");
  const IesTable side = parse_ies(file_of(k1995, "2 0 0 0", {90, 180, 270}), "");
  const IesTable whole = parse_ies(file_of(k1995, "2 0 0 0", {0, 90, 180, 270, 360}), "");
  for (const IesTable* t : {&quarter, &half, &side, &whole}) {
    EXPECT_EQ(t->horizontal_rad.front(), 0.0);
    EXPECT_DOUBLE_EQ(t->horizontal_rad.back(), 2.0 * kPi);
    EXPECT_EQ(t->intensity.size(), t->horizontal_rad.size() * t->vertical_rad.size());
  }
  // Plane k has 100 + k; 135 mirrors 45, 225 mirrors 45, 315 mirrors 45.
  for (const double angle : {45.0, 135.0, 225.0, 315.0}) {
    EXPECT_NEAR(quarter.at(towards(60, angle)), 101.0, 1e-9) << angle;
  }
  EXPECT_NEAR(quarter.at(towards(60, 270)), 102.0, 1e-9);
  EXPECT_NEAR(half.at(towards(60, 270)), 101.0, 1e-9);   // mirrors 90
  EXPECT_NEAR(half.at(towards(60, 225)), 101.5, 1e-9);   // mirrors 135
  EXPECT_NEAR(side.at(towards(60, 0)), 101.0, 1e-9);     // mirrors 180
  EXPECT_NEAR(side.at(towards(60, 45)), 100.5, 1e-9);    // mirrors 135
  EXPECT_NEAR(side.at(towards(60, 315)), 101.5, 1e-9);   // mirrors 225
  EXPECT_NEAR(whole.at(towards(60, 315)), 103.5, 1e-9);  // no symmetry
}

TEST(ParseIes, PassesOverIncludedTiltAndSaysSo) {
  const std::string head = "IESNA91\nTILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8\n";
  const IesTable table = parse_ies(file_of(head, "2 0 0 0", {0}), "lamp.ies");
  EXPECT_DOUBLE_EQ(table.at({0, 0, 1}), 100.0);
  Lights lights;
  lights.bodies.push_back({.table = table});
  EXPECT_THAT(tilt_warnings(lights),
              ElementsAre(HasSubstr("lamp.ies: the table of TILT=INCLUDE (factors 0.8 to 1) is not "
                                    "applied")));
  lights.bodies[0].table = parse_ies(file_of(k1995, "2 0 0 0", {0}), "lamp.ies");
  EXPECT_THAT(tilt_warnings(lights), ElementsAre());
}

TEST(ParseIes, SaysWhereAndWhatIsWrong) {
  EXPECT_THAT(error_of(""), HasSubstr("no line TILT="));
  EXPECT_THAT(error_of("IESNA91\nTILT=lamp.tlt\n"), HasSubstr("lamp.ies:2:1: TILT is 'lamp.tlt'"));
  EXPECT_THAT(error_of("TILT=NONE\n1 -1 1 3 1 2 2 0 0 0\n1 1 1\n"),
              HasSubstr("lamp.ies:2:12: photometry of type A or B"));
  EXPECT_THAT(error_of("TILT=NONE\n1 -1 one\n"),
              HasSubstr("lamp.ies:2:6: the multiplier of intensities is 'one'"));
  EXPECT_THAT(error_of(file_of(k1995, "2 0 0 0", {0, 100})), HasSubstr("from 0 to 100 degrees"));
  EXPECT_THAT(error_of(file_of(k1995, "2 0 0 0", {0}, "0 45 80")), HasSubstr("from 0 to 80"));
  EXPECT_THAT(error_of(file_of(k1995, "2 0 0 0", {0}, "0 95 90")), HasSubstr("must rise"));
  EXPECT_THAT(error_of(file_of(k1995, "3 0 0 0", {0})), HasSubstr("the units"));
  EXPECT_THAT(error_of(file_of(k1995, "2 0 0 0", {0}) + "7"), HasSubstr("more numbers than 1 x 3"));
  const std::string whole = file_of(k1995, "2 0 0 0", {0});
  EXPECT_THAT(error_of(whole.substr(0, whole.size() - 6)), HasSubstr("the file ends where"));
}

// Values computed by others with the trapezoidal rule (README of the data).
TEST(ParseIes, FindsTheFluxOfMeasuredLamps) {
  const std::filesystem::path folder = std::filesystem::path(GLINT_SHARED_DIR) / "data/field/ies";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "measured lamps are not there: " << folder;
  }
  const std::vector<std::pair<const char*, double>> expected = {
      {"aerolamp", 98.34}, {"beacon", 22.83}, {"lumenizer_zone", 162.9}, {"ushio_b1", 118.9}};
  for (const auto& [name, flux_mw] : expected) {
    const IesTable table = read_ies(folder / (std::string(name) + ".ies"));
    EXPECT_NEAR(table.flux() / flux_mw, 1.0, 0.005) << name;
    EXPECT_TRUE(table.is_absolute);
  }
}

// By 600 x 1200 directions.
TEST(IesTable, FluxIsTheIntegralOfItsIntensity) {
  const IesTable table = some_table(true);
  const double sum = over_sphere(600, [&](const Vector3d& d) { return table.at(d); });
  EXPECT_NEAR(table.flux() / sum, 1.0, 1e-4);
}

TEST(IesLight, GivesIntensityOverSquaredDistanceFromAfar) {
  const TemporaryFolder folder;
  std::string text =
      "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 4 3 1 2 0.05 0.08 0.02 1 1 10\n0 30 60 180\n"
      "0 90 180\n9 7 3 1\n9 6 4 1\n9 5 2 1\n";
  write_file(folder.path() / "lamp.ies", text);
  const Lights lights = lights_of(IesLightSettings{.placement = {.position_mm = {0.0, 0.0, 0.0}},
                                                   .file = folder.path() / "lamp.ies"});
  EXPECT_EQ(lights.emitters.size(), 6U);
  const IesBody& body = lights.bodies.at(0);
  Rng rng(1, Stream::kTest, 1);
  for (int i = 0; i < 50; ++i) {
    const double z = rng.uniform(-0.99, 0.99);
    const double phi = rng.uniform(0.0, 2.0 * kPi);
    const double r = std::sqrt(1.0 - z * z);
    const Vector3d out(r * std::cos(phi), r * std::sin(phi), z);
    // At 20 m, 250 times the size.
    const double e = irradiance(lights, 2e4 * out, -out, 60)[0];
    EXPECT_NEAR(e * 400.0 / body.table.at(body.frame.local(out)), 1.0, 0.02);
  }
  // Straight below: 9 / 20^2.
  const double below = irradiance(lights, {0.0, 0.0, -2e4}, Vector3d::UnitZ(), 60)[0];
  EXPECT_NEAR(below / (9.0 / 400.0), 1.0, 2e-3);
}

TEST(IesLight, WarnsNearerThanFiveTimesItsSize) {
  const Lights lights = box_light({60.0, 40.0, 20.0});  // at height 200, 5 * 60 = 300
  EXPECT_THAT(far_field_warnings(lights, {Vector3d::Zero()}),
              testing::ElementsAre(HasSubstr("60 mm wide and 200 mm away")));
  EXPECT_TRUE(far_field_warnings(lights, {{0.0, 0.0, -101.0}}).empty());
}

}  // namespace
}  // namespace glint
