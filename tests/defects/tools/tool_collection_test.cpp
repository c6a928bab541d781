// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/rng.h"
#include "core/units.h"
#include "defects/boolean/imprint_checks.h"
#include "defects/tools/custom_tools.h"
#include "defects/tools/round_tool.h"
#include "defects/tools/tools.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "tests/defects/tools/tool_volume.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

/// A folder of its own for every test.
std::filesystem::path fresh_folder() {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / (std::string("glint_tools_") + info->name());
  std::filesystem::remove_all(folder);
  make_folder(folder);
  return folder;
}

/// A box from -x..x, -y..y, -below..above.
TriangleMesh box_tool(double x, double y, double below, double above) {
  return box_mesh({-x, -y, -below}, {x, y, above});
}

std::string reason_of(const DefectGroup& group) {
  try {
    const ToolCollection tools("dents", group);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CustomTools, AreTakenInTheOrderOfTheirNamesFromAllFormats) {
  const auto folder = fresh_folder();
  for (const char* name : {"c.stl", "a.ply", "d.obj", "b.off"}) {
    write_mesh(folder / name, box_tool(1.0, 1.0, 1.0, 1.0));
  }
  write_file(folder / "readme.txt", "not a tool");
  const ToolCollection tools("dents", {.tool_folder = folder});
  EXPECT_THAT(tools.names(), ::testing::ElementsAre("a.ply", "b.off", "c.stl", "d.obj"));
  std::set<std::string> chosen;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    EXPECT_EQ(tools.choose(seed), tools.choose(seed));
    chosen.insert(tools.choose(seed));
  }
  EXPECT_EQ(chosen.size(), 4U);
  EXPECT_EQ(ToolCollection("pits", {.type = DefectType::kPit}).choose(3), "pit");
}

TEST(CustomTools, RefusesFoldersWithoutTools) {
  const auto folder = fresh_folder();
  write_file(folder / "readme.txt", "not a tool");
  EXPECT_THAT(reason_of({.tool_folder = folder}), HasSubstr("defects.dents.tool_folder: "));
  EXPECT_THAT(reason_of({.tool_folder = folder}), HasSubstr("holds no tool"));
  EXPECT_THAT(reason_of({.tool_folder = folder / "missing"}), HasSubstr("cannot read the folder"));
}

TEST(CustomTools, RefusesUnusableMeshesWithFileAndReason) {
  const TriangleMesh good = box_tool(1.0, 1.0, 1.0, 1.0);
  TriangleMesh open = good;
  open.triangles.pop_back();
  TriangleMesh inside_out = good;
  for (Triangle& t : inside_out.triangles) {
    std::swap(t[0], t[1]);
  }
  TriangleMesh crossing = good;
  crossing.vertices_mm[0] = {3.0, 3.0, 3.0};
  for (const TriangleMesh& bad : {open, inside_out, crossing}) {
    const auto folder = fresh_folder();
    write_mesh(folder / "good.ply", good);
    ASSERT_EQ(reason_of({.tool_folder = folder}), "accepted");
    write_mesh(folder / "bad.ply", bad);
    EXPECT_THAT(reason_of({.tool_folder = folder}), HasSubstr("bad.ply: cannot be a tool: "));
  }
  const auto folder = fresh_folder();
  write_mesh(folder / "high.ply", box_tool(1.0, 1.0, -0.5, 1.0));
  EXPECT_THAT(reason_of({.tool_folder = folder}), HasSubstr("nothing of it lies below"));
  const auto other = fresh_folder();
  write_mesh(other / "low.ply", box_tool(1.0, 1.0, 1.0, 0.0));
  EXPECT_THAT(reason_of({.tool_folder = other}), HasSubstr("nothing of it lies above"));
  const auto garbage = fresh_folder();
  write_file(garbage / "x.ply", "ply\ngarbage");
  EXPECT_THAT(reason_of({.tool_folder = garbage}), HasSubstr("x.ply"));
}

// A box of 2 x 1 and 4 deep, 1 high, for an opening of 0.5: scaled by 0.25 to 0.5 x 0.25; 0.02
// deep; above drawn out to 0.25.
TEST(CustomTools, AreScaledToSizeAndDepth) {
  TriangleMesh box = box_tool(1.0, 0.5, 4.0, 1.0);
  for (Eigen::Vector3d& p : box.vertices_mm) {
    p += Eigen::Vector3d(10.0, 20.0, 0.0);
  }
  const TriangleMesh scaled = scaled_tool(box, {.across_mm = 0.5, .depth_mm = 0.02});
  const BoundingBox size = bounding_box(scaled);
  EXPECT_LT((size.min_mm - Eigen::Vector3d(-0.25, -0.125, -0.02)).norm(), 1e-12);
  EXPECT_LT((size.max_mm - Eigen::Vector3d(0.25, 0.125, 0.25)).norm(), 1e-12);
  const TriangleMesh line =
      scaled_tool(box, {.along_mm = 3.0, .across_mm = 0.2, .depth_mm = 0.02, .is_line = true});
  EXPECT_NEAR(bounding_box(line).size_mm().x(), 3.0, 1e-12);
  EXPECT_NEAR(bounding_box(line).size_mm().y(), 0.2, 1e-12);
}

TEST(CustomTools, BumpsKeepTheirSide) {
  const auto folder = fresh_folder();
  write_mesh(folder / "bump.ply", box_tool(1.0, 1.0, 0.5, 2.0));
  const ToolCollection tools("bumps", {.type = DefectType::kBump, .tool_folder = folder});
  Defect defect;
  defect.type = DefectType::kBump;
  defect.diameter_mm = 1.0;
  defect.depth_mm = 0.1;
  defect.tool = "bump.ply";
  const TriangleMesh tool = tools.tool(defect);
  EXPECT_EQ(bounding_box(tool).max_mm.z(), 0.1);
  EXPECT_EQ(lowest_z_mm(tool), -0.5);
  EXPECT_EQ(tool_fault(tool), "");
}

TEST(CustomTools, RefusesANameThatIsNotThere) {
  const auto folder = fresh_folder();
  write_mesh(folder / "a.ply", box_tool(1.0, 1.0, 1.0, 1.0));
  const ToolCollection tools("dents", {.tool_folder = folder});
  Defect defect;
  defect.diameter_mm = 1.0;
  defect.depth_mm = 0.1;
  defect.tool = "b.ply";
  EXPECT_THROW(tools.tool(defect), ConfigError);
}

/// Twelve triangles along a quarter of a cylinder: depth from the axis is the same everywhere.
TEST(CustomTools, LinesFollowTheSurface) {
  const auto folder = fresh_folder();
  write_mesh(folder / "bar.stl", box_tool(5.0, 0.5, 0.5, 0.5));
  const ToolCollection tools("scratches", {.type = DefectType::kScratch, .tool_folder = folder});
  std::vector<SurfacePathPoint> path;
  for (int i = -800; i <= 800; ++i) {
    const double turn = 0.001 * i;
    path.push_back({.arc_mm = 10.0 * turn,
                    .point_mm = {10.0 * std::sin(turn), 0.0, 10.0 * std::cos(turn)},
                    .normal = {std::sin(turn), 0.0, std::cos(turn)},
                    .tangent = {std::cos(turn), 0.0, -std::sin(turn)}});
  }
  Defect defect;
  defect.type = DefectType::kScratch;
  defect.length_mm = 12.0;
  defect.width_mm = 0.4;
  defect.depth_mm = 0.03;
  defect.tool = "bar.stl";
  const TriangleMesh tool = tools.tool(defect, path);
  EXPECT_EQ(tool_fault(tool), "");
  double lowest = 1e300;
  double furthest = 0.0;
  for (const Eigen::Vector3d& p : tool.vertices_mm) {
    lowest = std::min(lowest, std::hypot(p.x(), p.z()));
    furthest = std::max(furthest, std::abs(std::atan2(p.x(), p.z())));
  }
  // Chords of the path: 0.01^2 / 80 = 1.25e-6.
  EXPECT_NEAR(lowest, 10.0 - 0.03, 2e-6);
  EXPECT_NEAR(furthest, 0.6, 1e-9);
  // Straight without a path.
  const TriangleMesh straight = tools.tool(defect);
  EXPECT_EQ(straight.num_triangles(), 12U);
  EXPECT_NEAR(lowest_z_mm(straight), -0.03, 1e-15);
}

// A tool of a thousand random own shapes: rough balls lifted or lowered, as dents, bumps, lines.
TEST(CustomTools, AreSoundWhateverTheirSizeAndPlace) {
  const auto folder = fresh_folder();
  for (int i = 0; i < 5; ++i) {
    TriangleMesh mesh = round_tool({.diameter_mm = 2.0,
                                    .depth_mm = 0.5 + i,
                                    .roughness = 0.3,
                                    .level = 2,
                                    .seed = static_cast<std::uint64_t>(i)});
    write_mesh(folder / (std::to_string(i) + ".ply"), mesh);
  }
  const ToolCollection dents("dents", {.tool_folder = folder});
  const ToolCollection lines("lines", {.type = DefectType::kGouge, .tool_folder = folder});
  Rng rng(31, Stream::kTest, 0);
  for (int i = 0; i < 300; ++i) {
    Defect defect;
    defect.type = i % 3 == 0 ? DefectType::kGouge : DefectType::kDent;
    defect.diameter_mm = defect.length_mm = rng.uniform(0.1, 5.0);
    defect.width_mm = 0.1 + 0.3 * defect.length_mm;
    defect.depth_mm = 1e-3 * std::pow(1e3, rng.uniform());
    defect.tilt_rad = rng.uniform(0.0, 0.7);
    defect.tilt_direction_rad = rng.uniform(-kPi, kPi);
    const ToolCollection& tools = i % 3 == 0 ? lines : dents;
    defect.tool = tools.choose(rng.next_u32());
    const TriangleMesh tool =
        tools.tool(defect, {}, {.along_per_mm = rng.uniform(-0.2, 0.2), .across_per_mm = 0.1});
    ASSERT_EQ(tool_fault(tool), "") << i;
  }
}

}  // namespace
}  // namespace glint
