// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/mounted_prototypes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "studies/acquire/acquire_run.h"
#include "studies/cell/typed_permit.h"
#include "studies/definition/study.h"
#include "tests/studies/acquire/run_of_prototypes.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using testing::_;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST_F(PrototypesOfARun, AreThoseOfAllLightsWhateverTheirPower) {
  write_file(scene("bright"), scene_text(50, 9, 3));
  const auto lights_of = [&](const std::string& design) {
    return built_lights(load_study(scene(design), {}).scene);
  };
  EXPECT_EQ(lights_of("narrow"), lights_of("bright"));
  EXPECT_NE(lights_of("narrow"), lights_of("wide"));
  EXPECT_EQ(lights_of("narrow").at("bar"), lights_of("wide").at("bar"));
  EXPECT_THAT(lights_of("dark"), ElementsAre(Pair("bar", _), Pair("ring", _)));
  write_file(scene("unused"), "lighting_use = \"bar\"\n" + scene_text(50, 9));
  EXPECT_EQ(lights_of("unused"), lights_of("narrow"));
}

TEST_F(PrototypesOfARun, AreTheSameWhereTheStageMovesTheStripes) {
  const auto tunnel = [](double offset_mm, double radius_mm) {
    SceneSettings scene;
    scene.has_tunnel = true;
    scene.tunnel.offset_mm = offset_mm;
    scene.tunnel.radius_mm = radius_mm;
    return built_lights(scene);
  };
  EXPECT_EQ(tunnel(0, 80), tunnel(3, 80));
  EXPECT_NE(tunnel(0, 80), tunnel(0, 90));
}

TEST_F(PrototypesOfARun, AreNeverTakenForMounted) {
  MountedPrototypes unknown = prototypes();
  EXPECT_THAT(unknown.wish("wide").value_or(""), HasSubstr("prototype of wide (ring)"));
  EXPECT_TRUE(unknown.wish("narrow").has_value());
  EXPECT_THAT(unknown.wish("dark").value_or(""), HasSubstr("prototype of dark (ring)"))
      << "a ring that does not shine hangs there too";
  unknown.mount("wide");
  EXPECT_FALSE(unknown.wish("wide").has_value());
  EXPECT_TRUE(unknown.wish("narrow").has_value());
  unknown.mount("narrow");
  EXPECT_TRUE(unknown.wish("wide").has_value()) << "the other ring is off again";
  EXPECT_FALSE(prototypes({"wide/"}).wish("wide").has_value());
}

TEST_F(PrototypesOfARun, AreTakenDownForDesignsThatHaveNone) {
  const std::string text = scene_text(50);
  write_file(scene("bare"), text.substr(0, text.find("[lighting.bar]")));
  MountedPrototypes all = prototypes({"narrow"});
  EXPECT_THAT(all.wish("bare").value_or(""), HasSubstr("prototype of bare, take down bar"));
  all.mount("bare");
  EXPECT_FALSE(all.wish("bare").has_value());
  EXPECT_THAT(all.wish("narrow").value_or(""), HasSubstr("prototype of narrow (bar)"));
  EXPECT_THROW(prototypes({"narrow", "bare"}), ConfigError);
}

TEST_F(PrototypesOfARun, AreExchangedOnceForDesignsThatAreBuiltAlike) {
  write_file(scene("unlit"), scene_text(50, 4, 0));
  MountedPrototypes all = prototypes();
  std::vector<std::filesystem::path> left = {scene("narrow"), scene("wide"), scene("unlit")};
  EXPECT_EQ(all.next_of(left), 0U);
  all.mount("narrow");
  left.erase(left.begin());
  EXPECT_EQ(all.next_of(left), 1U) << "an output switches the bar off, unlit needs nobody";
}

TEST_F(PrototypesOfARun, AreSetByHandWhereTheyShineAtAnotherPower) {
  write_file(scene("bright"), scene_text(50, 9));
  MountedPrototypes all = prototypes();
  EXPECT_THAT(all.wish("bright").value_or(""),
              HasSubstr("mount the prototype of bright (ring), a"));
  all.mount("narrow");
  EXPECT_EQ(all.wish("bright").value_or(""),
            "set the power of ring as bright has it, and leave the arm's reach");
  all.mount("bright");
  EXPECT_FALSE(all.wish("bright").has_value());
  EXPECT_TRUE(all.wish("narrow").has_value());
  all.mount("dark");
  EXPECT_THAT(all.wish("bright").value_or(""), HasSubstr("prototype of bright (ring)"))
      << "another ring hung there in between";
  EXPECT_FALSE(prototypes({"bright"}).wish("bright").has_value());
  EXPECT_THAT(([&] {
                prototypes({"bright", "narrow"});
              }),
              testing::ThrowsMessage<ConfigError>(HasSubstr("[lighting.ring] at another power")));
}

TEST_F(PrototypesOfARun, AreSetByHandAfterADesignThatHasThemOff) {
  write_file(scene("bright"), scene_text(50, 9));
  write_file(scene("off"), scene_text(50, 0));
  MountedPrototypes all = prototypes({"off"});
  EXPECT_FALSE(all.wish("off").has_value());
  EXPECT_THAT(all.wish("bright").value_or(""), HasSubstr("set the power of ring"))
      << "the right ring hangs there, at a power that nobody has told";
  all.mount("bright");
  all.mount("off");
  EXPECT_FALSE(all.wish("bright").has_value()) << "an output does not change the power";
}

TEST_F(PrototypesOfARun, AreThoseOfItsFrontToo) {
  write_file(scene("front/trial_003"), scene_text(60));
  const MountedPrototypes all = MountedPrototypes::beside(scene("front/trial_003"), {"wide"});
  EXPECT_EQ(all.design_in(scene("front/trial_003")), "front/trial_003");
  EXPECT_FALSE(all.wish("front/trial_003").has_value());
  EXPECT_TRUE(prototypes({"front/trial_003"}).wish("narrow").has_value());
  EXPECT_TRUE(MountedPrototypes::in_run(folder_ / "run/front/", {}).wish("narrow").has_value());
}

TEST_F(PrototypesOfARun, AreAskedForWhereNoStudyTellsOfThem) {
  std::filesystem::remove(folder_ / "run/study.resolved.toml");
  EXPECT_FALSE(prototypes().wish("wide").has_value()) << "a scene in no run";
  EXPECT_TRUE(MountedPrototypes::in_run(folder_ / "run", {}).wish("wide").has_value());
}

TEST_F(PrototypesOfARun, AreAskedForWhereADesignCannotBeRead) {
  for (const char* design : {"narrow", "dark"}) {
    write_file(scene(design), "schema = ");
  }
  MountedPrototypes all = prototypes();
  EXPECT_TRUE(all.wish("wide").has_value()) << "nothing differs from what is known, but it may";
  all.mount("wide");
  EXPECT_FALSE(all.wish("wide").has_value());
  EXPECT_THAT(all.wish("dark").value_or(""), HasSubstr("cannot be read"));
  all.mount("dark");
  EXPECT_FALSE(all.wish("dark").has_value());
  EXPECT_TRUE(all.wish("wide").has_value());
}

TEST_F(PrototypesOfARun, AreNotAskedForByAFolderThatIsNoDesign) {
  EXPECT_EQ(prototypes().wish("plan"), std::nullopt);
}

TEST_F(PrototypesOfARun, AreNamedByDesignsThatFitTogether) {
  EXPECT_THAT([&] { prototypes({"wider"}); },
              testing::ThrowsMessage<ConfigError>(HasSubstr("there are dark, narrow, wide")));
  EXPECT_THAT(([&] {
                prototypes({"wide", "narrow"});
              }),
              testing::ThrowsMessage<ConfigError>(HasSubstr("[lighting.ring]")));
}

TEST_F(PrototypesOfARun, AreOfNoSceneOutsideARun) {
  write_file(folder_ / "scene.toml", scene_text(50));
  const auto none = MountedPrototypes::beside(folder_ / "scene.toml", {});
  EXPECT_FALSE(none.wish(none.design_in(folder_ / "scene.toml")).has_value());
  EXPECT_FALSE(MountedPrototypes::beside({}, {}).wish("").has_value());
  EXPECT_THROW(MountedPrototypes::beside({}, {"wide"}), ConfigError);
}

TEST_F(PrototypesOfARun, AreWaitedForBeforeAnythingIsConnected) {
  write_file(folder_ / "cell.toml", kLonelyCell);

  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  const MotionPermit permit = typed_permit(true, "acquire");
  const Json result = acquire_pictures(options, permit);
  EXPECT_EQ(result["status"], "waiting");
  EXPECT_EQ(result["ok"], false);
  EXPECT_EQ(result["next"]["design"], "wide");
  std::string asked;
  options.confirm = [&asked](const std::string& what) {
    asked = what;
    return false;
  };
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
  EXPECT_EQ(asked, result["next"]["text"]);
  options.confirm = [](const std::string&) { return true; };
  EXPECT_THROW(acquire_pictures(options, permit), IoError);
  options.confirm = {};
  options.mounted = {"wide"};
  EXPECT_THROW(acquire_pictures(options, permit), IoError);
  options.mounted = {"narrow"};
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
  EXPECT_EQ(describe_acquisition(options)["next"], acquire_pictures(options, permit)["next"]);
  options.mounted = {"wide"};
  EXPECT_TRUE(describe_acquisition(options)["next"].is_null());
  options.mounted = {"wider"};
  EXPECT_THROW(describe_acquisition(options), ConfigError);
}

// Before anybody is asked for anything.
TEST_F(PrototypesOfARun, AreNotAskedForWhereTwoLightsAreSwitchedTogether) {
  std::string cell = kLonelyCell;
  cell.replace(cell.find("output = 1"), 10, "output = 0");
  write_file(folder_ / "cell.toml", cell);
  const AcquireOptions options = {
      .source = scene("wide"), .cell = folder_ / "cell.toml", .out = folder_ / "out"};
  EXPECT_THROW(describe_acquisition(options), ConfigError);
  EXPECT_THAT(text_thrown_by<ConfigError>(
                  [&] { acquire_pictures(options, typed_permit(true, "acquire")); }),
              HasSubstr("lights.bar.output: is 0, as that of lights.ring"));
}

}  // namespace
}  // namespace glint
