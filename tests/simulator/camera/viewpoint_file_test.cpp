// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/viewpoint_file.h"

#include <filesystem>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/csv.h"
#include "core/file.h"
#include "core/rng.h"

namespace glint {
namespace {

template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::string csv_error(const std::string& text) {
  return message_of([&] { parse_viewpoints_csv(text, "v.csv"); });
}

std::string json_error(const std::string& text) {
  return message_of([&] { parse_viewpoints_json(text, "v.json"); });
}

Viewpoint viewpoint_of(const ViewpointVector& v) {
  return {
      .position_mm = {v[0], v[1], v[2]}, .direction = {v[3], v[4], v[5]}, .up = {v[6], v[7], v[8]}};
}

/// Head line and one line each, with numbers that read back as the same.
std::string viewpoints_to_csv(const std::vector<Viewpoint>& viewpoints) {
  std::string text =
      "position_x_mm,position_y_mm,position_z_mm,direction_x,direction_y,direction_z,"
      "up_x,up_y,up_z\n";
  for (const Viewpoint& viewpoint : viewpoints) {
    text += std::apply([](const auto&... values) { return csv_row_of(values...); },
                       vector_of(viewpoint));
  }
  return text;
}

TEST(ViewpointFile, CsvTomlAndJsonSayTheSame) {
  const auto csv = parse_viewpoints_csv(
      "# two poses\n1,2,3, 0,0,-2, 0,5,0\r\n\n4,5,6,+1,0,0,0,0,1e0\n", "v.csv");
  const auto json = parse_viewpoints_json(
      R"([[1,2,3,0,0,-2,0,5,0],{"position_mm":[4,5,6],"direction":[1,0,0],"up":[0,0,1]}])",
      "v.json");
  std::vector<Problem> errors;
  const ConfigNode root = parse_toml(
      "[[viewpoint]]\nposition_mm=[1,2,3]\ndirection=[0,0,-2]\nup=[0,5,0]\n"
      "[[viewpoint]]\nposition_mm=[4,5,6]\ndirection=[1,0,0]\nup=[0,0,1]\n",
      "v.toml");
  const auto toml = read_viewpoint_list(*root.find("viewpoint"), errors);
  EXPECT_THAT(errors, ::testing::IsEmpty());
  ASSERT_EQ(csv.size(), 2U);
  ASSERT_EQ(json.size(), 2U);
  ASSERT_EQ(toml.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(vector_of(csv[i]), vector_of(json[i]));
    EXPECT_EQ(vector_of(csv[i]), vector_of(toml[i]));
  }
  EXPECT_EQ(vector_of(csv[0]), (ViewpointVector{1, 2, 3, 0, 0, -1, 0, 1, 0}));
}

TEST(ViewpointFile, CsvRoundTripKeepsEveryBit) {
  std::vector<Viewpoint> viewpoints;
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    ViewpointVector v;
    for (double& value : v) {
      value = rng.uniform(-300.0, 300.0);
    }
    viewpoints.push_back(normalised(viewpoint_of(v)));
  }
  const auto again = parse_viewpoints_csv(viewpoints_to_csv(viewpoints), "v.csv");
  ASSERT_EQ(again.size(), viewpoints.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    ASSERT_EQ(vector_of(again[i]), vector_of(viewpoints[i]));
  }
}

TEST(ViewpointFile, CsvErrorsNameLineAndColumn) {
  EXPECT_THAT(csv_error("1,2,3,0,0,-1,0,1\n"),
              ::testing::StartsWith("v.csv:1:1: viewpoint.0: has 8, must have nine numbers"));
  EXPECT_THAT(csv_error("0,0,9,0,0,-1,0,1,0\n1,2,nan,0,0,-1,0,1,0\n"),
              ::testing::StartsWith("v.csv:2:5: viewpoint.1.position_mm"));
  EXPECT_THAT(csv_error("1,2,3,0, inf,-1,0,1,0\n"), ::testing::StartsWith("v.csv:1:10: "));
  EXPECT_THAT(csv_error("1,2,3,0,0,-1,0,x,0\n"), ::testing::StartsWith("v.csv:1:16: "));
  EXPECT_THAT(csv_error("1,2,3,0,0,-1,0,,0\n"), ::testing::StartsWith("v.csv:1:16: "));
  EXPECT_THAT(csv_error("1,2,3,0,0,-1,0,0,7\n"),
              "v.csv:1:14: viewpoint.0.up: must not be zero or parallel to direction");
  EXPECT_THAT(csv_error("1,2,3,0,0,0,0,1,0\n"), ::testing::StartsWith("v.csv:1:"));
  EXPECT_THAT(csv_error("# nothing\n"), ::testing::HasSubstr("at least one"));
  EXPECT_THAT(csv_error("x,y,z,dx,dy,dz,ux,uy,uz\n"),
              ::testing::StartsWith("v.csv:1:1: column 'x' is not known here; columns are "));
}

TEST(ViewpointFile, EveryWrongLineIsReported) {
  const std::string text = csv_error("1,2\n0,0,9,0,0,-1,0,1,0\n3\n");
  EXPECT_THAT(text, ::testing::HasSubstr("v.csv:1:1: "));
  EXPECT_THAT(text, ::testing::HasSubstr("v.csv:3:1: "));
}

TEST(ViewpointFile, JsonErrorsNameLineAndColumn) {
  EXPECT_THAT(json_error("[\n [1,2,3]]"),
              ::testing::StartsWith("v.json:2:2: viewpoint.0: has 3, must have nine numbers"));
  EXPECT_THAT(json_error("[[1,2,3,0,0,-1,0,\n\"a\",0]]"), ::testing::StartsWith("v.json:2:1: "));
  EXPECT_THAT(json_error("[{\"up\":[0,0,3]}]"),
              "v.json:1:8: viewpoint.0.up: must not be zero or parallel to direction");
  EXPECT_THAT(json_error("[{\"upp\":[0,0,3]}]"), ::testing::HasSubstr("up"));
  EXPECT_THAT(json_error("{}"), ::testing::HasSubstr("viewpoint: missing"));
  EXPECT_THAT(json_error("[7]"), ::testing::HasSubstr("is a single value"));
}

TEST(ViewpointFile, EndingDecidesHowItIsRead) {
  const std::filesystem::path folder = ::testing::TempDir();
  const std::string row = "0,0,9,0,0,-1,0,1,0";
  write_file(folder / "glint_views.csv", row + "\n");
  write_file(folder / "glint_views.json", "{\"viewpoint\": [[" + row + "]]}");
  write_file(folder / "glint_views.toml", "viewpoint = [[" + row + "]]\n");
  for (const char* name : {"glint_views.csv", "glint_views.json", "glint_views.toml"}) {
    const auto viewpoints = read_viewpoints(folder / name);
    ASSERT_EQ(viewpoints.size(), 1U) << name;
    EXPECT_EQ(viewpoints[0].position_mm[2], 9.0);
    std::filesystem::remove(folder / name);
  }
  EXPECT_THAT(message_of([] { read_viewpoints("views.txt"); }),
              ::testing::StartsWith("viewpoints.file: "));
  EXPECT_THROW(read_viewpoints(folder / "glint_no_such.csv"), IoError);
}

TEST(Normalised, KeepsUnitVectorsBitForBit) {
  const Viewpoint once =
      normalised({.position_mm = {1, 2, 3}, .direction = {1, 2, -3}, .up = {0, 9, 1}});
  EXPECT_EQ(vector_of(normalised(once)), vector_of(once));
}

}  // namespace
}  // namespace glint
