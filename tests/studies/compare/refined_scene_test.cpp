// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/refined_scene.h"

#include <string>

#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/thread_pool.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

/// A rough plate of half reflectance under an even sky of radiance 1 that fills the picture's
/// middle: grey 0.5 at an exposure of 1.
constexpr const char* kGreyPlate = R"(schema = 1
[part]
shape = "plate"
length_mm = 16
width_mm = 12
[material]
type = "diffuse"
reflectance = [0.5]
[camera]
width_px = 40
height_px = 30
object_pixel_mm = 0.6
working_distance_mm = 100
[sensor]
exposure = 0.7
gain = 1.1
expose_to = 0.9
[render.paths]
samples = 256
[lighting.environment]
)";

class RefinedExposure : public CompareFiles {
 protected:
  /// @param picture  that the scene was rendered to
  SceneSettings refined(const std::string& picture, double gain) {
    write_file(folder() / "scene.toml", kGreyPlate);
    const CompareSource source = {
        .name = "s", .picture = folder() / picture, .scene = folder() / "scene.toml"};
    PairCauses causes;
    causes.gain = gain;
    std::vector<Problem> errors;
    const SceneSettings scene =
        read_scene(parse_toml(refined_toml(source, causes, store_), "refined.toml"), errors);
    EXPECT_TRUE(errors.empty());
    return scene;
  }

  ThreadPool pool_{2};
  SceneStore store_{pool_};
};

// `glint render` shows views as sensor.exposure says, whatever expose_to is.
TEST_F(RefinedExposure, OfAViewIsItsOwnTimesTheGain) {
  const SceneSettings scene = refined("image.tif", 1.2);
  EXPECT_EQ(scene.expose_to, 0.0);
  EXPECT_EQ(scene.sensor.exposure, 0.7);
  EXPECT_NEAR(scene.sensor.gain, 1.1 * 1.2, 1e-12);
}

TEST_F(RefinedExposure, OfADesignIsWhatItIsExposedTo) {
  const SceneSettings scene = refined("aspect.png", 0.8);
  const double dark = dark_grey(scene.sensor);
  EXPECT_NEAR(scene.expose_to, dark + 0.8 * (0.9 - dark), 1e-12);
  EXPECT_EQ(scene.sensor.gain, 1.1);
}

// 1.2 times 0.9 is beyond full scale: only an exposure says it, and it is that of the 99th
// percentile of the plate, 0.9, times the gain.
TEST_F(RefinedExposure, OfADesignBeyondFullScaleIsAnExposure) {
  const SceneSettings scene = refined("aspect.png", 1.2);
  EXPECT_EQ(scene.expose_to, 0.0);
  const double grey = 0.5 * scene.sensor.exposure * scene.sensor.gain;
  EXPECT_NEAR(grey, 1.2 * (0.9 - dark_grey(scene.sensor)), 0.2);
  EXPECT_GT(grey, 0.9);
}

}  // namespace
}  // namespace glint
