// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/grey_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/rng.h"
#include "core/thread_pool.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_picture.h"
#include "studies/validate/geometry_fit.h"
#include "studies/validate/grey_terms.h"
#include "tests/studies/validate/trial_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// The trial's designs; ring and dome are in all of them, as they are fixed to one camera.
/// @param size  2: 102 x 85 pixels, as many as a validation compares; 3: 68 x 57
std::vector<std::pair<std::string, SceneSettings>> trial_designs(int size) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "study.toml";
  write_file(file, std::string(kTrialScene) + kTrialStudy);
  const Study study = load_study(file, {});
  std::vector<std::pair<std::string, SceneSettings>> designs;
  for (const Prototype& prototype : study.prototypes) {
    SceneSettings scene = scene_with(study, prototype.overrides);
    scene.camera.width_px = size == 2 ? 102 : 68;
    scene.camera.height_px = size == 2 ? 85 : 57;
    scene.camera.pixel_mm *= size;
    scene.camera.object_pixel_mm *= size;
    designs.emplace_back(prototype.name, scene);
  }
  return designs;
}

/// Of all fits here: they begin at the same two designs, whose pictures are then rendered once.
SceneStore& store_of_fits() {
  static ThreadPool pool(2);
  static SceneStore store(pool, std::size_t{1} << 30U);
  return store;
}

ImageF picture_in(SceneStore& store, const SceneSettings& scene) {
  ImageF picture;
  picture_of(store, scene, {.has_flawless = false})
      ->mean({.watch = [&](int, const ImageF& grey) { picture = grey; }, .has_whole_frames = true});
  return picture;
}

/// Views from where they are, and pictures of a changed scene by other random numbers.
GreyDesign design_of(SceneStore& store,
                     const std::string& name,
                     const SceneSettings& scene,
                     const SceneChange& hidden,
                     std::size_t views = 2) {
  GreyDesign design = {.name = name, .views = {}};
  for (std::size_t v = 0; v < views; ++v) {
    SceneSettings one = scene;
    one.viewpoints = {scene.viewpoints[v]};
    SceneSettings truth = changed_scene(one, hidden);
    truth.paths.samples = 128;
    truth.paths.seed = 77;
    truth.sensor.seed = 5;
    design.views.push_back({.scene = one, .real = picture_in(store, truth)});
  }
  return design;
}

std::vector<GreyFit> fit_trial(const std::vector<std::string>& names,
                               const SceneChange& hidden,
                               int size = 3,
                               std::size_t views = 2) {
  SceneStore& store = store_of_fits();
  std::vector<GreyDesign> designs;
  for (const auto& [name, scene] : trial_designs(size)) {
    if (std::ranges::find(names, name) != names.end()) {
      designs.push_back(design_of(store, name, scene, hidden, views));
    }
  }
  return fit_grey(store, designs, {.good_share = 0.006});
}

Vector3d place_of(const GreyFit& fit, const std::string& light) {
  const auto found = std::ranges::find(fit.change.lights, light, &LightChange::name);
  return found == fit.change.lights.end() ? Vector3d::Constant(1e9) : found->moved_mm;
}

const Vector3d kHiddenRing(1.8, -1.6, 1.8);

SceneChange hidden_ring() {
  return {.exposure = 0.95, .lights = {{.name = "ring", .moved_mm = kHiddenRing}}};
}

// What keeps segments apart that pictures cannot tell must not pass for knowledge of dark ones.
TEST(GreyFit, KnowsNothingOfTheSegmentsOfALightThatIsDark) {
  const std::vector<GreyFit> fits = fit_trial({"dome"}, {.exposure = 0.95});
  ASSERT_EQ(fits.size(), 1U);
  int segments = 0;
  for (const GreyValue& value : fits.front().kept) {
    if (value.light == "ring" && value.fault == GreyFault::kSegments) {
      ++segments;
      EXPECT_TRUE(std::isinf(value.sigma)) << value.index << ": " << value.sigma;
    }
  }
  EXPECT_EQ(segments, 8);
}

/// A plate of four pixels across, 140 along, under the ring.
SceneSettings thin_plate() {
  std::string text = kTrialScene;
  const auto replace = [&text](const std::string& part, const std::string& by) {
    ASSERT_NE(text.find(part), std::string::npos) << part;
    text.replace(text.find(part), part.size(), by);
  };
  replace("length_mm = 48\nwidth_mm = 36", "length_mm = 42\nwidth_mm = 1.3");
  replace("width_px = 204\nheight_px = 170", "width_px = 143\nheight_px = 20");
  text.erase(text.find("[defects.dent]"), text.find("[lighting.ring]") - text.find("[defects"));
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", text + "[metrics]\nerosion_px = 0\n");
  return load_study(folder / "scene.toml", {}).scene;
}

// Two pixels lie inside its edges: no mean over 3 x 3 shows that a segment is dead.
TEST(GreyFit, TellsTheExposureAloneOfAPartThatIsTooThin) {
  const SceneChange dead = {
      .lights = {{.name = "ring", .segment_power = {0, 1, 1, 1, 1, 1, 1, 1}}}};
  SceneStore& store = store_of_fits();
  const std::vector<GreyDesign> designs = {design_of(store, "thin", thin_plate(), dead, 1)};
  const std::vector<GreyFit> fits = fit_grey(store, designs, {.agree_share = 0.03});
  ASSERT_TRUE(fits.at(0).is_known);
  EXPECT_TRUE(fits[0].is_thin);
  EXPECT_TRUE(fits[0].is_exposure_only);
  EXPECT_LT(fits[0].change.exposure, 0.98);
  EXPECT_NEAR(fits[0].before, 1.0 / fits[0].change.exposure - 1.0, 1e-12);
}

// The ring shines in one design and takes the dome's light in the other: one place explains both.
TEST(GreyFit, FindsALightThatShadesAnother) {
  const std::vector<GreyFit> fits = fit_trial({"ring", "dome"}, hidden_ring(), 2);
  ASSERT_EQ(fits.size(), 2U);
  for (const GreyFit& fit : fits) {
    EXPECT_FALSE(fit.is_thin);
    EXPECT_NEAR(fit.change.exposure, 0.95, 0.0095);
    EXPECT_LT((place_of(fit, "ring") - kHiddenRing).norm(), 0.5)
        << place_of(fit, "ring").transpose();
    EXPECT_TRUE(place_of(fit, "dome").isZero()) << place_of(fit, "dome").transpose();
    EXPECT_LT(fit.after, 0.5 * fit.exposed);
    // What was left as designed has a sigma too, what was freed is not among it.
    const auto places = std::ranges::count_if(fit.kept, [](const GreyValue& value) {
      return value.light == "ring" && value.fault == GreyFault::kLightPlace;
    });
    EXPECT_EQ(places, 0);
    EXPECT_EQ(std::ranges::count(fit.kept, GreyFault::kSegments, &GreyValue::fault), 8);
    const auto dome = std::ranges::find(fit.kept, GreyFault::kLightPlace, &GreyValue::fault);
    ASSERT_NE(dome, fit.kept.end());
    EXPECT_EQ(dome->light, "dome");
    EXPECT_GT(dome->sigma, 0.0);
  }
}

// Brushed along x, the plate reflects so widely across that a millimetre changes a pixel by less
// than the noise of few samples: plain least squares would find half the way along y at most.
TEST(GreyFit, FindsAPlaceThatSlopesHardlyShow) {
  SceneStore& store = store_of_fits();
  auto [name, scene] = trial_designs(3).front();
  scene.material.anisotropy = -0.7;
  const std::vector designs = {design_of(store, name, scene, hidden_ring(), 1)};
  const std::vector<GreyFit> fits = fit_grey(store, designs, {.good_share = 0.006});
  // One small picture tells less of its height.
  EXPECT_LT((place_of(fits[0], "ring") - kHiddenRing).head<2>().norm(), 0.5)
      << place_of(fits[0], "ring").transpose();
}

/// 3000 pixels that one number moves by `slope`, with noise of that size in each half of the slopes
/// and of what is left at the true place of 1.
std::pair<double, double> step_with_noise(double slope, double noise, std::uint64_t seed) {
  using validate_detail::GreyHalves;
  Rng random(seed, Stream::kTest, 0);
  GreyHalves columns = {Eigen::VectorXd(3000), Eigen::VectorXd(3000)};
  GreyHalves left = columns;
  for (Eigen::Index i = 0; i < 3000; ++i) {
    const double here = slope * (1.0 + 0.5 * std::sin(0.01 * static_cast<double>(i)));
    for (std::size_t half = 0; half < 2; ++half) {
      const double unmoved = noise * random.normal();
      columns[half][i] = here + noise * random.normal() - unmoved;
      left[half][i] = here - unmoved;
    }
  }
  validate_detail::GreySystem system;
  system.add(columns, {.term = {.fault = GreyFault::kLightPlace}});
  Eigen::VectorXd sigma;
  const double step = step_of(system, left, &sigma)[0];
  return {step, sigma[0]};
}

TEST(GreyFit, StepsAreRightOrKnownToBeUnknown) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    // Products of slopes are a third of those with noise.
    const auto [step, sigma] = step_with_noise(0.01, 0.014, seed);
    EXPECT_NEAR(step, 1.0, 0.25) << seed;
    EXPECT_LT(sigma, 0.5) << seed;
    // A hundredth: nothing is known.
    const auto [lost, unsure] = step_with_noise(0.001, 0.014, seed);
    EXPECT_LT(std::abs(lost - 1.0), 4.0 * unsure) << seed;
  }
}

/// Where the ring is found, and how exactly, when the camera of all views is taken for turned.
GreyFit ring_seen_turned(double turn_rad, const Eigen::MatrixXd& covariance) {
  SceneStore& store = store_of_fits();
  std::vector<GreyDesign> designs;
  for (const auto& [name, scene] : trial_designs(3)) {
    if (name == "ring") {
      designs.push_back(design_of(store, name, scene, hidden_ring()));
    }
  }
  Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
  motion[0] = turn_rad;
  for (std::size_t v = 0; v < designs[0].views.size(); ++v) {
    GreyView& view = designs[0].views[v];
    const RigidTransform pose = camera_from_world(view.scene.viewpoint());
    view.scene.viewpoints = {viewpoint_of_pose(inverse(moved_by(motion)) * pose)};
    view.pose = static_cast<int>(v);
  }
  return fit_grey(store, designs, {.good_share = 0.006, .camera_covariance = covariance}).at(0);
}

Vector3d place_sigma(const GreyFit& fit) {
  Vector3d sigma = Vector3d::Zero();
  for (const GreyValue& value : fit.values) {
    if (value.fault == GreyFault::kLightPlace && value.light == "ring") {
      sigma[value.index] = value.sigma;
    }
  }
  return sigma;
}

// A turn that both views share, of one standard deviation: places move by what it adds to theirs.
TEST(GreyFit, KnowsPlacesNoBetterThanTheCameraIsKnown) {
  constexpr double kTurn = 2.5e-3;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(21, 21);
  for (const Eigen::Index row : {9, 15}) {
    for (const Eigen::Index column : {9, 15}) {
      covariance(row, column) = kTurn * kTurn;
    }
  }
  const GreyFit right = ring_seen_turned(0.0, {});
  const GreyFit told = ring_seen_turned(0.0, covariance);
  const GreyFit turned = ring_seen_turned(kTurn, {});
  EXPECT_EQ(place_of(told, "ring"), place_of(right, "ring"));
  const Vector3d moved = place_of(turned, "ring") - place_of(right, "ring");
  const Vector3d noise = place_sigma(right);
  const Vector3d added = (place_sigma(told).cwiseAbs2() - noise.cwiseAbs2()).cwiseSqrt();
  fmt::print(
      "a turn by {:.4f} rad moves the ring by {:.3f} {:.3f} {:.3f} mm, told {:.3f} {:.3f} "
      "{:.3f}, noise {:.3f} {:.3f} {:.3f}\n",
      kTurn,
      moved.x(),
      moved.y(),
      moved.z(),
      added.x(),
      added.y(),
      added.z(),
      noise.x(),
      noise.y(),
      noise.z());
  EXPECT_GT(moved.norm(), 0.1);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(added[i], std::abs(moved[i]), 2.5 * noise[i]) << i;
  }
  EXPECT_GT(added.y(), noise.y()) << "the axis that a turn about x moves";
}

// Pictures of the dome alone: the ring is dark, and found by the shadow that it casts.
TEST(GreyFit, FindsADarkLightByItsShadow) {
  const std::vector<GreyFit> fits = fit_trial({"dome"}, hidden_ring());
  ASSERT_EQ(fits.size(), 1U);
  EXPECT_TRUE(place_of(fits[0], "dome").isZero()) << place_of(fits[0], "dome").transpose();
  // Shadows tell less of its height.
  EXPECT_LT((place_of(fits[0], "ring") - kHiddenRing).head<2>().norm(), 0.5)
      << place_of(fits[0], "ring").transpose();
}

TEST(GreyFit, MovesNoLightWhereTheExposureIsAll) {
  const std::vector<GreyFit> fits = fit_trial({"ring", "dome"}, {.exposure = 0.9}, 3, 1);
  for (const GreyFit& fit : fits) {
    EXPECT_NEAR(fit.change.exposure, 0.9, 0.005);
    EXPECT_TRUE(place_of(fit, "ring").isZero());
    EXPECT_TRUE(place_of(fit, "dome").isZero());
    EXPECT_EQ(fit.faults, std::vector{GreyFault::kExposure});
  }
}

// One design's lights of another power are told apart from the exposure, which all share.
TEST(GreyFit, TellsTheirPowerFromTheExposure) {
  SceneStore& store = store_of_fits();
  std::vector<GreyDesign> designs;
  for (const auto& [name, scene] : trial_designs(3)) {
    designs.push_back(design_of(store, name, scene, {.exposure = name == "dome" ? 0.8 : 1.0}));
  }
  const std::vector<GreyFit> fits = fit_grey(store, designs, {});
  EXPECT_NEAR(fits[0].change.exposure, 1.0, 0.01);
  EXPECT_NEAR(fits[1].change.exposure, 0.8, 0.01);
  EXPECT_TRUE(place_of(fits[0], "ring").isZero());
}

/// The dome as designed, times `designed`, and pictures of that with lights of another power,
/// without noise, rounded to 255 steps.
GreyFit rounded_dome(double designed, double power) {
  SceneStore& store = store_of_fits();
  SceneSettings scene = trial_designs(3).back().second;
  scene.sensor.full_well_e = 0.0;
  scene.sensor.read_noise_e = 0.0;
  scene.sensor.exposure *= designed;
  GreyDesign design = design_of(store, "dome", scene, {}, 1);
  GreyView& view = design.views[0];
  view.step = 1.0 / 255.0;
  SceneSettings exact = view.scene;
  exact.sensor.bits = 0;
  view.real = picture_in(store, exact);
  for (float& grey : view.real.values()) {
    grey = std::round(static_cast<float>(power) * 255.0F * grey) / 255.0F;
  }
  return fit_grey(store, std::vector{design}, {.agree_share = 0.03}).at(0);
}

// A third of a step is recorded as black, whether the light is dead or not: nothing is told. One
// that is far too bright is, and a bright design's dead light is none of rounding's doing.
TEST(GreyFit, AllowsRoundingAtTheDesignedGreyValues) {
  for (const double power : {0.0, 1.0}) {
    const GreyFit dark = rounded_dome(0.004, power);
    ASSERT_TRUE(dark.is_known);
    EXPECT_GT(dark.rounding, 1.0) << power;
    EXPECT_LT(dark.before, 0.03) << power;
    EXPECT_LT(dark.after, 0.03) << power;
  }
  EXPECT_GT(rounded_dome(0.004, 200.0).before, 0.5) << "as bright as the others";
  for (const double power : {0.0, 0.02}) {
    const GreyFit dead = rounded_dome(1.0, power);
    EXPECT_LT(dead.rounding, 0.02) << power;
    EXPECT_LT(dead.change.exposure, 0.2) << power;
  }
  EXPECT_TRUE(std::isinf(rounded_dome(0.0, 1.0).rounding)) << "black as designed";
}

}  // namespace
}  // namespace glint
