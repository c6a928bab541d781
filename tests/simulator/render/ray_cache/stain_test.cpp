// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "core/units.h"
#include "simulator/render/footprint/footprints.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"
#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kLight_mm = 150.0;

/// 12 mm across in the middle of the plate: sigma 3 mm, radius 6 mm.
HeightFeature round_stain(double reflectance, double roughness_rad = 0.0) {
  HeightFeature stain;
  stain.label = "stain";
  stain.id = 1;
  stain.centre_mm = {0.0, 0.0, test::kPlateTop_mm};
  stain.sigma_mm = 3.0;
  stain.reflectance = reflectance;
  stain.roughness_rad = roughness_rad;
  return stain;
}

/// 60 x 60 pixels of 0.25 mm.
const CameraSettings kStainCamera = test::far_camera(60, 60, 0.25);

/// Uniform light: a radiance of 1 wherever the rays go.
TunnelSettings uniform_light() {
  TunnelSettings light = test::ceiling(kLight_mm, 20.0);
  light.duty = 1.0;
  return light;
}

/// One picture by each method.
struct StainPictures {
  Part part = build_part(test::plate());
  Bvh bvh{part.mesh};
  SurfaceDetail detail;
  PinholeCamera camera{intrinsics_of(kStainCamera)};
  RigidTransform camera_from_world = glint::camera_from_world(default_viewpoint(kStainCamera));
  CornerRays corners;
  RayCache rays;
  std::vector<ImageF> integrated;
  std::vector<ImageF> sampled;

  StainPictures(std::vector<HeightFeature> features,
                const TunnelSettings& light,
                int frames = 1,
                int rays_per_axis = 16)
      : detail(std::move(features)) {
    ThreadPool pool(2);
    const Tunnel tunnel(light);
    const Vector3d eye(0.0, 0.0, kStainCamera.working_distance_mm);
    corners = trace_corner_rays(part, bvh, detail, camera, camera_from_world, {}, pool);
    rays = trace_rays(
        part, bvh, detail, camera, camera_from_world, {.rays_per_axis = rays_per_axis}, pool);
    const Footprints footprints(corners, tunnel, {.positions = frames}, eye);
    integrated = test::integrated_frames(footprints);
    const WallRays wall = intersect_wall(rays, tunnel, eye);
    for (const double shift_mm : footprints.positions().shift_mm) {
      sampled.emplace_back();
      render_frame(rays, wall, tunnel.pattern(shift_mm), sampled.back());
    }
  }
};

/// Distance of a pixel's middle from the middle of the picture [mm].
double radius_of(int x, int y) {
  return 0.25 * std::hypot(x + 0.5 - 30.0, y + 0.5 - 30.0);
}

// Whole up to 0.9 radii = 5.4 mm, nothing from 1.1 radii = 6.6 mm on.
TEST(Stain, HalvesTheGreyValueInsideAndLeavesTheRestAlone) {
  const StainPictures clean({}, uniform_light());
  const StainPictures pictures({round_stain(0.5)}, uniform_light());
  int inside = 0;
  int outside = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      const double radius_mm = radius_of(x, y);
      for (const auto& [now, before] : {std::pair(&pictures.integrated[0], &clean.integrated[0]),
                                        std::pair(&pictures.sampled[0], &clean.sampled[0])}) {
        if (radius_mm < 5.2) {
          ASSERT_NEAR((*now)(x, y), 0.5F * (*before)(x, y), 1e-6F) << x << " " << y;
          ++inside;
        } else if (radius_mm > 6.8) {
          ASSERT_EQ((*now)(x, y), (*before)(x, y)) << x << " " << y;
          ++outside;
        }
      }
    }
  }
  EXPECT_GT(inside, 2000);
  EXPECT_GT(outside, 2000);
}

// The edge is a cubic 1.2 mm wide: at 6 mm, half way, a reflectance of 0.75.
TEST(Stain, HasASmoothEdgeOnWhichBothMethodsAgree) {
  const StainPictures pictures({round_stain(0.5)}, uniform_light());
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      const float grey = pictures.integrated[0](x, y);
      ASSERT_NEAR(grey, pictures.sampled[0](x, y), 3e-3F) << x << " " << y;
      const double t = std::clamp((6.6 - radius_of(x, y)) / 1.2, 0.0, 1.0);
      ASSERT_NEAR(grey, 1.0 - 0.5 * t * t * (3.0 - 2.0 * t), 0.015) << x << " " << y;
    }
  }
}

// A small stain: radius 0.1 mm, less than half a pixel. The disk's area to the middle of its edge
// is pi 0.01 mm2 of 0.0625 mm2; the edge, cubic, adds less than 1 % to that.
TEST(Stain, BelowAPixelDarkensByItsShare) {
  HeightFeature stain = round_stain(0.0);
  stain.centre_mm += Vector3d(0.125, 0.125, 0.0);
  stain.sigma_mm = 0.05;
  const StainPictures pictures({stain}, uniform_light());
  const double expected = 1.0 - kPi * 0.01 / 0.0625;
  EXPECT_NEAR(pictures.integrated[0](30, 29), expected, 0.01);
  EXPECT_NEAR(pictures.sampled[0](30, 29), expected, 0.01);
}

TEST(Stain, MultipliesWithOthersAndWithTheReflectanceOfThePart) {
  HeightFeature other = round_stain(0.4);
  other.id = 2;
  const StainPictures pictures({round_stain(0.5), other}, uniform_light(), 1, 2);
  EXPECT_NEAR(pictures.integrated[0](30, 30), 0.2F, 1e-6F);
  EXPECT_NEAR(pictures.sampled[0](30, 30), 0.2F, 1e-6F);
}

// The dent's rays go where they go without the stain; all of them carry half.
TEST(Stain, OverlapsADent) {
  HeightFeature dent = test::bump(0.02);
  dent.id = 2;
  const StainPictures bare({dent}, test::ceiling(kLight_mm, 20.0), 4, 4);
  const StainPictures stained({dent, round_stain(0.5)}, test::ceiling(kLight_mm, 20.0), 4, 4);
  for (std::size_t k = 0; k < 4; ++k) {
    for (int y = 25; y < 35; ++y) {
      for (int x = 25; x < 35; ++x) {
        ASSERT_NEAR(stained.sampled[k](x, y), 0.5F * bare.sampled[k](x, y), 1e-6F);
        ASSERT_NEAR(stained.integrated[k](x, y), 0.5F * bare.integrated[k](x, y), 2e-3F);
      }
    }
  }
}

/// Amplitude of the first harmonic of the stripes over the frames of a scan of one period, as the
/// mean over the pixels within a radius: the mean first turned to the same phase everywhere.
double modulation(const std::vector<ImageF>& frames, double radius_mm) {
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      if (radius_of(x, y) > radius_mm) {
        continue;
      }
      std::complex<double> harmonic = 0.0;
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const double turn = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(frames.size());
        harmonic += static_cast<double>(frames[k](x, y)) * std::polar(1.0, turn);
      }
      sum += std::abs(harmonic) / static_cast<double>(frames.size());
      ++count;
    }
  }
  return sum / count;
}

// A slope a turns the mirrored ray by 2 a; on a light 150 mm away that moves the place by
// sigma = 2 a 150 mm = 3 mm for 10 mrad. A sinusoid of period 20 mm keeps
// exp(-2 (pi sigma / 20)^2) = exp(-0.444) = 0.641 of its modulation.
TEST(Stain, MicroReliefBlursTheMirroredStripes) {
  const TunnelSettings light = test::ceiling(kLight_mm, 20.0);
  for (const double roughness_rad : {5e-3, 10e-3, 15e-3}) {
    const StainPictures clean({}, light, 16);
    const StainPictures rough({round_stain(1.0, roughness_rad)}, light, 16);
    const double sigma_mm = 2.0 * roughness_rad * kLight_mm;
    const double expected = std::exp(-2.0 * std::pow(kPi * sigma_mm / 20.0, 2));
    const double sampled = modulation(rough.sampled, 5.0) / modulation(clean.sampled, 5.0);
    const double integrated = modulation(rough.integrated, 5.0) / modulation(clean.integrated, 5.0);
    EXPECT_NEAR(sampled / expected, 1.0, 0.10) << roughness_rad;
    EXPECT_NEAR(integrated / expected, 1.0, 0.15) << roughness_rad;
  }
}

TEST(Stain, MicroReliefTakesAndAddsNoLight) {
  const StainPictures pictures({round_stain(0.5, 10e-3)}, uniform_light(), 1, 4);
  EXPECT_NEAR(pictures.integrated[0](30, 30), 0.5F, 1e-5F);
  EXPECT_NEAR(pictures.sampled[0](30, 30), 0.5F, 1e-5F);
}

TEST(Stain, IsCutIntoSixteenCellsWhereItIsRough) {
  const StainPictures rough({round_stain(1.0, 10e-3)}, uniform_light(), 1, 1);
  ASSERT_EQ(rough.corners.refined.back().cells_per_axis, 16);
  EXPECT_GT(rough.corners.refined.back().pixels.size(), 1200U);  // pi 5^2 mm2 = 1257 pixels
  const StainPictures smooth({round_stain(0.5)}, uniform_light(), 1, 1);
  for (const RefinedGroup& group : smooth.corners.refined) {
    EXPECT_EQ(group.cells_per_axis, 2);  // of 0.125 mm, less than half an edge of 1.2 mm
  }
}

// Rays that meet the part again bring the stain's share with them.
TEST(Stain, IsSeenByWayOfAnotherReflection) {
  Part groove;
  groove.mesh.vertices_mm = {
      {-30, -15, 15}, {30, -15, 15}, {-30, 0, 0}, {30, 0, 0}, {-30, 15, 15}, {30, 15, 15}};
  groove.mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
  smooth_normals(groove.mesh, 0.5);
  groove.box_in_part_mm = bounding_box(groove.mesh);
  HeightFeature stain = round_stain(0.5);
  stain.centre_mm = {0.0, 7.0, 7.0};
  stain.normal = Vector3d(0.0, -1.0, 1.0).normalized();
  stain.v_axis = Vector3d(0.0, 1.0, 1.0).normalized();
  const test::Bench bench(groove,
                          test::far_camera(160, 90, 0.41),
                          {.rays_per_axis = 1, .max_bounces = 2, .reflectance = 0.8},
                          {stain});
  const auto weight_at = [&](double y_mm) {
    const int y = static_cast<int>(45.0 - y_mm / 0.41);
    return bench.rays.weight[static_cast<std::size_t>(y * 160 + 80)];
  };
  EXPECT_NEAR(weight_at(7.0), 0.32F, 1e-6F);   // met first
  EXPECT_NEAR(weight_at(-7.0), 0.32F, 1e-6F);  // met second: 0.8 * 0.8 * 0.5
  EXPECT_NEAR(weight_at(13.0), 0.64F, 1e-6F);  // neither
}

}  // namespace
}  // namespace glint
