// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/named_surfaces.h"

#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/exr_layers.h"
#include "core/units.h"
#include "studies/compare/surface/surface_lines.h"
#include "studies/compare/surface/surface_shape.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;

// The shapes of the names have exact points: nothing is left of a fit.
TEST(ShapeName, SaysWhatAnEngineerWould) {
  const auto of = [](const std::function<PointWithNormal(double, double)>& at) {
    std::vector<PointWithNormal> points;
    for (int i = 0; i < 20; ++i) {
      for (int j = 0; j < 20; ++j) {
        points.push_back(at(i / 19.0, j / 19.0));
      }
    }
    return shape_name(points, 0.05);
  };
  const auto ring = [](double angle) { return Vector3d(std::cos(angle), std::sin(angle), 0.0); };
  EXPECT_EQ(of([](double u, double v) {
              return PointWithNormal{{10.0 * u, 5.0 * v, 7.0}, Vector3d::UnitZ()};
            }),
            "plane facing +z at z = 7.0 mm");
  EXPECT_EQ(of([](double u, double v) {
              return PointWithNormal{{10.0 * u, 5.0 * v, -5.0 * v}, Vector3d(0, 1, 1).normalized()};
            }),
            "plane facing (0.00, 0.71, 0.71)");
  EXPECT_EQ(of([&](double u, double v) {
              return PointWithNormal{18.0 * ring(u) + Vector3d(3, 4, 9.0 * v), ring(u)};
            }),
            "cylinder of radius 18.0 mm along z");
  EXPECT_EQ(of([&](double u, double v) {
              return PointWithNormal{5.0 * ring(3.0 * u) + Vector3d(0, 0, 9.0 * v), -ring(3.0 * u)};
            }),
            "bore of radius 5.0 mm along z");
  EXPECT_EQ(of([&](double u, double v) {
              const Vector3d n = std::cos(v) * ring(u) + std::sin(v) * Vector3d::UnitZ();
              return PointWithNormal{36.0 * n, n};
            }),
            "sphere of radius 36.0 mm");
  EXPECT_EQ(of([&](double u, double v) {
              const Vector3d n = (ring(2.0 * u) + Vector3d::UnitZ()).normalized();
              return PointWithNormal{(5.0 + 9.0 * v) * ring(2.0 * u) - Vector3d(0, 0, 9.0 * v), n};
            }),
            "cone about z");
  // A saddle that is hardly tilted anywhere is none.
  EXPECT_EQ(of([](double u, double v) {
              const Vector3d n = Vector3d(-0.3 * u, 0.3 * v, 1.0).normalized();
              return PointWithNormal{{10.0 * u, 10.0 * v, 1.5 * (u * u - v * v)}, n};
            }),
            "curved surface");
}

// Five facets of 15 degrees: the cylinder that their edges lie on has the radius 18.
TEST(ShapeName, OfFacetsHasTheRadiusOfTheirEdges) {
  constexpr double kStep_rad = 15.0 * kRadPerDeg;
  std::vector<PointWithNormal> points;
  for (int facet = 0; facet < 5; ++facet) {
    const Vector3d n(std::cos(facet * kStep_rad), std::sin(facet * kStep_rad), 0.0);
    for (int i = 0; i < 80; ++i) {
      const double part = 2.0 * (i % 10) / 9.0 - 1.0;  // from edge to edge
      points.push_back({18.0 * std::cos(0.5 * kStep_rad) * n +
                            18.0 * std::sin(0.5 * kStep_rad) * part * Vector3d::UnitZ().cross(n) +
                            Vector3d(3.0, 4.0, i / 10),
                        n});
    }
  }
  EXPECT_EQ(shape_name(points, 0.05, kStep_rad),
            "cylinder of radius 18.0 mm along z in facets of 15 deg");
}

class FoundSurfaces : public CompareFiles {
 protected:
  /// A view straight down at 0.1 mm a pixel, 100 x 80 pixels, from 1000 mm above z = 0.
  SimulatedSurface seen(const std::function<std::optional<PointWithNormal>(double, double)>& at) {
    std::vector<ImageF> images(7, ImageF(100, 80));
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 100; ++x) {
        if (const auto point = at(0.1 * (x + 0.5), 0.1 * (y + 0.5))) {
          for (std::size_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<Eigen::Index>(k);
            images[k](x, y) = static_cast<float>(point->at_mm[axis]);
            images[3 + k](x, y) = static_cast<float>(point->normal[axis]);
          }
          images[6](x, y) = static_cast<float>(1000.0 - point->at_mm.z());
        }
      }
    }
    constexpr std::array<const char*, 7> kNames = {"position_mm.x",
                                                   "position_mm.y",
                                                   "position_mm.z",
                                                   "normal.x",
                                                   "normal.y",
                                                   "normal.z",
                                                   "depth_mm"};
    std::vector<ExrChannel> channels;
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      channels.push_back(exr_channel(kNames[k], images[k]));
    }
    write_exr_channels(folder() / "geometry.exr", 100, 80, channels);
    return {folder() / "geometry.exr", 100, 80, RigidTransform{}};
  }

  static constexpr double kFocal_px = 10'000.0;
};

// A plate from pixel 20 on whose top meets a slope of 30 degrees at pixel 30, with something beside
// it up to pixel 14; without both nothing is near its edge.
TEST_F(FoundSurfaces, TellHowFarTheNextEdgeIs) {
  const Vector3d slope = Vector3d(std::sin(0.5236), 0.0, std::cos(0.5236));
  const auto plate = [&](double other_mm, double crease_mm) {
    return seen([=](double x, double y) -> std::optional<PointWithNormal> {
      if (x > other_mm && x < 2.0) {
        return std::nullopt;
      }
      const double down_mm = std::max(0.0, x - crease_mm) * std::tan(0.5236);
      return PointWithNormal{{x, y, 3.0 - down_mm}, x < crease_mm ? Vector3d::UnitZ() : slope};
    });
  };
  const Eigen::Vector2d edge_px(20.0, 40.5);
  const Eigen::Vector2d outside = -Eigen::Vector2d::UnitX();
  const SimulatedSurface creased = plate(0.0, 3.0);
  EXPECT_NEAR(creased.free_px(edge_px, outside, 18.0), 10.0, 1.0);
  EXPECT_TRUE(std::isinf(creased.free_px(edge_px, outside, 8.0))) << "not within the reach";
  EXPECT_NEAR(plate(1.4, 3.0).free_px(edge_px, outside, 18.0), 6.0, 1.0);
  EXPECT_TRUE(std::isinf(plate(0.0, 20.0).free_px(edge_px, outside, 18.0)));
}

// A step of 1 mm, a roof of 30 degrees, and a cylinder that turns by 77 degrees to its limb.
TEST_F(FoundSurfaces, EndAtStepsAndCreasesButNotWhereTheyBendSlowly) {
  const NamedSurfaces step =
      find_surfaces(seen([](double x, double y) {
                      return PointWithNormal{{x, y, x < 6.0 ? 3.0 : 2.0}, Vector3d::UnitZ()};
                    }),
                    kFocal_px);
  EXPECT_THAT(step.names,
              ElementsAre("plane facing +z at z = 3.0 mm", "plane facing +z at z = 2.0 mm"));
  const Vector3d slope = Vector3d(std::sin(0.5236), 0.0, std::cos(0.5236));
  const NamedSurfaces roof = find_surfaces(
      seen([&](double x, double y) {
        return x < 6.0 ? PointWithNormal{{x, y, 3.0}, Vector3d::UnitZ()}
                       : PointWithNormal{{x, y, 3.0 - std::tan(0.5236) * (x - 6.0)}, slope};
      }),
      kFocal_px);
  EXPECT_THAT(roof.names,
              ElementsAre("plane facing +z at z = 3.0 mm", "plane facing (0.50, 0.00, 0.87)"));
  const NamedSurfaces round =
      find_surfaces(seen([](double x, double y) -> std::optional<PointWithNormal> {
                      const double across = (x - 5.0) / 4.0;
                      if (std::abs(across) >= 0.975) {
                        return std::nullopt;
                      }
                      const Vector3d n(across, 0.0, std::sqrt(1.0 - across * across));
                      return PointWithNormal{4.0 * n + Vector3d(5.0, y, 0.0), n};
                    }),
                    kFocal_px);
  EXPECT_THAT(round.names, ElementsAre("cylinder of radius 4.0 mm along y"));
}

/// Seen from the side: a regular prism of so many sides about y, a corner of it to either side of
/// the middle where a side lies flat on top. Nothing beside it.
std::optional<PointWithNormal> on_prism(double x, double y, int around, double corner_mm) {
  const double step = 2.0 * kPi / around;
  const double apothem_mm = corner_mm * std::cos(0.5 * step);
  const double across = x - 5.0;
  double top = 100.0;
  Vector3d normal = Vector3d::UnitZ();
  for (int i = -around / 4; i <= around / 4; ++i) {
    const Vector3d n(std::sin(i * step), 0.0, std::cos(i * step));
    const double z = n.z() > 1e-9 ? (apothem_mm - across * n.x()) / n.z() : 100.0;
    normal = z < top ? n : normal;
    top = std::min(top, z);
  }
  return top > 0.0 && std::abs(across) < corner_mm
             ? std::optional(PointWithNormal{{x, y, top}, normal})
             : std::nullopt;
}

/// The mean over a pixel and a half: at their edges facets mix.
std::optional<PointWithNormal> mixed_on_prism(double x, double y, int around, double corner_mm) {
  PointWithNormal mean = {.normal = Vector3d::Zero()};
  double count = 0.0;
  for (int i = -5; i <= 5; ++i) {
    if (const auto point = on_prism(x + 0.015 * i, y, around, corner_mm)) {
      mean.at_mm += point->at_mm;
      mean.normal += point->normal;
      count += 1.0;
    }
  }
  if (count < 6.0) {
    return std::nullopt;
  }
  return PointWithNormal{mean.at_mm / count, mean.normal.normalized()};
}

// What an STL file has of a turned part is one cylinder for 24 and for 12 facets, without a line
// within; the sides of a hexagonal bar are planes.
TEST_F(FoundSurfaces, JoinFacetsOfACylinderButNotOfANut) {
  const auto seen_prism = [&](int around) {
    return find_surfaces(
        seen([=](double x, double y) { return mixed_on_prism(x, y, around, 4.0); }), kFocal_px);
  };
  const NamedSurfaces fine = seen_prism(24);
  EXPECT_THAT(fine.names, ElementsAre("cylinder of radius 4.0 mm along y in facets of 15 deg"));
  EXPECT_TRUE(lines_between(fine).empty());
  const NamedSurfaces coarse = seen_prism(12);
  EXPECT_THAT(coarse.names, ElementsAre("cylinder of radius 4.0 mm along y in facets of 30 deg"));
  EXPECT_TRUE(lines_between(coarse).empty());
  const NamedSurfaces nut = seen_prism(6);
  EXPECT_THAT(nut.names,
              ElementsAre("plane facing +z at z = 3.5 mm",
                          "plane facing (-0.87, 0.00, 0.50)",
                          "plane facing (0.87, 0.00, 0.50)"));
}

// A box with chamfers of 45 degrees stays three planes.
TEST_F(FoundSurfaces, KeepChamfers) {
  const double s = std::sqrt(0.5);
  const NamedSurfaces box = find_surfaces(
      seen([&](double x, double y) {
        const double side = x < 3.0 ? -1.0 : 1.0;
        const double into = x < 3.0 ? 3.0 - x : x - 7.0;
        return into <= 0.0 ? PointWithNormal{{x, y, 3.0}, Vector3d::UnitZ()}
                           : PointWithNormal{{x, y, 3.0 - into}, Vector3d(side * s, 0.0, s)};
      }),
      kFocal_px);
  EXPECT_THAT(box.names,
              ElementsAre("plane facing +z at z = 3.0 mm",
                          "plane facing (-0.71, 0.00, 0.71)",
                          "plane facing (0.71, 0.00, 0.71)"));
}

// One line where both planes of the step meet, its normal to the smaller one.
TEST_F(FoundSurfaces, MeetInOneLine) {
  const NamedSurfaces step =
      find_surfaces(seen([](double x, double y) {
                      return PointWithNormal{{x, y, x < 6.0 ? 3.0 : 2.0}, Vector3d::UnitZ()};
                    }),
                    kFocal_px);
  const std::vector<SurfaceLine> lines = lines_between(step);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].from, 1);
  EXPECT_EQ(lines[0].to, 2);
  for (const BoundaryPoint& point : lines[0].line.points) {
    EXPECT_NEAR(point.at_px.x(), 60.0, 1.6);
    EXPECT_NEAR(point.normal.x(), 1.0, 0.5);
  }
}

}  // namespace
}  // namespace glint
