// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/scene_gradient.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/evaluation/evaluation.h"
#include "studies/run/run.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

SceneSettings gradient_scene() {
  SceneSettings scene;
  scene.render.method = RenderSettings::Method::kClosed;
  scene.camera = {
      .width_px = 60, .height_px = 24, .object_pixel_mm = 0.5, .working_distance_mm = 400.0};
  scene.viewpoint().position_mm = {0.0, 0.0, 400.0};
  scene.part.shape = PartSettings::Shape::kStrip;
  scene.tunnel.slot_mm = 30.0;
  scene.sensor.gain = 1.5;
  scene.sensor.bits = 0;
  return scene;
}

Evaluation evaluate_with(const SceneSettings& scene, const std::vector<std::string>& paths) {
  ThreadPool pool(1);
  SceneStore store(pool);
  WantedScores wanted = {.fringes = false, .defects = false, .slot = true};
  wanted.gradients = {.scores = {"homogeneity.h_rms", "view.slot_margin_mm"}, .paths = paths};
  return evaluate(store, scene, {}, wanted);
}

TEST(WithoutDerivative, NamesWhyForEveryKindOfKey) {
  SceneSettings scene = gradient_scene();
  EXPECT_EQ(without_derivative(scene, "lighting.tunnel.radius_mm"), "");
  EXPECT_EQ(without_derivative(scene, "viewpoint.0.position_mm.1"), "");
  EXPECT_THAT(without_derivative(scene, "scan.positions"), HasSubstr("offered are"));
  EXPECT_THAT(without_derivative(scene, "lighting.tunnel.length_mm"), HasSubstr("offered are"));
  EXPECT_THAT(without_derivative(scene, "lighting.other.radius_mm"), HasSubstr("offered are"));
  scene.scan.step_mm = 1.0;
  EXPECT_THAT(without_derivative(scene, "lighting.tunnel.period_mm"), HasSubstr("scan.step_mm"));
  scene.tunnel.orientation_rad = 0.3;
  EXPECT_THAT(without_derivative(scene, "lighting.tunnel.radius_mm"), HasSubstr("oblique"));
  EXPECT_EQ(without_derivative(scene, "lighting.tunnel.slot_mm"), "");
}

TEST(GradientsOf, KeysWithoutDerivativeAreNamedAndNoNumber) {
  const Evaluation found =
      evaluate_with(gradient_scene(), {"lighting.tunnel.radius_mm", "scan.positions"});
  const std::vector<double>& h = found.gradients.by_score.at("homogeneity.h_rms");
  ASSERT_EQ(h.size(), 2U);
  EXPECT_TRUE(std::isfinite(h[0]));
  EXPECT_TRUE(std::isnan(h[1]));
  EXPECT_THAT(text_of(found.gradients.remarks), HasSubstr("scan.positions: has no derivative"));
}

// Half the slot's width less |y|: half a millimetre for a millimetre of slot; the wall moved away
// by a difference of 0.5 mm tells the rest.
TEST(GradientsOf, TheSlotsMarginAgreesWithDifferences) {
  const SceneSettings scene = gradient_scene();
  const auto margin_at = [&](double TunnelSettings::*key, double change) {
    SceneSettings moved = scene;
    moved.tunnel.*key += change;
    return evaluate_with(moved, {}).scores.at("view.slot_margin_mm");
  };
  const Evaluation found = evaluate_with(
      scene, {"lighting.tunnel.slot_mm", "lighting.tunnel.radius_mm", "lighting.tunnel.base_mm"});
  const std::vector<double>& gradient = found.gradients.by_score.at("view.slot_margin_mm");
  EXPECT_DOUBLE_EQ(gradient[0], 0.5);
  const auto difference = [&](double TunnelSettings::*key) {
    return margin_at(key, 0.5) - margin_at(key, -0.5);
  };
  EXPECT_NEAR(gradient[1], difference(&TunnelSettings::radius_mm), 1e-3 * std::abs(gradient[1]));
  EXPECT_NEAR(gradient[2], difference(&TunnelSettings::base_mm), 1e-3 * std::abs(gradient[2]));
  EXPECT_GT(std::abs(gradient[1]), 1e-3);
}

constexpr const char* kGradientStudy = R"(schema = 1
[part]
shape = "strip"
[camera]
width_px = 60
height_px = 24
object_pixel_mm = 0.5
working_distance_mm = 400
[sensor]
gain = 1.5
[lighting.tunnel]
radius_mm = 120
slot_mm = 30
{}
[variables]
"{}" = {{ min = {}, max = {} }}
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "slsqp"
[budget]
evaluations = 4
)";

struct BadKey {
  const char* path;
  const char* table;  ///< more keys of the tunnel, and what follows
  double min;
  double max;
  const char* message;
};

TEST(RunStudy, AKeyWithoutDerivativeIsAClearFailure) {
  const std::vector<BadKey> keys = {
      {"lighting.tunnel.length_mm",
       "",
       500.0,
       700.0,
       "no derivative of homogeneity.h_rms by lighting.tunnel.length_mm"},
      {"lighting.tunnel.radius_mm",
       "orientation_deg = 20",
       110.0,
       130.0,
       "no derivative of homogeneity.h_rms by lighting.tunnel.radius_mm"},
      {"lighting.tunnel.period_mm",
       "[scan]\nstep_mm = 1",
       20.0,
       24.0,
       "no derivative of homogeneity.h_rms by lighting.tunnel.period_mm"}};
  for (const BadKey& key : keys) {
    const TemporaryFolder folder;
    write_file(folder / "study.toml",
               fmt::format(kGradientStudy, key.table, key.path, key.min, key.max));
    const Study study = load_study(folder / "study.toml", {});
    const auto result = run_study(study,
                                  {.out = folder / "out",
                                   .threads = 1,
                                   .jobs = 1,
                                   .progress = Progress::Style::kNone,
                                   .log_file = {}});
    EXPECT_EQ(result.at("status"), "no_feasible");
    EXPECT_EQ(result.at("failed"), result.at("evaluations"));
    // The trials' messages stand in the run's files.
    std::string text;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder / "out")) {
      text += file.is_regular_file() ? read_file(file.path()) : "";
    }
    EXPECT_THAT(text, HasSubstr(key.message)) << key.path;
  }
}

}  // namespace
}  // namespace glint
