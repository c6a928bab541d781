// SPDX-License-Identifier: GPL-3.0-or-later
//
// Known changes of rendered pictures, alone and in twos, that `glint compare` names: 24 of them, or
// as many as GLINT_COMPARE_CASES says, in pictures of the width GLINT_COMPARE_WIDTH (1224); then 4
// changes of roughness, or GLINT_COMPARE_ROUGH_CASES. Where GLINT_COMPARE_STATE names a file, what
// was said of each case is kept in it, a line each, and not asked again; after
// GLINT_COMPARE_BUDGET_S seconds no further case begins.
#include <chrono>
#include <cstdlib>
#include <fstream>

#include "core/rng.h"
#include "core/wall_clock.h"
#include "tests/cli/changes/kept_rows.h"
#include "tests/cli/changes/known_changes.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;

int said(const char* variable, int otherwise) {
  const char* given = std::getenv(variable);
  return given != nullptr ? std::atoi(given) : otherwise;
}

constexpr double kFilling = 0.8;  ///< distance at which the gear fills the picture

struct DrawnCase {
  std::vector<Change> changes;
  double gain = 1.0;
  double rougher = 0.0;  ///< change of the roughness, over it

  int count() const {
    return static_cast<int>(changes.size()) + (gain != 1.0 ? 1 : 0) + (rougher != 0.0 ? 1 : 0);
  }
};

/// 0.6 to 1.6, either way.
double drawn_times(Rng& rng) {
  return rng.uniform(0.6, 1.6) * (rng.uniform() < 0.5 ? -1.0 : 1.0);
}

/// @param kind  of known_changes(), or the gain
void add_drawn(std::size_t kind, double times, DrawnCase& to) {
  const std::vector<Change>& all = known_changes();
  if (kind == all.size()) {
    to.gain = 1.0 + 0.1 * times;
  } else {
    to.changes.push_back({.parameter = all[kind].parameter, .value = times * all[kind].value});
  }
}

/// Alone and in twos by turns; each 0.6 to 1.6 times what is in the list, either way. Of the gain
/// that is 6 to 16 %.
DrawnCase drawn(int index) {
  Rng rng(77, Stream::kTest, static_cast<std::uint64_t>(index));
  const auto count = known_changes().size() + 1;  // the last one is the gain
  const auto first = static_cast<std::size_t>(index) % count;
  std::vector<std::size_t> kinds = {first};
  if (index % 2 == 1) {
    const auto other = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count - 1));
    kinds.push_back((first + 1 + other) % count);
  }
  DrawnCase result;
  for (const std::size_t kind : kinds) {
    add_drawn(kind, drawn_times(rng), result);
  }
  return result;
}

/// Metal that is 12 to 32 % rougher or smoother, alone and beside another change by turns.
DrawnCase drawn_roughness(int index) {
  Rng rng(78, Stream::kTest, static_cast<std::uint64_t>(index));
  DrawnCase result = {.rougher = 0.2 * drawn_times(rng)};
  if (index % 2 == 1) {
    const auto kinds = static_cast<double>(known_changes().size() + 1);
    const auto kind = static_cast<std::size_t>(rng.uniform() * kinds);
    add_drawn(kind, drawn_times(rng), result);
  }
  return result;
}

std::string text_of(const DrawnCase& one) {
  std::string text = one.gain != 1.0 ? fmt::format("gain {:.3f}  ", one.gain) : "";
  if (one.rougher != 0.0) {
    text += fmt::format("roughness x {:.3f}  ", 1.0 + one.rougher);
  }
  for (const Change& change : one.changes) {
    text += fmt::format(
        "{} {:.4g}  ", name_of(change.parameter), told_per_inner(change.parameter) * change.value);
  }
  return text;
}

/// What was said of all cases.
struct Totals {
  int changes = 0;
  int named = 0;
  int others = 0;
  std::vector<double> off;
  std::vector<double> over;

  void add(const Json& row) {
    const auto append = [&](const char* key, std::vector<double>& to) {
      for (const Json& value : row[key]) {
        to.push_back(value.get<double>());
      }
    };
    changes += row["changes"].get<int>();
    named += row["named"].get<int>();
    others += row["others"].get<int>();
    append("off", off);
    append("gain_off", off);
    append("over", over);
  }
};

Json row_of(ChangedGear& gear, const DrawnCase& one, int seed) {
  const CaseVerdict verdict =
      gear.verdict_of(one.changes, seed, one.gain, one.rougher * gear.roughness());
  std::printf("%snamed %d others %d: %s\n",
              text_of(one).c_str(),
              verdict.named,
              verdict.others,
              gear.last().c_str());
  return {{"changes", one.count()},
          {"named", verdict.named},
          {"others", verdict.others},
          {"off", verdict.off},
          {"gain_off", verdict.gain_off},
          {"over", verdict.over}};
}

/// Two standard deviations of a count, for fewer cases than the two hundred that limits are of.
double slack(double count, double share, int cases) {
  return cases < 200 ? 2.0 * std::sqrt(count * share * (1.0 - share)) : 0.0;
}

Totals totals_of(std::span<const Json> rows) {
  Totals totals;
  std::ranges::for_each(rows, [&](const Json& row) { totals.add(row); });
  return totals;
}

void expect_honest(Totals totals, int cases) {
  ASSERT_FALSE(totals.over.empty());
  const auto held = static_cast<double>(
      std::ranges::count_if(totals.off, [](double z) { return std::abs(z) < 1.96; }));
  const auto told = static_cast<double>(totals.off.size());
  const auto middle = totals.over.begin() + static_cast<std::ptrdiff_t>(totals.over.size() / 2);
  std::nth_element(totals.over.begin(), middle, totals.over.end());
  std::printf("named %d of %d, %d others, intervals hold %.0f of %.0f, sigma %.2f of the bound\n",
              totals.named,
              totals.changes,
              totals.others,
              held,
              told,
              *middle);
  EXPECT_GE(totals.named, 0.95 * totals.changes - slack(totals.changes, 0.95, cases));
  EXPECT_LE(totals.others, 0.1 * cases + slack(cases, 0.1, cases));
  EXPECT_LE(*middle, 2.0);
  EXPECT_GE(held, 0.88 * told - slack(told, 0.88, cases));
  if (cases >= 200) {  // of fewer, intervals of the right width may hold all
    EXPECT_LE(held, 0.99 * told);
  }
}

TEST(KnownChanges, AreNamedWithHonestSigmas) {
  constexpr int kRoughSeed = 3002;
  const int cases = said("GLINT_COMPARE_CASES", 24);
  const int all = cases + said("GLINT_COMPARE_ROUGH_CASES", 4);
  const int budget_s = said("GLINT_COMPARE_BUDGET_S", 0);
  const char* state = std::getenv("GLINT_COMPARE_STATE");
  const auto start = std::chrono::steady_clock::now();
  ChangedGear gear(said("GLINT_COMPARE_WIDTH", 1224), 8, "", kFilling);
  std::vector<Json> rows = state != nullptr ? kept_rows(state) : std::vector<Json>{};
  while (static_cast<int>(rows.size()) < all) {
    if (budget_s > 0 && seconds_since(start) > budget_s) {
      GTEST_SKIP() << rows.size() << " of " << all << " cases are done";
    }
    const int next = static_cast<int>(rows.size());
    rows.push_back(next < cases
                       ? row_of(gear, drawn(next), 2 + next)
                       : row_of(gear, drawn_roughness(next - cases), kRoughSeed + next - cases));
    if (state != nullptr) {
      std::ofstream(state, std::ios::app) << rows.back().dump() << "\n";
    }
  }
  std::printf("%zu cases, %.1f s\n", rows.size(), seconds_since(start));
  const std::span<const Json> told(rows);
  const auto known = static_cast<std::size_t>(cases);
  expect_honest(totals_of(told.first(known)), cases);
  if (all > cases) {  // none may be asked for
    const auto rough = static_cast<std::size_t>(all - cases);
    expect_honest(totals_of(told.subspan(known, rough)), all - cases);
  }
}

// The last row was cut when its run was stopped: the next one takes its place.
TEST(KnownChanges, AreGoneOnWithAfterTheLastWholeRow) {
  const TemporaryFolder folder;
  const auto file = folder / "changes.jsonl";
  EXPECT_TRUE(kept_rows(file).empty());
  for (const std::string cut : {"", R"({"changes":2,"na)", "{\"changes\":3}"}) {
    write_file(file, "{\"changes\":1}\n{\"changes\":2}\n" + cut);
    EXPECT_EQ(kept_rows(file).size(), 2U) << cut;
    std::ofstream(file, std::ios::app) << R"({"changes":4})"
                                       << "\n";
    const std::vector<Json> rows = kept_rows(file);
    ASSERT_EQ(rows.size(), 3U) << cut;
    EXPECT_EQ(rows.back()["changes"], 4) << cut;
  }
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
  ChangedGear gear(said("GLINT_COMPARE_WIDTH", 1224), 8, "", kFilling);
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
    nlohmann::json pairs =
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
