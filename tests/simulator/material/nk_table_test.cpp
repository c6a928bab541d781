// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/nk_table.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "simulator/material/fresnel.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kHead =
    "REFERENCES: |\n    somebody\nDATA:\n  - type: tabulated nk\n    data: |\n";

std::string nk_yaml(const std::string& rows) {
  return std::string(kHead) + rows;
}

std::string nk_error(const std::string& text) {
  try {
    parse_nk(text, "metal.yml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// Half way from 500 to 600 nm: n = 1.5, k = 3.
TEST(NkTable, InterpolatesBetweenItsRows) {
  const NkTable table =
      parse_nk(nk_yaml("        0.5 1 2\n        6E-01 2.0 4.0\nSPECS:\n"), "m.yml");
  EXPECT_EQ(table.wavelength_nm.size(), 2U);
  EXPECT_NEAR(table.at(550).n, 1.5, 1e-12);
  EXPECT_NEAR(table.at(550).k, 3.0, 1e-12);
  EXPECT_EQ(table.at(500).n, 1.0);
  EXPECT_EQ(table.at(600).k, 4.0);
}

// y0 + (y1 - y0) * 1 is not y1 where the two are of very different size.
TEST(NkTable, HasTheValuesOfARowAtItsWavelength) {
  const NkTable table = parse_nk("wl,n,k\n0.5,0.99991,3\n0.6,9.9991E-06,7E-09\n", "m.csv");
  EXPECT_EQ(table.at(table.wavelength_nm[1]).n, 9.9991e-6);
  EXPECT_EQ(table.at(table.wavelength_nm[1]).k, 7e-9);
}

TEST(NkTable, ReadsBothKindsOfCsv) {
  const NkTable one = parse_nk("wl,n,k\n0.5,1,2\n0.6,2,4\n", "m.csv");
  EXPECT_NEAR(one.at(575).k, 3.5, 1e-12);
  const NkTable two = parse_nk("wl,n\r\n0.5,1\r\n0.6,2\r\n\r\nwl,k\r\n0.4,1\r\n0.6,5\r\n", "m.csv");
  EXPECT_NEAR(two.at(500).k, 3.0, 1e-12);
  EXPECT_NEAR(two.at(550).n, 1.5, 1e-12);
}

TEST(NkTable, ReadsWhatSpreadsheetsAndEditorsWrite) {
  EXPECT_EQ(parse_nk("\xEF\xBB\xBFwl,n,k\n0.5,1,2\n", "m.csv").n.size(), 1U);
  for (const char* type : {"\"tabulated nk\"", "'tabulated nk'"}) {
    const std::string text = std::string("DATA:\n  - type: ") + type +
                             "\n    data: |\n      # by ellipsometry\n      0.5 1 2\n";
    EXPECT_EQ(parse_nk(text, "m.yml").n.size(), 1U) << type;
  }
}

// Comments of the site are blocks of text or empty; a formula may stand before the table.
TEST(NkTable, ReadsTheTableAmongOtherEntries) {
  const NkTable table = parse_nk(
      "COMMENTS:\nDATA:\n  - type: formula 2\n    coefficients: 0 1\n  - type: tabulated nk\n"
      "    data: |\n        0.5 1 2\nSPECS:\n    n_is_absolute: true\n",
      "m.yml");
  EXPECT_EQ(table.k, std::vector<double>{2.0});
}

TEST(NkTable, RefusesAWavelengthItDoesNotHold) {
  const NkTable table = parse_nk("wl,n,k\n0.5,1,2\n0.6,2,4\n", "m.csv");
  for (const double nm : {499.0, 601.0, std::nan("")}) {
    EXPECT_THROW(table.at(nm), ConfigError);
  }
  try {
    table.at(700);
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("m.csv: has no values at 700 nm, only from 500 to 600 nm"));
  }
}

TEST(NkTable, NamesTheLineOfAMistake) {
  EXPECT_THAT(nk_error(nk_yaml("      0.5 1,x 2\n")), HasSubstr("metal.yml:6: \"x\""));
  EXPECT_THAT(nk_error(nk_yaml("      0.5 1 2\n      0.6 1 x\n")),
              HasSubstr("metal.yml:7: \"x\" is no number"));
  EXPECT_THAT(nk_error(nk_yaml("      0.5 1\n")), HasSubstr("metal.yml:6: has 2 numbers"));
  EXPECT_THAT(nk_error(nk_yaml("      0.5 1 2\n      0.5 1 2\n")),
              HasSubstr("metal.yml:7: the wave"));
  EXPECT_THAT(nk_error(nk_yaml("      0.5 0 2\n")), HasSubstr("metal.yml:6: n is 0"));
  EXPECT_THAT(nk_error(nk_yaml("      0.5 1 inf\n")), HasSubstr("is no number"));
  EXPECT_THAT(nk_error("DATA:\n  - type: formula 2\n"),
              HasSubstr("metal.yml:2: type is \"formula 2\", must be \"tabulated nk\""));
  EXPECT_THAT(nk_error("hello\n"), HasSubstr("holds no table under DATA"));
  EXPECT_THAT(nk_error(""), HasSubstr("metal.yml:1:1: holds no value"));
  EXPECT_THAT(nk_error("DATA: 3\n"), HasSubstr("holds no table under DATA"));
  EXPECT_THAT(nk_error("DATA:\n  - 3\n"), HasSubstr("metal.yml:2: type is \"\""));
  EXPECT_THAT(nk_error("DATA: [\n"), HasSubstr("metal.yml:2:"));
  EXPECT_THAT(nk_error("wl,n,k\n"), HasSubstr("holds no rows"));
  EXPECT_THAT(nk_error("wl,n\n0.5,1\n"), HasSubstr("holds no rows"));
}

struct MetalRow {
  const char* name;
  std::array<double, 3> r0;
};

// Worked out independently in the folder's README.md, at 450, 550 and 630 nm.
TEST(NkTable, GivesTheReflectanceOfMeasuredMetals) {
  const std::filesystem::path folder =
      std::filesystem::path(GLINT_SHARED_DIR) / "data" / "field" / "nk";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no measured metals at " << folder;
  }
  const std::array<MetalRow, 8> rows = {{{"Al_McPeak", {0.922, 0.916, 0.907}},
                                         {"Al_Rakic", {0.922, 0.915, 0.908}},
                                         {"Cr_Johnson", {0.555, 0.555, 0.553}},
                                         {"Ni_Johnson", {0.571, 0.644, 0.690}},
                                         {"Fe_Johnson", {0.496, 0.512, 0.529}},
                                         {"Cu_Johnson", {0.538, 0.624, 0.915}},
                                         {"Ag_Johnson", {0.980, 0.983, 0.988}},
                                         {"Ti_Johnson", {0.544, 0.582, 0.612}}}};
  const std::array<double, 3> nm = {450, 550, 630};
  for (const MetalRow& row : rows) {
    const NkTable table = read_nk(folder / (std::string(row.name) + ".yml"));
    for (std::size_t i = 0; i < 3; ++i) {
      const RefractiveIndex index = table.at(nm[i]);
      EXPECT_NEAR(normal_reflectance(index.n, index.k), row.r0[i], 0.002) << row.name << nm[i];
    }
  }
}

}  // namespace
}  // namespace glint
