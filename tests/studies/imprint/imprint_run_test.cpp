// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imprint/imprint_run.h"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/imprint/imprint_folder.h"
#include "tests/studies/gallery/gallery_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

TEST(PartSeed, IsDifferentForEachPartAndKeptByJson) {
  std::set<std::uint64_t> seeds;
  for (int part = 0; part < 20'000; ++part) {
    for (const std::uint64_t seed : {0U, 7U}) {
      seeds.insert(part_seed(seed, part));
    }
  }
  EXPECT_EQ(seeds.size(), 40'000U);
  EXPECT_LT(*seeds.rbegin(), std::uint64_t{1} << 53);
  EXPECT_GT(*seeds.rbegin(), std::uint64_t{1} << 52) << "all 53 bits are used";
  EXPECT_EQ(part_seed(7, 3), part_seed(7, 3));
}

TEST(StagedFolder, AppearsWholeOrNotAtAll) {
  const TemporaryFolder folder;
  {
    const StagedFolder stage(folder.path(), "part_0000");
    write_file(stage.path() / "a", "1");
  }
  EXPECT_EQ(folder.count(), 0);
  {
    StagedFolder stage(folder.path(), "part_0000");
    write_file(stage.path() / "a", "2");
    stage.commit();
  }
  EXPECT_EQ(read_file(folder / "part_0000/a"), "2");
  EXPECT_EQ(folder.count(), 1);
}

TEST(StagedFolder, WithoutANameMovesItsFilesAndLeavesOthersAlone) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "tools");
  write_file(folder / "tools/mine", "kept");
  write_file(folder / "a", "old");
  {
    StagedFolder stage(folder.path(), "");
    write_file(stage.path() / "a", "new");
    fs::create_directories(stage.path() / "tools");
    write_file(stage.path() / "tools/b", "1");
    stage.commit();
  }
  EXPECT_EQ(read_file(folder / "a"), "new");
  EXPECT_EQ(read_file(folder / "tools/mine"), "kept");
  EXPECT_EQ(read_file(folder / "tools/b"), "1");
  EXPECT_EQ(folder.count(), 2);
}

TEST(StagedFolder, KeepsWhatAnotherProcessHasFinishedMeanwhile) {
  const TemporaryFolder folder;
  StagedFolder stage(folder.path(), "part_0000");
  write_file(stage.path() / "a", "mine");
  fs::create_directories(folder / "part_0000");
  write_file(folder / "part_0000/a", "theirs");
  stage.commit();
  EXPECT_EQ(read_file(folder / "part_0000/a"), "theirs");
}

TEST(RemoveStaleStages, TakesThoseOfEndedProcessesOnly) {
  const TemporaryFolder folder;
  const std::string own = "." + std::string("part_0001.") + std::to_string(::getpid()) + ".part";
  for (const std::string& name : {std::string(".part_0000.999999999.part"),
                                  own,
                                  std::string("part_0002"),
                                  std::string(".part_0000.x.part")}) {
    fs::create_directories(folder / name);
  }
  remove_stale_stages(folder.path());
  EXPECT_FALSE(fs::exists(folder / ".part_0000.999999999.part"));
  EXPECT_TRUE(fs::exists(folder / own));
  EXPECT_EQ(folder.count(), 3);
}

TEST(CheckImprintFolder, RefusesTheRunOfAStudy) {
  const TemporaryFolder folder;
  write_file(folder / "study.sqlite", "");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { check_imprint_folder(folder.path(), Study(), 0); }),
              HasSubstr("holds results of `glint run`"));
}

/// What studies/gallery/gear_defects promises in expected.json.
TEST(GearDefects, ComesOutAsItsReadmeSays) {
  const Study study = load_study(gallery::folder_of("gear_defects") / "scene.toml", {});
  const Json expected =
      Json::parse(read_file(gallery::folder_of("gear_defects") / "expected.json"));
  const TemporaryFolder folder;
  const Json result = imprint_scene(study,
                                    {.out = folder / "out",
                                     .threads = 2,
                                     .has_previews = false,
                                     .progress = Progress::Style::kNone});
  for (const char* name : {"made", "given_up", "retries"}) {
    EXPECT_EQ(result[name], expected[name]) << name;
  }
  EXPECT_NEAR(result["removed_volume_mm3"].get<double>(),
              expected["removed_volume_mm3"].get<double>(),
              expected["volume_tolerance_mm3"].get<double>());
  std::map<std::string, int> by_type;
  for (const Json& defect : result["defects"]) {
    ++by_type[defect["type"].get<std::string>()];
    EXPECT_GT(defect["removed_volume_mm3"], 0.0);
  }
  EXPECT_EQ(by_type["scratch"], expected["scratches"]);
  EXPECT_EQ(by_type["dent"], expected["dents"]);
}

/// Table I: 1 to 8 scratches of 0.1 to 0.35, 2 to 5 dents of 0.2 to 0.4; 1 is 10 mm.
TEST(GearDefects, DrawsFromTheRangesOfTableOne) {
  const Study study = load_study(gallery::folder_of("gear_defects") / "scene.toml", {});
  const TemporaryFolder folder;
  const Json result = imprint_scene(study,
                                    {.out = folder / "out",
                                     .count = 12,
                                     .threads = 2,
                                     .has_previews = false,
                                     .progress = Progress::Style::kNone});
  std::set<int> numbers_of_scratches;
  for (const Json& part : result["parts"]) {
    const fs::path file = folder / "out" / part["name"].get<std::string>() / "defects.json";
    const Json metadata = Json::parse(read_file(file));
    std::map<std::string, int> by_type;
    for (const Json& defect : metadata["defects"]) {
      const auto type = defect["type"].get<std::string>();
      ++by_type[type];
      const bool is_scratch = type == "scratch";
      const auto size_mm = defect[is_scratch ? "length_mm" : "diameter_mm"].get<double>();
      EXPECT_GE(size_mm, is_scratch ? 1.0 : 2.0);
      EXPECT_LE(size_mm, is_scratch ? 3.5 : 4.0);
    }
    EXPECT_GE(by_type["scratch"], 1);
    EXPECT_LE(by_type["scratch"], 8);
    EXPECT_GE(by_type["dent"], 2);
    EXPECT_LE(by_type["dent"], 5);
    numbers_of_scratches.insert(by_type["scratch"]);
  }
  EXPECT_GE(numbers_of_scratches.size(), 3U);
}

}  // namespace
}  // namespace glint
