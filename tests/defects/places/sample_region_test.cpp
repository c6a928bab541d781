// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where random defects may lie: distances and regions.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/rng.h"
#include "defects/places/sample_distance.h"
#include "tests/defects/places/sampler_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;
using Kind = DefectRegion::Kind;

TEST(DefectSampler, RimsKeepTheirDistance) {
  DefectGroup round = sampler_dents(40);
  DefectGroup line = sampler_dents(20);
  line.type = DefectType::kScratch;
  line.angle_rad = {-3.0, 3.0};
  const auto min_distance_mm = [&](double apart_mm) {
    round.min_distance_mm = line.min_distance_mm = apart_mm;
    double minimum = std::numeric_limits<double>::infinity();
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const std::vector<Defect> defects =
          Sampled(sampler_plate(), {{"dents", round}, {"scratches", line}}).all(seed);
      EXPECT_EQ(defects.size(), 60U);
      for (std::size_t i = 0; i < defects.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
          minimum = std::min(minimum, rim_distance(defects[i], defects[k]));
        }
      }
    }
    return minimum;
  };
  EXPECT_GE(min_distance_mm(0.7), 0.7);
  EXPECT_LT(min_distance_mm(0.0), 0.0);
}

// Centres 5 mm apart. Round ones of 1 mm: 4 mm between the rims. A scratch along the line between
// them, 3 mm long and 1 mm wide, reaches 1.5 mm: 5 - 1.5 - 0.5; across it: 5 - 0.5 - 0.5.
TEST(RimDistance, IsWorkedByHand) {
  Defect a;
  a.diameter_mm = 1.0;
  Defect b = a;
  b.place.centre_mm = {5.0, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(rim_distance(a, b), 4.0);
  b.type = DefectType::kScratch;
  b.length_mm = 3.0;
  b.width_mm = 1.0;
  EXPECT_DOUBLE_EQ(rim_distance(a, b), 3.0);
  b.place.u_axis = Vector3d::UnitY();
  EXPECT_DOUBLE_EQ(rim_distance(a, b), 4.0);
}

TEST(SegmentDistance, IsTheLeastOverBothSegments) {
  Rng rng(3, Stream::kTest, 0);
  const auto point = [&] {
    const double x = rng.uniform(-2.0, 2.0);
    const double y = rng.uniform(-2.0, 2.0);
    return Vector3d(x, y, rng.uniform(-2.0, 2.0));
  };
  for (int i = 0; i < 1000; ++i) {
    const Vector3d a = point();
    const Vector3d b = i % 7 == 0 ? a : point();
    const Vector3d c = point();
    const Vector3d d = i % 5 == 0 ? Vector3d(c + 0.7 * (b - a)) : point();
    const double told = segment_distance(a, b, c, d);
    double minimum = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 400; ++k) {
      const Vector3d p = a + k / 400.0 * (b - a);
      const double length = (d - c).squaredNorm();
      const double t = length > 0.0 ? std::clamp((p - c).dot(d - c) / length, 0.0, 1.0) : 0.0;
      minimum = std::min(minimum, (p - c - t * (d - c)).norm());
    }
    EXPECT_LE(told, minimum + 1e-9);
    EXPECT_GE(told, minimum - 0.01);
  }
}

// The plate's edges: |x| = 30, |y| = 20 on top (its 2 mm high sides are all within 3 mm of one).
TEST(DefectSampler, CentresKeepTheirDistanceToSharpEdges) {
  DefectGroup group = sampler_dents(1);
  const auto min_distance_mm = [&](double apart_mm, int* refused) {
    group.edge_distance_mm = apart_mm;
    const Sampled s(posed_part(sampler_plate()), {{"dents", group}});
    double minimum = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 1000; ++i) {
      const auto drawn = s.draw(9, i);
      if (!drawn.defect) {
        EXPECT_EQ(drawn.reason, "nearer than 3 mm to a sharp edge");
        ++*refused;
        continue;
      }
      const Vector3d p = s.in_part(*drawn.defect);
      minimum = std::min({minimum, 30.0 - std::abs(p.x()), 20.0 - std::abs(p.y())});
    }
    return minimum;
  };
  int refused = 0;
  EXPECT_GE(min_distance_mm(3.0, &refused), 3.0 - 1e-9);
  // Allowed: 2 * 54 * 34 of 2 * 60 * 40 + 2 * (60 + 40) * 2 = 5200 mm2, so 0.706; refused 294 with
  // a standard deviation of 14.4.
  EXPECT_NEAR(refused, 294, 4 * 14.4);
  refused = 0;
  EXPECT_LT(min_distance_mm(0.0, &refused), 0.1);
  EXPECT_EQ(refused, 0);
}

TEST(DefectSampler, ABoxHoldsItsPlaces) {
  DefectGroup group = sampler_dents(1);
  group.region = {.kind = Kind::kBox, .min_mm = {3.0, -1.0, 0.0}, .max_mm = {3.2, -0.7, 1.0}};
  const Sampled s(posed_part(sampler_plate()), {{"dents", group}});
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = s.in_part(*s.draw(10, i).defect);
    EXPECT_TRUE(p.x() >= 3.0 - 1e-5 && p.x() <= 3.2 + 1e-5);
    EXPECT_TRUE(p.y() >= -1.0 - 1e-5 && p.y() <= -0.7 + 1e-5);
    EXPECT_NEAR(p.z(), 1.0, 1e-9);
    mean += p / 1000.0;
  }
  // Standard deviations of the mean: 0.2 and 0.3 / sqrt(12 * 1000) = 0.0018 and 0.0027.
  EXPECT_NEAR(mean.x(), 3.1, 4 * 0.0018);
  EXPECT_NEAR(mean.y(), -0.85, 4 * 0.0027);
}

TEST(DefectSampler, ASphereHoldsItsPlaces) {
  DefectGroup group = sampler_dents(1);
  group.region = {.kind = Kind::kSphere, .centre_mm = {30.0, 0.0, 0.0}, .radius_mm = 4.0};
  const Sampled s(posed_part(sampler_plate()), {{"dents", group}});
  int on_side = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = s.in_part(*s.draw(11, i).defect);
    EXPECT_LE((p - Vector3d(30.0, 0.0, 0.0)).norm(), 4.0 + 1e-9);
    on_side += p.x() > 30.0 - 1e-9 ? 1 : 0;
  }
  EXPECT_GT(on_side, 100);
  EXPECT_LT(on_side, 900);
}

TEST(DefectSampler, FacingKeepsToWhatLooksUp) {
  DefectGroup group = sampler_dents(1);
  group.region.facing_rad = 0.6;
  const PartSettings ball = {
      .shape = PartSettings::Shape::kSphereCap, .radius_mm = 20.0, .height_mm = 40.0};
  const Sampled s(posed_part(ball), {{"dents", group}});
  double lowest = 1.0;
  for (int i = 0; i < 1000; ++i) {
    lowest = std::min(lowest, s.in_part(*s.draw(12, i).defect).z() / 20.0);
  }
  EXPECT_GE(lowest, std::cos(0.6) - 1e-9);
  EXPECT_LT(lowest, std::cos(0.6) + 0.01);
}

/// The plate as PLY; faces whose z is 1 mm all over get the colour.
std::filesystem::path painted_plate(const Part& plate, const std::string& name, int green) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nelement face {}\nproperty list uchar int vertex_indices\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      plate.mesh.vertices_mm.size(),
      plate.mesh.num_triangles());
  for (const Vector3d& p : plate.mesh.vertices_mm) {
    text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  for (std::size_t i = 0; i < plate.mesh.num_triangles(); ++i) {
    const auto& [a, b, c] = plate.mesh.triangles[i];
    const bool is_top = face_normal(plate.mesh, i).z() > 0.9;
    text += fmt::format("3 {} {} {} 0 {} 0\n", a, b, c, is_top ? green : 0);
  }
  std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / name;
  write_file(path, text);
  return path;
}

TEST(DefectSampler, PaintedFacesHoldTheirPlaces) {
  const Part plate = build_part(sampler_plate());
  DefectGroup group = sampler_dents(1);
  group.region = {.kind = Kind::kFaces, .file = painted_plate(plate, "top.ply", 200)};
  const Sampled s(posed_part(sampler_plate()), {{"dents", group}});
  for (int i = 0; i < 1000; ++i) {
    EXPECT_NEAR(s.in_part(*s.draw(13, i).defect).z(), 1.0, 1e-9);
  }
}

TEST(DefectSampler, PaintedFilesThatDoNotFitAreErrors) {
  DefectGroup group = sampler_dents(1);
  group.region = {.kind = Kind::kFaces,
                  .file = painted_plate(build_part(sampler_plate()), "black.ply", 0)};
  EXPECT_THAT(
      [&] {
        Sampled(sampler_plate(), {{"dents", group}});
      },
      ThrowsMessage<ConfigError>(StartsWith("defects.dents.region_file: ")));
  group.region.file = painted_plate(build_part(sampler_plate()), "top_2.ply", 9);
  const PartSettings ball = {.shape = PartSettings::Shape::kSphereCap};
  EXPECT_THAT(
      [&] {
        Sampled(ball, {{"dents", group}});
      },
      ThrowsMessage<ConfigError>(HasSubstr("the part's own triangles")));
}

TEST(DefectSampler, ARegionBesideThePartIsAnError) {
  const auto message_of = [](const DefectRegion& region) -> std::string {
    DefectGroup group = sampler_dents(1);
    group.region = region;
    try {
      Sampled(sampler_plate(), {{"dents", group}});
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message_of({.kind = Kind::kBox, .min_mm = {0, 0, 2}, .max_mm = {1, 1, 3}}),
            "defects.dents.region_min_mm: no face of the part lies in the box");
  EXPECT_EQ(message_of({.kind = Kind::kSphere, .centre_mm = {0, 0, 2}, .radius_mm = 0.9}),
            "defects.dents.region_centre_mm: no face of the part lies in the sphere");
  // Its box meets the part, the sphere does not.
  EXPECT_EQ(message_of({.kind = Kind::kSphere, .centre_mm = {30.8, 20.8, 0.0}, .radius_mm = 1.0}),
            "defects.dents.region_centre_mm: no face of the part lies in the sphere");
  EXPECT_EQ(message_of({.kind = Kind::kSphere, .centre_mm = {0, 0, 2}, .radius_mm = 1.1}), "");
}

}  // namespace
}  // namespace glint
