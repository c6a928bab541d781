// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/environment.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/rng.h"
#include "core/units.h"
#include "simulator/light/area/read_environment.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;

// Rows from the top, columns from +x towards +y: with 4 x 2 pixels the first is around
// phi = 45 degrees, 45 degrees above the horizon.
TEST(Environment, StandsWithItsTopRowAlongZAndItsLeftEdgeAlongX) {
  std::vector<std::array<float, 3>> pixels;
  for (int i = 0; i < 8; ++i) {
    pixels.push_back({static_cast<float>(i), 0.0F, 0.0F});
  }
  const Environment sky(4, 2, pixels);
  EXPECT_EQ(sky.radiance(Vector3d(1.0, 1.0, 1.0).normalized())[0], 0.0F);
  EXPECT_EQ(sky.radiance(Vector3d(-1.0, 1.0, 1.0).normalized())[0], 1.0F);
  EXPECT_EQ(sky.radiance(Vector3d(1.0, -1.0, 1.0).normalized())[0], 3.0F);
  EXPECT_EQ(sky.radiance(Vector3d(1.0, 1.0, -1.0).normalized())[0], 4.0F);
}

// Every pixel has solid angle pi / 2; the share of pixel i is i / 28.
TEST(Environment, DrawsInProportionToRadiance) {
  std::vector<std::array<float, 3>> pixels;
  for (int i = 0; i < 8; ++i) {
    pixels.push_back({static_cast<float>(i), static_cast<float>(i), static_cast<float>(i)});
  }
  const Environment sky(4, 2, pixels);
  EXPECT_NEAR(sky.mean_radiance(), 3.5, 1e-12);
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 2000; ++i) {
    const double u = rng.uniform();
    const Environment::Sample s = sky.sample(u, rng.uniform());
    const double radiance = static_cast<double>(s.radiance[0]);
    EXPECT_GT(radiance, 0.0);
    EXPECT_NEAR(s.density, radiance / 28.0 / (kPi / 2.0), 1e-12);
    EXPECT_NEAR(sky.density(s.direction), s.density, 1e-12);
  }
}

TEST(Environment, ThatIsBlackIsNeverDrawn) {
  const Environment night(Array3f::Zero());
  EXPECT_EQ(night.sample(0.3, 0.7).density, 0.0);
  EXPECT_EQ(night.density(Vector3d::UnitZ()), 0.0);
}

TEST(ReadEnvironment, TakesGreyPicturesAndRefusesWhatIsNoLight) {
  const TemporaryFolder folder;
  ImageF picture(4, 2, 0.5F);
  picture(1, 0) = 1000.0F;
  write_exr(folder / "sky.exr", picture);
  const Environment sky = read_environment(folder / "sky.exr", Array3f(1.0F, 2.0F, 3.0F));
  const Array3f bright = sky.radiance(Vector3d(-1.0, 1.0, 1.0).normalized());
  EXPECT_TRUE((bright == Array3f(1000.0F, 2000.0F, 3000.0F)).all());  // nothing is clamped
  picture(1, 0) = -1.0F;
  write_exr(folder / "negative.exr", picture);
  EXPECT_THROW(read_environment(folder / "negative.exr", Array3f::Ones()), ConfigError);
  EXPECT_THROW(read_environment(folder / "none.exr", Array3f::Ones()), IoError);
  write_file(folder / "text.exr", "no picture");
  EXPECT_THROW(read_environment(folder / "text.exr", Array3f::Ones()), ConfigError);
}

}  // namespace
}  // namespace glint
