// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two hundred known changes of rendered pictures, alone and in twos, that `glint compare` names.
// GLINT_COMPARE_CASES and GLINT_COMPARE_WIDTH make them fewer and smaller.
#include <cstdlib>

#include "core/rng.h"
#include "tests/cli/changes/known_changes.h"

namespace glint::test {
namespace {

int said(const char* variable, int otherwise) {
  const char* given = std::getenv(variable);
  return given != nullptr ? std::atoi(given) : otherwise;
}

/// Alone and in twos by turns; each 0.6 to 1.6 times what is in the list, either way.
std::vector<Change> drawn(int index) {
  Rng rng(77, Stream::kTest, static_cast<std::uint64_t>(index));
  const std::vector<Change>& all = known_changes();
  const auto count = all.size();
  const auto first = static_cast<std::size_t>(index) % count;
  std::vector<Change> changes = {all[first]};
  if (index % 2 == 1) {
    const auto other = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count - 1));
    changes.push_back(all[(first + 1 + other) % count]);
  }
  for (Change& change : changes) {
    change.value *= rng.uniform(0.6, 1.6) * (rng.uniform() < 0.5 ? -1.0 : 1.0);
  }
  return changes;
}

TEST(KnownChanges, AreNamedWithHonestSigmas) {
  const int cases = said("GLINT_COMPARE_CASES", 200);
  ChangedGear gear(said("GLINT_COMPARE_WIDTH", 1224), 8);
  int changes = 0;
  int named = 0;
  int others = 0;
  std::vector<double> off;
  std::vector<double> over;
  for (int i = 0; i < cases; ++i) {
    const std::vector<Change> one = drawn(i);
    const CaseVerdict verdict = gear.verdict_of(one, 2 + i);
    changes += static_cast<int>(one.size());
    named += verdict.named;
    others += verdict.others;
    off.insert(off.end(), verdict.off.begin(), verdict.off.end());
    over.insert(over.end(), verdict.over.begin(), verdict.over.end());
    for (const Change& change : one) {
      std::printf("%s %.4g  ",
                  name_of(change.parameter).c_str(),
                  told_per_inner(change.parameter) * change.value);
    }
    std::printf("named %d others %d: %s\n", verdict.named, verdict.others, gear.last().c_str());
  }
  const auto held = std::ranges::count_if(off, [](double z) { return std::abs(z) < 1.96; });
  const auto middle = over.begin() + static_cast<std::ptrdiff_t>(over.size() / 2);
  std::nth_element(over.begin(), middle, over.end());
  std::printf("named %d of %d, %d others, intervals hold %td of %zu, sigma %.2f of the bound\n",
              named,
              changes,
              others,
              held,
              off.size(),
              *middle);
  EXPECT_GE(named, changes * 95 / 100);
  EXPECT_LE(others, cases * 10 / 100);
  EXPECT_LE(*middle, 2.0);
  EXPECT_GE(held, static_cast<std::ptrdiff_t>(off.size()) * 88 / 100);
}

/// The gallery's twelve views with a sensor's noise.
void render_views(const TemporaryFolder& folder, const std::string& seed) {
  const ProgramResult result =
      glint_in(folder,
               {"render",
                std::string(GLINT_SOURCE_DIR) + "/studies/gallery/viewpoints/scene.toml",
                "--quiet",
                "--set",
                "sensor.full_well_e=10000",
                "--set",
                "sensor.read_noise_e=8",
                "--set",
                "sensor.seed=" + seed,
                "--out",
                "views_" + seed});
  ASSERT_EQ(result.code, 0) << result.err;
}

// A part that fills a large picture, against itself with other noise of the sensor.
TEST(KnownChanges, OfNoiseAloneLeaveEverythingWhereItIs) {
  ChangedGear gear(said("GLINT_COMPARE_WIDTH", 1224), 8);
  gear.set("render.paths.seed=1");
  EXPECT_TRUE(gear.causes_of({}, 40).empty()) << gear.last();
  EXPECT_GE(gear.last_pair()["iou"].get<double>(), 0.998);
  EXPECT_LE(gear.last_pair()["mean_distance_px"].get<double>(), 0.03);
}

// Nothing differs but noise: nothing is told, and equal pictures are equal.
TEST(KnownChanges, AreNoneBetweenPicturesWithOtherNoise) {
  const TemporaryFolder folder;
  render_views(folder, "1");
  render_views(folder, "9");
  const auto pairs_of = [&](const std::string& real) {
    const nlohmann::json pairs =
        json_of(folder, {"compare", "views_1", real, "--quiet", "--out", "out_" + real})["pairs"];
    EXPECT_EQ(pairs.size(), 12U);
    return pairs;
  };
  for (const nlohmann::json& pair : pairs_of("views_9")) {
    EXPECT_TRUE(pair["causes"].empty()) << pair["simulated"] << pair["causes"];
    EXPECT_GE(pair["iou"].get<double>(), 0.998) << pair["simulated"];
    EXPECT_LE(pair["mean_distance_px"].get<double>(), 0.06) << pair["simulated"];
  }
  for (const nlohmann::json& pair : pairs_of("views_1")) {
    EXPECT_TRUE(pair["causes"].empty()) << pair["simulated"] << pair["causes"];
    EXPECT_EQ(pair["mean_distance_px"].get<double>(), 0.0) << pair["simulated"];
  }
}

}  // namespace
}  // namespace glint::test
