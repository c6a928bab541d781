// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/pod_study.h"
#include "studies/definition/study_text.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/studies/population/population_support.h"
#include "tests/support/page_data.h"

namespace glint {
namespace {

using population_test::bytes_of;
using population_test::kPod;
using population_test::run_in;
using population_test::StudyText;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Json = nlohmann::ordered_json;

// 0.1 to 10 um in 3 levels: ratio 10.
TEST(PodTable, SpacesLevelsByRatio) {
  PodSettings settings;
  settings.group = "dent";
  settings.height_mm = Interval(1e-4, 1e-2);
  settings.levels = 3;
  EXPECT_THAT(
      level_sizes_mm(settings),
      ElementsAre(DoubleNear(1e-4, 1e-12), DoubleNear(1e-3, 1e-12), DoubleNear(1e-2, 1e-12)));
  EXPECT_EQ(size_of(settings).key, "height_um");
  settings.height_mm = 0.0;
  settings.width_mm = Interval(0.1, 0.4);
  EXPECT_EQ(size_of(settings).key, "width_mm");
  EXPECT_EQ(size_of(settings).range_mm.max, 0.4);
}

TEST(PodTable, PutsTheSizeIntoTheGroupAndLeavesOutTheOthers) {
  PodSettings settings;
  settings.group = "b";
  settings.diameter_mm = Interval(0.1, 0.4);
  const auto groups = group_of_size(settings, {{"a", {}}, {"b", {.height_mm = 0.5}}}, 0.3);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].first, "b");
  EXPECT_EQ(groups[0].second.diameter_mm.min, 0.3);
  EXPECT_EQ(groups[0].second.diameter_mm.max, 0.3);
  EXPECT_EQ(groups[0].second.height_mm.min, 0.5);
}

TEST(PodTable, ReadsAndWritesItselfBack) {
  const StudyText text(kPod);
  const Study study = text.load();
  const TemporaryFolder folder;
  write_file(folder / "again.toml", resolved_text(study));
  EXPECT_EQ(resolved_text(load_study(folder / "again.toml", {})), resolved_text(study));
}

TEST(PodTable, RefusesWithWhatIsAllowed) {
  const auto refusal = [](const std::string& keys) {
    return StudyText("[pod]\n" + keys).refusal();
  };
  EXPECT_THAT(refusal("group = \"dent\"\n"), HasSubstr("exactly one of height_um"));
  EXPECT_THAT(refusal("group = \"dent\"\nheight_um = [1, 2]\ndiameter_mm = [1, 2]\n"),
              HasSubstr("exactly one of height_um"));
  EXPECT_THAT(refusal("group = \"dent\"\nheight_um = 3\n"), HasSubstr("0 < smallest < largest"));
  EXPECT_THAT(refusal("group = \"dent\"\nheight_um = [0, 3]\n"),
              HasSubstr("0 < smallest < largest"));
  EXPECT_THAT(refusal("group = \"dint\"\nheight_um = [1, 3]\n"),
              HasSubstr("\"dint\" is no group of [defects]; there are dent, scratch"));
  EXPECT_THAT(refusal("group = \"dent\"\nlength_mm = [1, 3]\n"),
              HasSubstr("it has height_um and diameter_mm"));
  EXPECT_THAT(refusal("group = \"scratch\"\ndiameter_mm = [1, 3]\n"),
              HasSubstr("it has height_um and length_mm, width_mm"));
  EXPECT_THAT(refusal("group = \"dent\"\nheight_um = [1, 3]\nlevel = 4\n"),
              HasSubstr("pod.level: unknown key"));
}

TEST(Pod, GivesTheSameBytesForAnyNumberOfThreads) {
  const StudyText text(kPod);
  const TemporaryFolder folder;
  for (const int threads : {1, 2, 7}) {
    run_in(folder / std::to_string(threads), text.load(), threads);
  }
  EXPECT_EQ(bytes_of(folder / "1"), bytes_of(folder / "2"));
  EXPECT_EQ(bytes_of(folder / "1"), bytes_of(folder / "7"));
}

TEST(Pod, FindsDeepDentsAndNoShallowOnes) {
  const StudyText text(kPod);
  const TemporaryFolder folder;
  const Json result =
      run_in(folder / "run",
             text.load({{"defects.dent.count", "4"}, {"defects.dent.diameter_mm", "0.8"}}));
  const Json& pod = result.at("pod");
  EXPECT_EQ(pod.at("size"), "height_um");
  for (const auto& [key, design] : pod.at("designs").items()) {
    const Json& levels = design.at("levels");
    ASSERT_EQ(levels.size(), 5U) << key;
    EXPECT_NEAR(levels[0].at("size").get<double>(), 0.05, 1e-9);
    EXPECT_NEAR(levels[4].at("size").get<double>(), 5.0, 1e-9);
    for (const Json& level : levels) {
      EXPECT_EQ(level.at("defects"), 8);
      EXPECT_LE(level.at("hits").get<int>() + level.at("masked").get<int>(), 8);
    }
  }
  const Json& own = pod.at("designs").at("baseline").at("levels");
  EXPECT_LE(own[0].at("hits").get<int>(), 2);
  EXPECT_GE(own[4].at("hits").get<int>() + own[4].at("masked").get<int>(), 7);
  const Json chart =
      test::page_data(read_file(folder / "run" / "report.html"))["panels"][0]["charts"][0];
  EXPECT_EQ(chart["kind"], "pod");
  EXPECT_EQ(chart["pod"], pod);
  EXPECT_EQ(chart["curves"], Json::parse(read_file(folder / "run" / "pod_curves.json")));
}

// Half is found at a50, and sizes go from 0.9 times the smallest to 1.1 times the largest.
TEST(Pod, HasACurveWhereOneCanBeFitted) {
  const StudyText text(kPod);
  const TemporaryFolder folder;
  const Json result =
      run_in(folder / "run",
             text.load({{"defects.dent.count", "4"}, {"pod.parts", "12"}, {"pod.levels", "8"}}));
  const Json curves = Json::parse(read_file(folder / "run" / "pod_curves.json"));
  int fitted = 0;
  for (const auto& [key, design] : result.at("pod").at("designs").items()) {
    const Json& fit = design.at("fit");
    ASSERT_EQ(curves.contains(key), !fit.is_null()) << key;
    if (fit.is_null()) {
      continue;
    }
    ++fitted;
    const Json& curve = curves.at(key);
    EXPECT_NEAR(curve.front().at("size").get<double>(), 0.9 * 0.05, 1e-9);
    EXPECT_NEAR(curve.back().at("size").get<double>(), 1.1 * 5.0, 1e-9);
    for (const Json& point : curve) {
      const auto share = point.at("value").get<double>();
      EXPECT_LE(point.at("low").get<double>(), share);
      EXPECT_GE(point.at("high").get<double>(), share);
      EXPECT_EQ(share >= 0.5, point.at("size").get<double>() >= fit.at("a50").get<double>());
    }
  }
  EXPECT_GT(fitted, 0);
}

TEST(Pod, CountsTheHitsOfEachSizeOnItsOwnParts) {
  const StudyText text(kPod);
  const TemporaryFolder folder;
  const Study study = text.load();
  const Json result = run_in(folder / "run", study);
  const Json& design = result.at("pod").at("designs").at("baseline");
  ThreadPool pool(2);
  SceneStore store(pool);
  const SimulatedLine line(store, study.scene);
  const std::vector<double> sizes_mm = level_sizes_mm(*study.pod);
  for (std::size_t i = 0; i < sizes_mm.size(); ++i) {
    std::int64_t hits = 0;
    for (int k = 0; k < study.pod->parts; ++k) {
      const ScannedPart part =
          line.part_with(group_of_size(*study.pod, study.scene.defects, sizes_mm[i]),
                         static_cast<std::int64_t>(i) * study.pod->parts + k);
      const auto blobs = line.inspect(part, design.at("threshold").get<double>());
      hits += match_detections(blobs, part.defects, study.scene.inspection.trials).found();
    }
    EXPECT_EQ(design.at("levels")[i].at("hits"), hits) << "level " << i;
  }
}

TEST(Pod, FitsTheCurveWhereTheLineLooksAndCountsTheRestAsMasked) {
  const StudyText text(kPod);
  const TemporaryFolder folder;
  const Json result = run_in(folder / "run",
                             text.load({{"defects.dent.count", "6"},
                                        {"defects.dent.min_distance_mm", "0"},
                                        {"lighting.tunnel.slot_mm", "12"},
                                        {"lighting.tunnel.blocks_view", "true"}}));
  const Json& design = result.at("pod").at("designs").at("baseline");
  int masked = 0;
  int hits_beside_masked = 0;
  for (const Json& level : design.at("levels")) {
    const int looked_at = level.at("defects").get<int>() - level.at("masked").get<int>();
    masked += level.at("masked").get<int>();
    hits_beside_masked += level.at("masked").get<int>() > 0 ? level.at("hits").get<int>() : 0;
    if (looked_at > 0) {
      EXPECT_DOUBLE_EQ(level.at("share").at("value").get<double>(),
                       level.at("hits").get<double>() / looked_at);
    }
  }
  EXPECT_GT(masked, 0) << "the slot must hide some";
  EXPECT_GT(hits_beside_masked, 0) << "and must not hide all";
  EXPECT_EQ(design.at("masked"), masked);
}

}  // namespace
}  // namespace glint
