// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that differ by known changes, rendered with other noise: `glint compare` names the
// changes. One cause at a time, and some in twos.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "studies/compare/causes.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;

/// A gear seen at an angle, as in the gallery, with the noise of a sensor.
std::string gear_scene() {
  return std::string("schema = 1\ninclude = [\"") + GLINT_SOURCE_DIR +
         "/studies/gallery/viewpoints/scene.toml\"]\n"
         "[viewpoints]\nsource = \"listed\"\n"
         "[[viewpoint]]\nposition_mm = [124.669, 45.529, -60.833]\n"
         "direction = [-0.8539, -0.31184, 0.41667]\nup = [0, 0, 1]\n"
         "[sensor]\nfull_well_e = 10000\nread_noise_e = 10\n"
         "[render.paths]\nsamples = 16\n";
}

struct Change {
  CauseParameter parameter;
  double value;  ///< in inner units
};

/// Each moves edges by some tenths of a pixel.
const std::vector<Change> kChanges = {{CauseParameter::kTurnX, 0.006},
                                      {CauseParameter::kTurnY, -0.006},
                                      {CauseParameter::kTurnZ, 0.002},
                                      {CauseParameter::kShiftX, 0.06},
                                      {CauseParameter::kShiftY, -0.06},
                                      {CauseParameter::kDistance, 0.4},
                                      {CauseParameter::kFocalLength, 2.0},
                                      {CauseParameter::kCentreX, 0.4},
                                      {CauseParameter::kCentreY, -0.4},
                                      {CauseParameter::kK1, 0.02},
                                      {CauseParameter::kP1, 0.002}};

class KnownChanges : public ::testing::Test {
 protected:
  KnownChanges() {
    write_file(folder_ / "gear.toml", gear_scene());
    render("gear.toml", "base", 1);
    std::vector<Problem> errors;
    scene_ = read_scene(load_toml(folder_ / "base/baseline/scene.toml"), errors);
    throw_if_any(errors);
  }

  void render(const std::string& scene, const std::string& out, int seed) const {
    const ProgramResult result = glint_in(folder_,
                                          {"render",
                                           scene,
                                           "--quiet",
                                           "--set",
                                           "render.paths.seed=" + std::to_string(seed),
                                           "--set",
                                           "sensor.seed=" + std::to_string(seed),
                                           "--out",
                                           out});
    ASSERT_EQ(result.code, 0) << result.err;
  }

  /// Causes between the scene and the same with the changes.
  Json causes_of(std::span<const Change> changes, int seed) const {
    PairCauses causes = {.edges = CauseFit{}};
    for (const Change& change : changes) {
      causes.edges->changes[static_cast<std::size_t>(change.parameter)] = change.value;
      causes.edges->causes.push_back({.parameter = change.parameter, .value = change.value});
    }
    const RigidTransform camera = camera_from_world(scene_.viewpoint());
    causes.middle_mm = camera * Eigen::Vector3d::Zero();
    write_file(folder_ / "changed.toml", to_toml(write_scene(refined_scene(scene_, causes))));
    render("changed.toml", "changed", seed);
    const Json result = json_of(
        folder_, {"compare", "base/baseline", "changed/baseline", "--quiet", "--out", "compared"});
    return result["pairs"][0]["causes"];
  }

  TemporaryFolder folder_;
  SceneSettings scene_;
};

/// The cause of that name, or one that it cannot be told from; null: none.
Json find(const Json& causes, CauseParameter parameter) {
  for (const Json& cause : causes) {
    const Json group = cause.value("group", Json::array());
    if (cause["name"] == name_of(parameter) ||
        std::ranges::count(group, Json(name_of(parameter))) > 0) {
      return cause;
    }
  }
  return nullptr;
}

TEST_F(KnownChanges, AreNamedOneByOne) {
  int named = 0;
  int seed = 2;
  for (const Change& change : kChanges) {
    const Json causes = causes_of({&change, 1}, seed++);
    const Json cause = find(causes, change.parameter);
    RecordProperty(name_of(change.parameter), causes.dump());
    named += cause.is_null() ? 0 : 1;
    if (!cause.is_null() && cause["name"] == name_of(change.parameter)) {
      const double truth = told_per_inner(change.parameter) * change.value;
      const double off = std::abs(cause["value"].get<double>() - truth);
      EXPECT_LE(off, 6.0 * cause["sigma"].get<double>() + 0.1 * std::abs(truth)) << causes;
    }
  }
  EXPECT_GE(named, 10);
}

TEST_F(KnownChanges, AreNamedInTwos) {
  int named = 0;
  int seed = 20;
  for (std::size_t i = 0; i < kChanges.size(); i += 2) {
    const std::vector<Change> both = {kChanges[i], kChanges[(i + 5) % kChanges.size()]};
    const Json causes = causes_of(both, seed++);
    RecordProperty(name_of(both[0].parameter) + "_" + name_of(both[1].parameter), causes.dump());
    named += find(causes, both[0].parameter).is_null() ? 0 : 1;
    named += find(causes, both[1].parameter).is_null() ? 0 : 1;
  }
  EXPECT_GE(named, 10);  // of 12
}

TEST_F(KnownChanges, AreNoneBetweenTwoNoises) {
  EXPECT_TRUE(causes_of({}, 40).empty());
}

}  // namespace
}  // namespace glint::test
