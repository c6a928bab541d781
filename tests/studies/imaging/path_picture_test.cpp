// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_picture.h"

#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "studies/imaging/scene_store.h"
#include "tests/simulator/render/path_tracing/path_images.h"
#include "tests/studies/imaging/path_support.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A view of its first viewpoint and its picture.
struct RenderedView {
  explicit RenderedView(const SceneSettings& scene, int threads = 2)
      : pool(threads),
        store(pool),
        view(scene, store.build_defects(scene), scene.viewpoint()),
        picture(render_view(view, path_settings(scene), pool)) {}

  ImageF frame(std::size_t index = 0) const {
    return frame_radiance(picture, view.frames().at(index));
  }

  ThreadPool pool;
  SceneStore store;
  PathView view;
  PathPicture picture;
};

/// Rendered with the powers where build_lights() puts them: in the radiances.
ImageF with_powers_in_radiances(const SceneSettings& scene, const RenderedView& rendered) {
  const Lights lights =
      build_lights(scene.lights,
                   {.scene_from_camera = inverse(rendered.view.physical().camera_from_world)},
                   MeshLoader());
  const PhysicalScene& unit = rendered.view.physical();
  const PhysicalScene physical = {.part = unit.part,
                                  .bvh = unit.bvh,
                                  .detail = unit.detail,
                                  .material = unit.material,
                                  .lights = lights,
                                  .camera = unit.camera,
                                  .camera_from_world = unit.camera_from_world,
                                  .lens = unit.lens};
  ThreadPool pool(2);
  PathSettings paths = path_settings(scene);
  paths.batches = 1;
  const Film sums = render_paths(physical, paths, pool);
  return total_image(sums, group_factors(lights), 0);
}

void expect_powers_are_factors(const std::string& light) {
  SceneSettings scene = path_scene(light);
  scene.paths.batches = 1;
  const RenderedView rendered(scene);
  EXPECT_LT(largest_difference(rendered.frame(), with_powers_in_radiances(scene, rendered)), 1e-5)
      << light;
}

TEST(PathPicture, PowersAreFactorsOfARenderingAtPowerOne) {
  expect_powers_are_factors(kPathRing + "radiance = [0.37]\n");
  expect_powers_are_factors(kPathRing + "power_w = [2.5]\n");
  expect_powers_are_factors(kPathRing +
                            "segments = 4\nsegment_power = [1, 0.5, 0, 2]\nradiance = [0.1]\n");
  expect_powers_are_factors(kPathRing + R"(segments = 4
segment_power = [1, 0.5, 0, 2]
power_w = [3]
leds = 10
)");
  expect_powers_are_factors(kPathRing + R"(segments = 4
separate_segments = true
segment_power = [1, 0.5, 0, 2]
power_w = [3]
)");
  expect_powers_are_factors(R"([lighting.beam]
type = "coaxial"
reflectance = 0.3
power_w = [0.8]
)");
  expect_powers_are_factors(R"([lighting.beam]
type = "coaxial"
reflectance = 0.3
radiance = [7]
)");
  expect_powers_are_factors("[lighting.sky]\ntype = \"environment\"\nradiance = [0.2]\n");
  expect_powers_are_factors("[lighting.dome]\nradiance = [1.7]\n");
}

TEST(PathPicture, TheGreyOfAColouredLightIsTheMeanOfItsChannels) {
  SceneSettings scene = path_scene(kPathRing + "radiance = [0.1, 0.2, 0.6]\n");
  const RenderedView grey(scene);
  EXPECT_NEAR(grey.view.frames().front().front()[0], 0.3, 1e-12);  // (0.1 + 0.2 + 0.6) / 3
  scene.sensor.wavelengths_nm = {630, 532, 465};
  const RenderedView colour(scene);
  const Colour factor = colour.view.frames().front().front();
  EXPECT_NEAR(factor[2], 0.6, 1e-12);
  // The mean of the channels of the frame is the frame of the mean.
  const ImageF frame = colour.frame();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    double mean = 0.0;
    for (int c = 0; c < 3; ++c) {
      const ImageF channel = channel_radiance(colour.picture.sums, colour.view.frames().front(), c);
      mean += static_cast<double>(channel.values()[i]) / 3.0;
    }
    ASSERT_NEAR(static_cast<double>(frame.values()[i]), mean, 1e-6 * (1.0 + mean));
    i += 36;
  }
}

TEST(PathPicture, TwoLightsAreTheSumOfSingles) {
  const RenderedView both(path_scene());
  ASSERT_THAT(both.view.group_names(), ElementsAre("ring", "left"));
  const FrameFactors& all = both.view.frames().front();
  const ImageF ring = frame_radiance(both.picture, {all[0], Colour::Zero()});
  const ImageF left = frame_radiance(both.picture, {Colour::Zero(), all[1]});
  ImageF sum = ring;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum.values()[i] += left.values()[i];
  }
  EXPECT_LT(largest_difference(sum, both.frame()), 1e-6);
}

TEST(PathPicture, BatchesAddUpToTheSumsAndLeavingOneOutLeavesTheOthers) {
  const SceneSettings scene = path_scene();
  const RenderedView rendered(scene);
  ASSERT_EQ(rendered.picture.batches.size(), 4U);
  const FrameFactors& factors = rendered.view.frames().front();
  const std::size_t pixel = 16 * 48 + 24;
  double sum = 0.0;
  double others = 0.0;
  for (std::size_t b = 0; b < 4; ++b) {
    const PathBatch& batch = rendered.picture.batches[b];
    EXPECT_EQ(batch.samples.values()[pixel], 2);  // 8 samples / 4 batches
    for (std::size_t g = 0; g < batch.groups.size(); ++g) {
      const double light = static_cast<double>(batch.groups[g].channels[0].values()[pixel]);
      sum += factors[g][0] * light;
      others += b == 1 ? 0.0 : factors[g][0] * light;
    }
  }
  EXPECT_NEAR(static_cast<double>(rendered.frame().values()[pixel]), sum / 8.0, 1e-6 * sum);
  const ImageF without = frame_radiance(rendered.picture, factors, 1);
  EXPECT_NEAR(static_cast<double>(without.values()[pixel]), others / 6.0, 1e-6 * sum);
  EXPECT_NEAR(pixel_radiance(rendered.picture, factors, pixel, 1), others / 6.0, 1e-6 * sum);
}

TEST(PathPicture, SamplesAreRoundedUpToAMultipleOfTheBatches) {
  SceneSettings scene = path_scene();
  scene.paths.samples = 9;
  const RenderedView rendered(scene);
  EXPECT_EQ(rendered.picture.sums.samples.values()[0], 12);  // 4 batches of 3
}

TEST(PathPicture, IsTheSameForAnyNumberOfThreads) {
  const SceneSettings scene = path_scene();
  const RenderedView one(scene, 1);
  const RenderedView two(scene, 2);
  const RenderedView seven(scene, 7);
  for (const RenderedView* other : {&two, &seven}) {
    EXPECT_EQ(one.frame(), other->frame());
    EXPECT_EQ(one.picture.sums.squares, other->picture.sums.squares);
    EXPECT_EQ(one.picture.sums.part, other->picture.sums.part);
    EXPECT_EQ(one.picture.batches[3].groups[1].channels[0],
              other->picture.batches[3].groups[1].channels[0]);
  }
}

TEST(PathPicture, MasksWithoutLightCostNoLightAndAreTheSame) {
  SceneSettings scene = path_scene();
  scene.paths.batches = 1;
  const RenderedView lit(scene);
  scene.paths.has_light = false;
  const RenderedView dark(scene);
  EXPECT_EQ(dark.picture.sums.counts.shadow, 0);
  EXPECT_EQ(dark.picture.sums.counts.bounce, 0);
  EXPECT_TRUE(dark.picture.sums.groups.empty());
  EXPECT_EQ(lit.picture.sums.groups.size(), 2U);
  EXPECT_EQ(dark.picture.sums.part, lit.picture.sums.part);
  ASSERT_EQ(dark.picture.sums.defects.size(), 1U);
  EXPECT_EQ(dark.picture.sums.defects[0].samples, lit.picture.sums.defects[0].samples);
}

TEST(PathPicture, ATunnelHasAFrameForEachPosition) {
  SceneSettings scene = path_scene("[lighting.tunnel]\nradius_mm = 60\nslot_mm = 16\n");
  scene.scan.positions = 6;
  const RenderedView rendered(scene);
  EXPECT_EQ(rendered.view.frames().size(), 6U);
  EXPECT_EQ(rendered.view.group_names().front(), "tunnel.0");
  // Half of the stripes are bright: the frames' mean is half of the wall that shines evenly.
  const std::size_t pixel = 16 * 48 + 4;
  double mean = 0.0;
  double whole = 0.0;
  for (std::size_t k = 0; k < 6; ++k) {
    mean += static_cast<double>(rendered.frame(k).values()[pixel]) / 6.0;
  }
  const FrameFactors all(rendered.view.group_names().size(), Colour::Ones());
  whole = static_cast<double>(frame_radiance(rendered.picture, all).values()[pixel]);
  EXPECT_NEAR(mean, 0.5 * whole, 1e-5 * whole);
}

TEST(PathPicture, ThePreviewSeesAllBatchesTogether) {
  const SceneSettings scene = path_scene();
  ThreadPool pool(2);
  SceneStore store(pool);
  const PathView view(scene, store.build_defects(scene), scene.viewpoint());
  std::vector<int> samples;
  std::vector<std::int32_t> in_sums;
  std::vector<bool> has_more;
  render_view(view, path_settings(scene), pool, {}, [&](const PathProgress& progress) {
    samples.push_back(progress.samples);
    in_sums.push_back(progress.sums->samples.values()[0]);
    has_more.push_back(progress.tiles_left > 0);
    return true;
  });
  EXPECT_THAT(samples, ElementsAre(2, 4, 6, 8));  // one pass for each batch of two
  EXPECT_THAT(in_sums, ElementsAre(2, 4, 6, 8));
  EXPECT_THAT(has_more, ElementsAre(true, true, true, false));
}

TEST(PathPicture, APreviewMayStopIt) {
  const SceneSettings scene = path_scene();
  ThreadPool pool(1);
  SceneStore store(pool);
  const PathView view(scene, store.build_defects(scene), scene.viewpoint());
  const PathPicture picture = render_view(
      view, path_settings(scene), pool, {}, [](const PathProgress& p) { return p.samples < 4; });
  EXPECT_EQ(picture.sums.samples.values()[0], 4);
  EXPECT_EQ(picture.batches.size(), 2U);
}

TEST(PathPicture, WindowsAreTheSamePixels) {
  const SceneSettings scene = path_scene();
  const RenderedView whole(scene);
  ThreadPool pool(2);
  const PixelWindow window = {.left_px = 10, .top_px = 10, .width_px = 3, .height_px = 3};
  const PathPicture part =
      render_view(whole.view, path_settings(scene), pool, std::vector<PixelWindow>{window});
  const ImageF frame = frame_radiance(part, whole.view.frames().front());
  EXPECT_EQ(frame(11, 11), whole.frame()(11, 11));
  EXPECT_EQ(frame(40, 20), 0.0F);
  EXPECT_EQ(part.sums.samples(40, 20), 0);
}

std::string path_view_error(const SceneSettings& scene) {
  ThreadPool pool(1);
  SceneStore store(pool);
  try {
    const PathView view(scene, store.build_defects(scene), scene.viewpoint());
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(PathView, RefusesWhatCannotBeUsedAndNamesTheKey) {
  SceneSettings folded = path_scene();
  folded.camera.k1 = -400.0;
  EXPECT_THAT(path_view_error(folded), HasSubstr("camera.k1"));
  EXPECT_THAT(path_view_error(path_scene("[lighting.lamp]\ntype = \"mesh\"\n")),
              HasSubstr("lighting.lamp.file: must name a mesh"));
  SceneSettings gone = path_scene("[lighting.lamp]\ntype = \"ies\"\n");
  std::get<IesLightSettings>(gone.lights[0].settings).file = "no.ies";
  EXPECT_THAT(path_view_error(gone), HasSubstr("no.ies"));
  SceneSettings two = path_scene("[lighting.sky]\ntype = \"environment\"\n");
  two.lights.push_back(two.lights.front());
  two.lights.back().name = "second";
  EXPECT_THAT(path_view_error(two), HasSubstr("lighting.second: is a second environment"));
  const SceneSettings rippled =
      path_scene(kPathRing + "[lighting.tunnel]\nradius_mm = 60\nled_ripple = 0.2\n");
  EXPECT_THAT(path_view_error(rippled), HasSubstr("lighting.tunnel.led_ripple"));
}

TEST(PathView, AMeshEmitterIsReadAndScaledToItsPower) {
  const std::string file = ::testing::TempDir() + "/path_view_lamp.obj";
  std::ofstream(file) << "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n";
  const SceneSettings scene = path_scene("[lighting.lamp]\ntype = \"mesh\"\nfile = \"" + file +
                                         "\"\npower_w = [2]\nposition_mm = [0, 0, 50]\n"
                                         "direction = [0, 0, -1]\n");
  ThreadPool pool(1);
  SceneStore store(pool);
  const PathView view(scene, store.build_defects(scene), scene.viewpoint());
  EXPECT_EQ(view.physical().lights.emitters.size(), 2U);
  // 100 mm^2 at radiance 1: pi 1e-4 W; 2 W need a factor of 2 / (pi 1e-4).
  EXPECT_NEAR(view.frames().front().front()[0], 2.0 / (kPi * 1e-4), 1e-6 * 2.0 / (kPi * 1e-4));
}

TEST(PictureKey, LeavesOutPowersAndNothingElse) {
  const SceneSettings base = path_scene(kPathRing + kPathBar + "[lighting.tunnel]\n");
  const auto key_with = [&](const std::function<void(SceneSettings&)>& change) {
    SceneSettings scene = base;
    change(scene);
    return picture_key(scene, scene.viewpoint());
  };
  const std::string key = key_with([](SceneSettings&) {});
  const auto ring_of = [](SceneSettings& s) -> RingSettings& {
    return std::get<RingSettings>(s.lights[0].settings);
  };
  EXPECT_EQ(key, key_with([&](SceneSettings& s) { ring_of(s).emission.radiance = {0.2}; }));
  EXPECT_EQ(key, key_with([&](SceneSettings& s) { ring_of(s).emission.power_w = {0.2}; }));
  EXPECT_EQ(key, key_with([](SceneSettings& s) { s.tunnel.dark_reflectance = 0.02; }));
  EXPECT_EQ(key, key_with([](SceneSettings& s) { s.sensor.gain = 2.0; }));
  const std::vector<std::function<void(SceneSettings&)>> others = {
      [&](SceneSettings& s) { ring_of(s).height_mm += 1.0; },
      [&](SceneSettings& s) { ring_of(s).segments.segment_power = {0.5}; },
      [](SceneSettings& s) { s.material.roughness += 0.01; },
      [](SceneSettings& s) { s.part.length_mm += 1.0; },
      [](SceneSettings& s) { s.viewpoint().position_mm[0] += 1.0; },
      [](SceneSettings& s) { s.lens.f_number = 4.0; },
      [](SceneSettings& s) { s.sensor.wavelengths_nm = {600.0}; },
      [](SceneSettings& s) { s.paths.samples += 1; },
      [](SceneSettings& s) { s.paths.seed += 1; },
      [](SceneSettings& s) { s.defects[0].second.diameter_mm = 1.7; },
      [](SceneSettings& s) { s.imprint.seed += 1; },
      [](SceneSettings& s) { s.tunnel.period_mm += 1.0; },
      [](SceneSettings& s) { s.tunnel.dark_reflectance = 0.2; },  // brighter at the rims
      [](SceneSettings& s) { s.scan.positions += 1; },
      [](SceneSettings& s) { s.has_tunnel = false; }};
  for (std::size_t i = 0; i < others.size(); ++i) {
    EXPECT_NE(key, key_with(others[i])) << i;
  }
}

}  // namespace
}  // namespace glint
