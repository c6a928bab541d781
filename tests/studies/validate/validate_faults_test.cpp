// SPDX-License-Identifier: GPL-3.0-or-later
//
// Faults put in by chance: how many are called by their name, and how many cells without a fault
// are called disagreeing. In parts: GLINT_FAULT_FIRST and GLINT_FAULT_CASES say which cases are
// tried (0 and all 40, and half as many without a fault), GLINT_FAULT_SEED draws others.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/studies/validate/trial_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

RingSettings& ring_of(SceneSettings& scene) {
  for (NamedLight& light : scene.lights) {
    if (light.name == "ring") {
      return std::get<RingSettings>(light.settings);
    }
  }
  throw std::runtime_error("no ring");
}

TEST(ValidateFaults, ALightThatIsOffByTwentyMillimetresIsTheCause) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.change = [](SceneSettings& scene) {
               ring_of(scene).placement.position_mm = {20, 0, 0};
             }});
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "does_not_agree") << result["verdict"];
  EXPECT_TRUE(has_cause(result, "light_place")) << result["causes"];
}

TEST(ValidateFaults, ADeadSegmentIsTheCause) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.change = [](SceneSettings& scene) {
               ring_of(scene).segments.segment_power = {1, 1, 0, 1, 1, 1, 1, 1};
             }});
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "does_not_agree") << result["verdict"];
  EXPECT_TRUE(has_cause(result, "dead_segment")) << result["causes"];
}

TEST(ValidateFaults, AWrongLensIsTheCause) {
  const TemporaryFolder folder;
  make_trial(folder.path(),
             {.change = [](SceneSettings& scene) { scene.camera.object_pixel_mm *= 0.97; }});
  const Json result = validate_trial(folder.path());
  EXPECT_EQ(result["agreement"], "does_not_agree") << result["verdict"];
  EXPECT_TRUE(has_cause(result, "lens")) << result["causes"];
}

TEST(ValidateFaults, ARefitFindsExposureAndLightAndScoresAgain) {
  const TemporaryFolder folder;
  make_trial(folder.path(), {.change = [](SceneSettings& scene) {
               scene.sensor.exposure *= 0.95;
               ring_of(scene).placement.position_mm = {3, 0, 0};
             }});
  const Json result = validate_trial(folder.path(), true);
  EXPECT_EQ(result["agreement"], "agrees_after_refit") << result["verdict"];
  EXPECT_NEAR(result["refit"]["exposure"].get<double>(), 0.95, 0.0095);
  const Json light = result["refit"]["lights"][0];
  EXPECT_EQ(light["name"], "ring");
  EXPECT_NEAR(light["moved_mm"][0].get<double>(), 3.0, 0.5);
  EXPECT_EQ(result["refit"]["rescored"]["designs"].size(), 2U);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out/ring/refit.toml"));
}

// Half a step of the sensor's 255; validate_run_test.cpp has one of a whole step.
TEST(ValidateFaults, ADesignAsDarkAsHalfAStepAgrees) {
  const Json dark = validated_dome("0.006", 1.0);
  EXPECT_EQ(dark["agreement"], "agrees") << dark["verdict"] << dark["grey"];
  EXPECT_GT(dark["grey"][0]["rounding_share"].get<double>(), 0.03) << dark["grey"];
}

// Darker by what rounding could make of its pictures, and brighter than it can.
TEST(ValidateFaults, ADarkDesignOfAnotherPowerDoesNotAgree) {
  for (const double power : {0.1, 3.0}) {
    const Json wrong = validated_dome("0.011", power);
    EXPECT_EQ(wrong["agreement"], "does_not_agree") << power << wrong["verdict"] << wrong["grey"];
    EXPECT_TRUE(has_cause(wrong, "exposure")) << power << wrong["causes"];
  }
}

int number_from(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

/// Which cases are tried.
struct Part {
  int first = number_from("GLINT_FAULT_FIRST", 0);
  int cases = number_from("GLINT_FAULT_CASES", 40);
  std::uint64_t seed = static_cast<std::uint64_t>(number_from("GLINT_FAULT_SEED", 7));
};

struct Case {
  TrialTruth truth;
  std::string cause;
};

/// In turn: light 20 mm off, another lens, part turned by 3 degrees, one segment dead.
Case case_of(int index, std::uint64_t seed) {
  Rng random(static_cast<std::uint64_t>(index), Stream::kViewpoints, seed);
  Case made;
  made.truth.seed = 100 + index;
  const auto direction = [&random] {
    Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
    return Eigen::Vector3d(v.normalized());
  };
  switch (index % 4) {
    case 0: {
      const Eigen::Vector3d off = 20.0 * direction();
      made.truth.change = [off](SceneSettings& scene) {
        ring_of(scene).placement.position_mm = {off.x(), off.y(), off.z()};
      };
      made.cause = "light_place";
      break;
    }
    case 1: {
      const double factor =
          1.0 + (random.uniform() < 0.5 ? -1 : 1) * (0.02 + 0.03 * random.uniform());
      made.truth.change = [factor](SceneSettings& scene) {
        scene.camera.object_pixel_mm *= factor;
      };
      made.cause = "lens";
      break;
    }
    case 2: {
      const Eigen::Vector3d turn = 3.0 * direction();
      made.truth.part_turn_deg = {turn.x(), turn.y(), turn.z()};
      made.cause = "part_pose";
      break;
    }
    default: {
      const auto dead = static_cast<std::size_t>(8.0 * random.uniform());
      made.truth.change = [dead](SceneSettings& scene) {
        ring_of(scene).segments.segment_power.assign(8, 1.0);
        ring_of(scene).segments.segment_power[dead] = 0.0;
      };
      made.cause = "dead_segment";
    }
  }
  return made;
}

Json validated(const TrialTruth& truth) {
  const TemporaryFolder folder;
  make_trial(folder.path(), truth);
  return validate_trial(folder.path());
}

/// Causes beyond tolerance that are named beside the right one: "; beside it lens, grey of ring".
std::string others(const Json& result, const std::string& right) {
  std::string text;
  for (const Json& cause : result["causes"]) {
    if (cause["name"] != right && cause["within_tolerance"] == false) {
      text += (text.empty() ? "; beside it " : ", ") + cause["name"].get<std::string>() +
              (cause["of"].is_string() ? " of " + cause["of"].get<std::string>() : "");
    }
  }
  return text;
}

TEST(ValidateFaults, AreCalledByTheirName) {
  const Part part;
  int right = 0;
  int alone = 0;
  for (int i = part.first; i < part.first + part.cases; ++i) {
    const Case made = case_of(i, part.seed);
    const Json result = validated(made.truth);
    const bool is_right = result["agreement"] == "does_not_agree" && has_cause(result, made.cause);
    const std::string beside = others(result, made.cause);
    right += is_right ? 1 : 0;
    alone += is_right && beside.empty() ? 1 : 0;
    std::cout << i << " " << made.cause << (is_right ? " right: " : " WRONG: ") << result["verdict"]
              << beside << "\n"
              << std::flush;
  }
  std::cout << right << " of " << part.cases << " right, " << alone
            << " of them with no other cause named\n";
  EXPECT_GE(right, part.cases * 9 / 10);  // 36 of 40
}

TEST(ValidateFaults, AreNotSeenWhereThereIsNone) {
  const Part part;
  const int cells = part.cases / 2;
  int wrong = 0;
  for (int i = part.first / 2; i < part.first / 2 + cells; ++i) {
    Rng random(static_cast<std::uint64_t>(i), Stream::kViewpoints, part.seed + 1);
    const double exposure = 1.0 + 0.05 * random.normal();
    const double off = random.normal();
    const Json result =
        validated({.change =
                       [&](SceneSettings& scene) {
                         scene.sensor.exposure *= exposure;
                         ring_of(scene).placement.position_mm = {off, -off, 0.0};
                       },
                   .part_shift_mm = {0.02 * random.normal(), 0.02 * random.normal(), 0},
                   .seed = 300 + i});
    const bool is_wrong = result["agreement"] == "does_not_agree";
    wrong += is_wrong ? 1 : 0;
    std::cout << i << (is_wrong ? " WRONG: " : ": ") << result["verdict"] << "\n" << std::flush;
  }
  std::cout << wrong << " of " << cells << " called disagreeing\n";
  EXPECT_LE(wrong, std::max(1, cells / 20));
}

}  // namespace
}  // namespace glint
