// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/tools/line_sweep.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "defects/boolean/imprint_checks.h"
#include "defects/tools/line_frames.h"
#include "defects/tools/mesh_bend.h"
#include "defects/tools/tools.h"
#include "tests/defects/tools/tool_volume.h"

namespace glint {
namespace {

/// A helix on a cylinder about y through the origin, whose place is (0, 0, radius) with u towards
/// x, climbing by `rise` (radians). A negative radius is the inside of a tube below the place.
std::vector<SurfacePathPoint> cylinder_path(double radius_mm,
                                            double half_mm,
                                            double step_mm,
                                            double rise = 0.0) {
  std::vector<SurfacePathPoint> path;
  const int steps = static_cast<int>(std::ceil(half_mm / step_mm));
  for (int i = -steps; i <= steps; ++i) {
    const double arc = half_mm * i / steps;
    const double turn = arc * std::cos(rise) / radius_mm;
    const Eigen::Vector3d normal(std::sin(turn), 0.0, std::cos(turn));
    const Eigen::Vector3d around(std::cos(turn), 0.0, -std::sin(turn));
    path.push_back(
        {.arc_mm = arc,
         .point_mm = radius_mm * normal + Eigen::Vector3d(0.0, arc * std::sin(rise), 0.0),
         .normal = normal,
         .tangent = std::cos(rise) * around + std::sin(rise) * Eigen::Vector3d::UnitY()});
  }
  return path;
}

/// A path over a roof: two planes that meet at the place at an angle; positive bends away.
std::vector<SurfacePathPoint> roof_path(double half_mm, double bend_rad) {
  std::vector<SurfacePathPoint> path;
  for (int i = -20; i <= 20; ++i) {
    const double turn = i < 0 ? -0.5 * bend_rad : (i > 0 ? 0.5 * bend_rad : 0.0);
    const Eigen::Vector3d tangent(std::cos(turn), 0.0, -std::sin(turn));
    const double arc = half_mm * i / 20.0;
    path.push_back({.arc_mm = arc,
                    .point_mm = arc * tangent,
                    .normal = {std::sin(turn), 0.0, std::cos(turn)},
                    .tangent = tangent});
  }
  return path;
}

/// A tool on the cylinder as if the surface were rolled out flat.
TriangleMesh rolled_out(TriangleMesh tool, double radius_mm) {
  for (Eigen::Vector3d& p : tool.vertices_mm) {
    p = {radius_mm * std::atan2(p.x(), p.z()), p.y(), std::hypot(p.x(), p.z()) - radius_mm};
  }
  return tool;
}

const SurfacePlace kFlat = {};

// Sections are triangles of width w s and depth h s, s = 1 - x^6:
// w h / 2 L int_0^1 (1 - x^6)^2 dx = w h L / 2 (1 - 2/7 + 1/13) = 0.791209 w h L / 2.
TEST(LineTool, StraightScratchHasItsVolume) {
  const LineTool shape = {.length_mm = 4.0, .width_mm = 0.2, .depth_mm = 0.05, .level = 5};
  const TriangleMesh tool = line_tool(shape, LineFrames({}, kFlat));
  const double exact = 0.5 * 0.2 * 0.05 * 4.0 * (1.0 - 2.0 / 7.0 + 1.0 / 13.0);
  EXPECT_NEAR(flat_cut(tool).volume_mm3, exact, 0.002 * exact);
  // Opening: int w s dx = w L (1 - 1/7).
  EXPECT_NEAR(flat_cut(tool).opening_mm2, 0.2 * 4.0 * 6.0 / 7.0, 0.002);
  EXPECT_EQ(lowest_z_mm(tool), -0.05);
  EXPECT_EQ(tool_fault(tool), "");
}

// s = 1 - x^2, parabolas of width w sqrt(s): an elliptic paraboloid, pi (L/2) (w/2) h / 2.
TEST(LineTool, GougeIsAnEllipticParaboloid) {
  const LineTool shape = {
      .length_mm = 6.0, .width_mm = 1.0, .depth_mm = 0.2, .section = 2.0, .taper = 2.0, .level = 5};
  const TriangleMesh tool = line_tool(shape, LineFrames({}, kFlat));
  const double exact = kPi * 3.0 * 0.5 * 0.2 / 2.0;
  EXPECT_NEAR(flat_cut(tool).volume_mm3, exact, 0.005 * exact);
  EXPECT_NEAR(flat_cut(tool).opening_mm2, kPi * 3.0 * 0.5, 0.005 * kPi * 1.5);
  EXPECT_EQ(lowest_z_mm(tool), -0.2);
}

// Rolled out, the scratch around a cylinder is the straight one. A straight blade of 10 mm would
// leave the surface of 20 mm radius by L^2 / (8 R) = 0.625 mm at its ends.
TEST(LineTool, ScratchAroundACylinderKeepsItsDepth) {
  const LineTool shape = {.length_mm = 10.0, .width_mm = 0.2, .depth_mm = 0.02, .level = 5};
  const auto path = cylinder_path(20.0, 6.0, 0.005);
  const LineFrames frames(path, kFlat);
  const TriangleMesh flat = rolled_out(line_tool(shape, frames), 20.0);
  const double exact = 0.5 * 0.2 * 0.02 * 10.0 * (1.0 - 2.0 / 7.0 + 1.0 / 13.0);
  EXPECT_NEAR(flat_cut(flat).volume_mm3, exact, 0.003 * exact);
  EXPECT_NEAR(lowest_z_mm(flat), -0.02, 1e-6);
  // The deepest point of every section: h (1 - x^6).
  const std::size_t points = 2 * 16 + 1 + 3;
  for (std::size_t i = 16; i + 2 < flat.vertices_mm.size(); i += points) {
    const Eigen::Vector3d& p = flat.vertices_mm[i];
    EXPECT_NEAR(p.z(), -0.02 * (1.0 - std::pow(std::abs(p.x()) / 5.0, 6)), 1e-6) << p.x();
  }
}

// Inside the tool's own frame volume is (1 + z / R) per volume rolled out: with sections of area A
// and first moment -w h^2 s^3 / 6 the part loses V0 - (w h^2 L / 6 R) int (1 - x^6)^3 dx.
TEST(LineTool, VolumeOnACylinderMatchesTheClosedForm) {
  const double h = 0.5;
  const LineTool shape = {.length_mm = 4.0, .width_mm = 0.6, .depth_mm = h, .level = 6};
  const auto path = cylinder_path(5.0, 3.0, 0.002);
  const TriangleMesh tool = line_tool(shape, LineFrames(path, kFlat));
  // int (1 - x^6)^3 dx = 1 - 3/7 + 3/13 - 1/19.
  const double v0 = 0.5 * 0.6 * h * 4.0 * (1.0 - 2.0 / 7.0 + 1.0 / 13.0);
  const double cube = 1.0 - 3.0 / 7.0 + 3.0 / 13.0 - 1.0 / 19.0;
  const double exact = v0 - 0.6 * h * h * 4.0 / (6.0 * 5.0) * cube;
  // Volume below the cylinder of the tool: rolled out, each piece weighted with 1 + z / R, that is
  // the flux of (0, 0, z + z^2 / 2R) through what lies below.
  const TriangleMesh flat = rolled_out(tool, 5.0);
  double volume = 0.0;
  for (std::size_t i = 0; i < flat.num_triangles(); ++i) {
    const Eigen::Vector3d c = (flat.vertex(i, 0) + flat.vertex(i, 1) + flat.vertex(i, 2)) / 3.0;
    if (c.z() < 0.0) {
      volume += area_vector(flat, i).z() * (c.z() + c.z() * c.z() / 10.0);
    }
  }
  EXPECT_NEAR(volume, exact, 0.005 * exact);
}

TEST(LineTool, EndsAtItsDepthWithNoise) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const LineTool shape = {.length_mm = 3.0,
                            .width_mm = 0.3,
                            .depth_mm = 0.01,
                            .section = seed % 2 == 0 ? 1.0 : 2.0,
                            .taper = seed % 2 == 0 ? 6.0 : 2.0,
                            .roughness = 0.3,
                            .lean = 0.5,
                            .seed = seed};
    const TriangleMesh tool = line_tool(shape, LineFrames({}, kFlat));
    EXPECT_NEAR(lowest_z_mm(tool), -0.01, 1e-15);
    EXPECT_EQ(tool_fault(tool), "");
    EXPECT_FALSE(same_bytes(tool,
                            line_tool(
                                [&] {
                                  LineTool other = shape;
                                  other.seed = seed + 1;
                                  return other;
                                }(),
                                LineFrames({}, kFlat))));
  }
}

TEST(LineTool, IsSoundForAThousandRandomShapesAndPaths) {
  Rng rng(21, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const bool is_gouge = rng.uniform() < 0.4;
    const LineTool shape = {.length_mm = 0.1 * std::pow(400.0, rng.uniform()),
                            .width_mm = 0.02 * std::pow(250.0, rng.uniform()),
                            .depth_mm = 5e-4 * std::pow(4000.0, rng.uniform()),
                            .section = is_gouge ? 2.0 : 1.0,
                            .taper = is_gouge ? 2.0 : 6.0,
                            .roughness = rng.uniform(0.0, 0.5),
                            .lean = rng.uniform(-1.0, 1.0),
                            .level = 1 + (i / 4) % 2,
                            .seed = rng.next_u32()};
    const double size = std::max(shape.width_mm, shape.depth_mm);
    const double radius = size * 0.3 * std::pow(1000.0, rng.uniform());
    const double half = 0.6 * shape.length_mm;
    const double rise = rng.uniform(-1.5, 1.5);
    const std::vector<SurfacePathPoint> path =
        i % 4 == 3 ? roof_path(half, rng.uniform(-1.5, 1.5))
                   : cylinder_path(i % 2 == 0 ? radius : -radius, half, half / 200.0, rise);
    const TriangleMesh tool = line_tool(shape, LineFrames(path, kFlat));
    ASSERT_EQ(tool_fault(tool), "")
        << i << ": length " << shape.length_mm << " width " << shape.width_mm << " depth "
        << shape.depth_mm << " radius " << radius << " rise " << rise;
  }
}

TEST(LineTool, IsSoundAtTheEndsOfTheRanges) {
  struct Size {
    double length, width, depth;
  };

  for (const Size size : {Size{40.0, 0.05, 0.01},
                          Size{40.0, 0.05, 5e-4},
                          Size{40.0, 5.0, 5e-4},
                          Size{0.1, 1.0, 0.01},
                          Size{0.05, 0.05, 5.0},
                          Size{1000.0, 1e-3, 1e-7}}) {
    for (const double radius : {0.1, 3.0, -0.1, -3.0, 1e6}) {
      const LineTool shape = {.length_mm = size.length,
                              .width_mm = size.width,
                              .depth_mm = size.depth,
                              .roughness = 0.15};
      const auto path = cylinder_path(radius, 0.6 * size.length, size.length / 500.0);
      EXPECT_EQ(tool_fault(line_tool(shape, LineFrames(path, kFlat))), "")
          << size.length << " x " << size.width << " x " << size.depth << " on " << radius;
    }
  }
}

// Around a cylinder of 2 mm a line of 40 mm would meet itself after 12.6 mm: it is cut to 2.75
// radians on each side.
TEST(LineFrames, CutsAPathThatGoesAroundThePart) {
  const auto path = cylinder_path(2.0, 24.0, 0.02);
  const LineFrames frames(path, kFlat);
  EXPECT_NEAR(frames.half_length_mm(), 5.5, 0.02);
  EXPECT_NEAR(frames.largest_bend_per_mm(), 0.5, 1e-9);
  const TriangleMesh tool =
      line_tool({.length_mm = 40.0, .width_mm = 0.1, .depth_mm = 0.01}, frames);
  EXPECT_EQ(tool_fault(tool), "");
}

TEST(LineFrames, GoesStraightOnBeyondThePath) {
  const auto path = cylinder_path(10.0, 1.0, 0.01);
  const LineFrame frame = LineFrames(path, kFlat).at(3.0, 0.0);
  const Eigen::Vector3d expected = path.back().point_mm + 2.0 * path.back().tangent;
  EXPECT_LT((frame.point_mm - expected).norm(), 1e-12);
  EXPECT_LT((frame.across - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(LineFrames, AveragingKeepsTheFrameOfACircle) {
  const auto path = cylinder_path(10.0, 5.0, 0.01);
  const LineFrames frames(path, kFlat);
  const LineFrame plain = frames.at(1.0, 0.0);
  const LineFrame smooth = frames.at(1.0, 2.0);
  EXPECT_LT((plain.normal - smooth.normal).norm(), 1e-6);
  EXPECT_LT((plain.tangent - smooth.tangent).norm(), 1e-6);
}

// A square bar, 12 triangles, bent around a cylinder of 10 mm: its axis keeps its length, so its
// volume is area times length by Pappus when the section is centred on the surface.
TEST(BentAlong, CutsCoarseMeshesSoThatTheyFollow) {
  const TriangleMesh bar = box_mesh({-5.0, -0.5, -0.5}, {5.0, 0.5, 0.5});
  ASSERT_EQ(tool_fault(bar), "");
  ASSERT_NEAR(enclosed_volume_mm3(bar), 10.0, 1e-12);
  const auto path = cylinder_path(10.0, 6.0, 0.002);
  const TriangleMesh bent = bent_along(bar, LineFrames(path, kFlat), 0.05, 0.5);
  EXPECT_EQ(tool_fault(bent), "");
  EXPECT_NEAR(enclosed_volume_mm3(bent), 10.0, 1e-3);
  for (const Eigen::Vector3d& p : bent.vertices_mm) {
    const double radius = std::hypot(p.x(), p.z());
    EXPECT_GT(radius, 9.5 - 1e-6);
    EXPECT_LT(radius, 10.5 + 1e-6);
  }
}

}  // namespace
}  // namespace glint
