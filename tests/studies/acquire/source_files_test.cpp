// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes that are no design's own scene.toml: planned ones, copies, others in a design's folder.
#include "studies/acquire/source_files.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "studies/acquire/acquire_plan.h"
#include "studies/acquire/acquire_run.h"
#include "studies/acquire/taught_views.h"
#include "studies/cell/typed_permit.h"
#include "studies/output/result_folder.h"
#include "studies/output/run_folder.h"
#include "tests/studies/acquire/run_of_prototypes.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
namespace fs = std::filesystem;

class ScenesOfARun : public PrototypesOfARun {
 protected:
  ScenesOfARun() { write_file(folder_ / "cell.toml", kLonelyCell); }

  /// The lonely cell's view as `glint plan` would leave it, of a scene that lies as told.
  fs::path plan_of(const PlanOrigin& origin, const std::string& scene_text) const {
    make_folder(folder_ / "plan");
    const ViewPlan plan = plan_of_cell_views(read_cell(folder_ / "cell.toml"), 0.5);
    write_plan({.plan = plan, .scene = "scene.toml", .cell = "cell.toml", .origin = origin},
               folder_ / "plan/plan.json");
    write_file(folder_ / "plan/scene.toml", scene_text);
    return folder_ / "plan";
  }

  PlanOrigin in_run(const std::string& design) const {
    return {.scene = scene(design), .run = folder_ / "run"};
  }

  static std::string wish_of(const fs::path& source,
                             const std::vector<std::string>& mounted = {},
                             const fs::path& made_from = {}) {
    const auto prototypes = MountedPrototypes::beside(source, mounted, made_from);
    return prototypes.wish(prototypes.design_in(source)).value_or("");
  }
};

TEST_F(ScenesOfARun, AreThoseOfTheDesignThatAPlanWasMadeFrom) {
  const fs::path plan = plan_of(in_run("wide"), scene_text(60));
  for (const fs::path& source : {plan, plan / "", plan / "plan.json", plan / "scene.toml"}) {
    EXPECT_EQ(origin_of(source).scene, scene("wide")) << source;
    EXPECT_THAT(wish_of(source), HasSubstr("prototype of wide (ring)")) << source;
    EXPECT_EQ(wish_of(source, {"wide"}), "") << source;
    EXPECT_NE(wish_of(source, {"narrow"}), "") << source;
  }
}

TEST_F(ScenesOfARun, WaitForTheirPrototypeAsPlansBeforeAnythingIsConnected) {
  AcquireOptions options = {.source = plan_of(in_run("wide"), scene_text(60)),
                            .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  const MotionPermit permit = typed_permit(true, "acquire");
  const Json result = acquire_pictures(options, permit);
  EXPECT_EQ(result["status"], "waiting");
  EXPECT_EQ(result["next"]["design"], "wide");
  EXPECT_EQ(describe_acquisition(options)["next"], result["next"]);
  options.mounted = {"narrow"};
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
  options.mounted = {"wide"};
  EXPECT_TRUE(describe_acquisition(options)["next"].is_null());
  EXPECT_THROW(acquire_pictures(options, permit), IoError) << "nobody listens, nobody is asked";
}

// However its folder is written.
TEST_F(ScenesOfARun, GiveTheDefaultFolderTheNameOfTheirs) {
  const fs::path wide = scene("wide").parent_path();
  for (const fs::path& source : {wide / "scene.toml",
                                 wide,
                                 wide / "",
                                 wide / ".",
                                 wide / "../wide/",
                                 wide / "./scene.toml"}) {
    const AcquireOptions options = {.source = source, .cell = folder_ / "cell.toml"};
    EXPECT_EQ(describe_acquisition(options)["folder"], "out/wide/acquire") << source;
  }
}

TEST_F(ScenesOfARun, CountByWhatThePlanHoldsWhereItsDesignHasChangedSince) {
  const fs::path plan = plan_of(in_run("wide"), scene_text(65));
  EXPECT_THAT(wish_of(plan), HasSubstr("plan/scene.toml (ring)"));
  EXPECT_NE(wish_of(plan, {"wide"}), "");
  EXPECT_THAT(wish_of(plan_of(in_run("wide"), scene_text(50))), HasSubstr("of narrow (ring)"));
}

TEST_F(ScenesOfARun, AreAskedForInAnyCaseWhereTheRunIsNotThereAnyMore) {
  const fs::path plan = plan_of(in_run("wide"), scene_text(60));
  fs::rename(folder_ / "run", folder_ / "moved");
  EXPECT_THAT(wish_of(plan), HasSubstr("prototype of wide (its run is not there any more)"));
  EXPECT_EQ(wish_of(plan, {"wide"}), "");
  fs::rename(folder_ / "moved", folder_ / "run");
  fs::remove(folder_ / "run/study.resolved.toml");  // its designs are
  EXPECT_THAT(wish_of(plan), HasSubstr("prototype of wide (its run is not there any more)"));
  fs::remove_all(folder_ / "run/narrow");
  fs::remove_all(folder_ / "run/dark");
  EXPECT_NE(wish_of(plan), "") << "the only one that is left";
  EXPECT_EQ(wish_of(plan, {"wide"}), "");
}

TEST_F(ScenesOfARun, AreAskedForByPlansOfEarlierProgramsThatLieInTheRun) {
  const fs::path plan = plan_of({}, scene_text(60));
  EXPECT_EQ(wish_of(plan), "") << "told to be of no run";
  Json json = Json::parse(read_file(plan / "plan.json"));
  json.erase("planned_from");
  json.erase("run");
  write_file(plan / "plan.json", json.dump());
  for (const fs::path& source : {plan, plan / "plan.json", plan / "scene.toml"}) {
    EXPECT_THAT(
        [&] { wish_of(source); },
        testing::ThrowsMessage<ConfigError>(HasSubstr("plan.json: planned_from: is missing")))
        << source;
  }
  fs::rename(plan, folder_ / "run/wide/plan");
  EXPECT_THAT(wish_of(folder_ / "run/wide/plan"), HasSubstr("prototype of wide (ring)"));
}

TEST_F(ScenesOfARun, AreOfNoDesignWhereTheyWerePlannedOutsideARun) {
  EXPECT_EQ(wish_of(plan_of({.scene = folder_ / "scene.toml", .run = {}}, scene_text(60))), "");
  write_file(folder_ / "plan/plan.json", R"({"kind": "pose_plan"})");
  EXPECT_EQ(origin_of(folder_ / "plan/scene.toml").scene, folder_ / "plan/scene.toml");
}

TEST_F(ScenesOfARun, CountByWhatTheyHoldInADesignsFolder) {
  const fs::path other = folder_ / "run/wide/other.toml";
  write_file(other, scene_text(60));
  EXPECT_THAT(wish_of(other), HasSubstr("prototype of wide (ring)"));
  EXPECT_EQ(wish_of(other, {"wide"}), "");
  write_file(other, scene_text(50));
  EXPECT_THAT(wish_of(other), HasSubstr("prototype of narrow (ring)"));
  EXPECT_NE(wish_of(other, {"wide"}), "") << "it has another ring than the folder's design";
  write_file(other, scene_text(65));
  EXPECT_THAT(wish_of(other), HasSubstr("prototype of wide/other.toml (ring)"));
  EXPECT_NE(wish_of(other, {"wide"}), "");
  EXPECT_EQ(wish_of(other, {"wide/other.toml"}), "");
  write_file(other, scene_text(60, 9));
  EXPECT_THAT(wish_of(other, {"wide"}), HasSubstr("set the power of ring"));
}

TEST_F(ScenesOfARun, CountByWhatTheyHoldDeeperInTheRunToo) {
  make_folder(folder_ / "run/wide/tries/third");
  const fs::path other = folder_ / "run/wide/tries/third/scene.toml";
  write_file(other, scene_text(60));
  EXPECT_THAT(wish_of(other), HasSubstr("prototype of wide (ring)"));
  write_file(folder_ / "run/study.resolved.toml", scene_text(50));
  EXPECT_THAT(wish_of(folder_ / "run/study.resolved.toml"), HasSubstr("of narrow (ring)"));
}

// As `glint calibrate --part` makes them.
TEST_F(ScenesOfARun, AreOfTheRunThatACopyWasMadeFrom) {
  const fs::path copy = folder_ / "copy.toml";
  write_file(copy, scene_text(60));
  EXPECT_EQ(wish_of(copy), "");
  EXPECT_THAT(wish_of(copy, {}, scene("wide")), HasSubstr("prototype of wide (ring)"));
  EXPECT_EQ(wish_of(copy, {"wide"}, scene("wide")), "");
}

TEST_F(ScenesOfARun, AreOfTheRunThatLinksLeadTo) {
  fs::create_directory_symlink(folder_ / "run/wide", folder_ / "current");
  fs::create_symlink(folder_ / "run/wide/scene.toml", folder_ / "my.toml");
  fs::rename(plan_of(in_run("wide"), scene_text(60)), folder_ / "made");
  fs::create_symlink(folder_ / "made/scene.toml", folder_ / "planned.toml");
  for (const char* link :
       {"current", "current/", "current/scene.toml", "my.toml", "planned.toml"}) {
    const fs::path source = folder_ / link;
    EXPECT_THAT(wish_of(source), HasSubstr("prototype of wide (ring)")) << source;
    EXPECT_EQ(wish_of(source, {"wide"}), "") << source;
    EXPECT_NE(wish_of(source, {"narrow"}), "") << source;
  }
  fs::create_directory_symlink(folder_ / "run", folder_ / "latest");
  EXPECT_EQ(origin_of(folder_ / "latest/wide").run, folder_ / "latest") << "as it is named";
  write_file(folder_ / "alone.toml", scene_text(60));
  fs::create_symlink(folder_ / "alone.toml", folder_ / "link.toml");
  EXPECT_EQ(wish_of(folder_ / "link.toml"), "") << "its file lies in no run either";
}

// `glint render` and `glint cover` write the study, too.
TEST_F(ScenesOfARun, AreOfTheRunAroundOtherResults) {
  for (const auto& [name, kind] :
       {std::pair("views", ResultKind::kRender), std::pair("cover", ResultKind::kCover)}) {
    const fs::path inside = folder_ / "run/wide" / name;
    make_folder(inside);
    write_file(inside / "study.resolved.toml", scene_text(60));
    write_file(inside / "other.toml", scene_text(60));
    mark_result_folder(inside, kind);
    EXPECT_EQ(run_above(inside), folder_ / "run");
    EXPECT_THAT(wish_of(inside / "other.toml"), HasSubstr("prototype of wide (ring)")) << name;
    EXPECT_NE(wish_of(inside / "other.toml", {"narrow"}), "") << name;
  }
  mark_result_folder(folder_ / "run", ResultKind::kRun);
  EXPECT_EQ(run_above(scene("wide")), folder_ / "run");
  const fs::path nested = folder_ / "run/wide/again";
  make_folder(nested);
  write_file(nested / "study.resolved.toml", "schema = 1\n");
  mark_result_folder(nested, ResultKind::kRun);
  EXPECT_EQ(run_above(nested / "winner"), nested) << "a run in a run";
}

TEST(RunAbove, IsTheNearestFolderWithAStudy) {
  const TemporaryFolder folder;
  make_folder(folder / "run/winner");
  write_file(folder / "run/study.resolved.toml", "schema = 1\n");
  EXPECT_EQ(run_above(folder / "run/winner/scene.toml"), folder / "run");
  EXPECT_EQ(run_above(folder / "run/"), folder / "run");
  EXPECT_EQ(run_above(folder / "scene.toml"), fs::path());
  EXPECT_EQ(run_above({}), fs::path());
}

}  // namespace
}  // namespace glint
