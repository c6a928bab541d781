// SPDX-License-Identifier: GPL-3.0-or-later
//
// Some changes of small rendered pictures that `glint compare` names; all of them, large and in
// twos, in compare_changes_test.cpp.
#include "tests/cli/changes/known_changes.h"

namespace glint::test {
namespace {

TEST(KnownChange, IsNamedInSmallPictures) {
  ChangedGear gear(400, 8);
  const std::vector<Change>& all = known_changes();
  // Turns about x and z, a shift, the distance, the lens; then a turn and the centre together.
  const std::vector<std::vector<Change>> cases = {
      {all[0]}, {all[2]}, {all[4]}, {all[5]}, {all[9]}, {all[1], all[7]}};
  int changes = 0;
  int named = 0;
  int others = 0;
  std::size_t bounded = 0;  ///< causes whose sigma stands beside a bound
  int seed = 2;
  for (const std::vector<Change>& one : cases) {
    const CaseVerdict verdict = gear.verdict_of(one, seed++);
    changes += static_cast<int>(one.size());
    named += verdict.named;
    others += verdict.others;
    std::printf("%s %s: %s\n",
                name_of(one[0].parameter).c_str(),
                one.size() > 1 ? name_of(one[1].parameter).c_str() : "",
                gear.last().c_str());
    for (const double off : verdict.off) {
      EXPECT_LT(std::abs(off), 5.0) << gear.last();
    }
    // Neither too sure nor, while it is open which one of a group it is, less sure than that
    // leaves.
    for (std::size_t i = 0; i < verdict.over.size(); ++i) {
      std::printf("sigma is %.2f of the bound, %.2f of that with all partners free\n",
                  verdict.over[i],
                  verdict.over_open[i]);
      EXPECT_GE(verdict.over[i], 0.5) << gear.last();
      EXPECT_LE(verdict.over_open[i], 2.0) << gear.last();
    }
    bounded += verdict.over.size();
  }
  EXPECT_GE(bounded, 4U);
  EXPECT_EQ(named, changes);
  EXPECT_LE(others, 1);
  EXPECT_TRUE(gear.causes_of({}, 40).empty()) << gear.last();
}

// With the real camera's calibration its lens is no cause, and what the part has done is left.
TEST(KnownChange, OfACalibratedLensIsNoCause) {
  ChangedGear gear(400, 8);
  const std::vector<Change>& all = known_changes();
  const std::vector<Change> changes = {{CauseParameter::kK1, 0.08},
                                       {CauseParameter::kFocalLength, 4.0},
                                       {CauseParameter::kCentreX, 1.0},
                                       all[2]};
  const nlohmann::json causes =
      gear.causes_of(changes, 3, {"--calibration", "changed.toml", "--refine"});
  ASSERT_EQ(causes.size(), 1U) << gear.last();
  EXPECT_EQ(causes[0]["name"], "turn_z");
  const double truth = told_per_inner(all[2].parameter) * all[2].value;
  EXPECT_NEAR(causes[0]["value"].get<double>(), truth, 5.0 * causes[0]["sigma"].get<double>());
  const std::string refined = read_file(gear.folder() / "compared/pair_01/refined.toml");
  EXPECT_NE(refined.find("k1 = 0.08"), std::string::npos) << refined;
}

// A camera that is calibrated and says what the scene says: the refined scene is written all the
// same.
TEST(KnownChange, OfNothingIsRefinedByTheCalibration) {
  ChangedGear gear(200, 8);
  EXPECT_TRUE(gear.causes_of({}, 3, {"--calibration", "changed.toml", "--refine"}).empty());
  EXPECT_TRUE(std::filesystem::exists(gear.folder() / "compared/pair_01/refined.toml"));
}

// The roughest metal has no rougher one beside it: no number that is none, no value beyond 1.
TEST(KnownChange, OfTheRoughestMetalStaysInRange) {
  ChangedGear gear(200, 8, "material.roughness=1");
  gear.set("material.roughness=0.8");
  const nlohmann::json causes = gear.causes_of({}, 3, {"--roughness"});
  const nlohmann::json rougher = ChangedGear::named(causes, "roughness");
  if (!rougher.is_null()) {
    EXPECT_LE(rougher["value"].get<double>(), 0.0) << gear.last();
    EXPECT_GE(rougher["value"].get<double>(), -0.6) << gear.last();
    EXPECT_GT(rougher["sigma"].get<double>(), 0.0) << gear.last();
  }
}

// Rougher metal under another exposure: both are told, each with its value, and the refined scene
// has them. Of the same metal nothing is told.
TEST(KnownChange, OfRoughnessIsNamedBesideTheGain) {
  ChangedGear gear(400, 16);
  const std::vector<Change> turned = {known_changes()[2]};
  const double roughness = gear.roughness();
  for (const double factor : {1.0, 1.2}) {
    gear.set("material.roughness=" + std::to_string(factor * roughness));
    gear.set(factor > 1.0 ? "sensor.gain=0.9" : "sensor.gain=1");
    const nlohmann::json causes = gear.causes_of(turned, 5, {"--roughness", "--refine"});
    std::printf("roughness x %.1f: %s\n", factor, gear.last().c_str());
    const nlohmann::json rougher = ChangedGear::named(causes, "roughness");
    const nlohmann::json gain = ChangedGear::named(causes, "gain");
    ASSERT_EQ(rougher.is_null(), factor == 1.0) << gear.last();
    ASSERT_EQ(gain.is_null(), factor == 1.0) << gear.last();
    if (factor > 1.0) {
      const double sigma = rougher["sigma"].get<double>();
      EXPECT_NEAR(rougher["value"].get<double>(), 0.2 * roughness, 4.0 * sigma) << gear.last();
      EXPECT_LT(sigma, 0.02 * roughness);
      EXPECT_NEAR(gain["value"].get<double>(), 0.9, 0.01);
      std::vector<Problem> errors;
      const SceneSettings refined =
          read_scene(load_toml(gear.folder() / "compared/pair_01/refined.toml"), errors);
      EXPECT_TRUE(errors.empty());
      EXPECT_NEAR(refined.material.roughness, roughness + rougher["value"].get<double>(), 1e-9);
      EXPECT_NEAR(refined.sensor.gain, gain["value"].get<double>(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace glint::test
