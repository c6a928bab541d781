// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/mounted_prototypes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquire_plan.h"
#include "studies/acquire/acquire_run.h"
#include "studies/acquire/journal.h"
#include "studies/cell/typed_permit.h"
#include "studies/definition/study.h"
#include "studies/output/result_folder.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using testing::_;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

/// A plate under a ring of this outer radius and a bar, each as bright as told.
std::string scene_text(double radius_mm, double ring = 4, double bar = 8) {
  return fmt::format(R"(schema = 1
[part]
shape = "plate"
length_mm = 40
width_mm = 40
thickness_mm = 5
[material]
type = "diffuse"
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = {}
height_mm = 80
radiance = [{}]
[lighting.bar]
mount = "camera"
position_mm = [0, -100, 80]
direction = [0, 1, 1]
length_mm = 120
width_mm = 25
radiance = [{}]
)",
                     radius_mm,
                     ring,
                     bar);
}

/// A run with designs narrow and wide, whose rings differ, and dark, whose ring is off.
class PrototypesOfARun : public testing::Test {
 protected:
  PrototypesOfARun() {
    make_folder(folder_ / "run");
    write_file(folder_ / "run/study.resolved.toml", "schema = 1\n");
    write_file(scene("narrow"), scene_text(50));
    write_file(scene("wide"), scene_text(60));
    write_file(scene("dark"), scene_text(70, 0));
  }

  std::filesystem::path scene(const std::string& design) const {
    const std::filesystem::path folder = folder_ / "run" / design;
    make_folder(folder);
    return folder / "scene.toml";
  }

  MountedPrototypes prototypes(const std::vector<std::string>& mounted = {}) const {
    return MountedPrototypes::beside(scene("wide"), mounted);
  }

  TemporaryFolder folder_;
};

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
  write_file(scene("bright"), scene_text(50, 9));
  MountedPrototypes all = prototypes();
  std::vector<std::filesystem::path> left = {scene("narrow"), scene("wide"), scene("bright")};
  EXPECT_EQ(all.next_of(left), 0U);
  all.mount("narrow");
  left.erase(left.begin());
  EXPECT_EQ(all.next_of(left), 1U) << "bright needs nobody";
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

/// Nobody listens at its robot: whoever does not wait fails to connect.
constexpr const char* kLonelyCell = R"([camera]
address = "127.0.0.1"
[robot]
model = "ur3"
host = "127.0.0.1"
rtde_port = 1
flange_from_tcp = [0, 0, 80, 0, 0, 0]
tool_radius_mm = 35
payload_kg = 0.6
[limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 500
joint_speed_deg_s = 60
joint_acceleration_deg_s2 = 120
box_min_mm = [-600, -600, 20]
box_max_mm = [600, 600, 900]
[lights.ring]
output = 0
[lights.bar]
output = 1
[[safe_position]]
joints_deg = [0, -100, 100, -90, -90, 0]
[[view]]
joints_deg = [10, -95, 95, -85, -90, 0]
)";

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

/// A folder as a whole acquisition of the lonely cell's only view leaves it.
void write_pictures(const AcquireOptions& options) {
  const Cell cell = read_cell(options.cell);
  const AcquireWork work = work_of(read_source(options.source), cell, options.speed_share);
  make_folder(options.out);
  AcquireJournal journal(options.out, work.digest);
  journal.keep({.view = work.plan.tasks.front().name, .file = "views/view_1/frame_000.png"},
               "bytes of a picture");
  write_file(options.out / "acquired.json",
             R"({"kind": "acquired", "status": "complete", "pictures": []})");
  mark_result_folder(options.out, ResultKind::kAcquire);
}

TEST_F(PrototypesOfARun, AreNotAskedForWhenAllPicturesAreThere) {
  write_file(folder_ / "cell.toml", kLonelyCell);
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options);
  const MotionPermit permit = typed_permit(true, "acquire");
  EXPECT_THROW(acquire_pictures(options, permit), IoError) << "nobody listens, nobody is asked";
  EXPECT_TRUE(describe_acquisition(options)["next"].is_null());
  write_file(scene("wide"), scene_text(65));
  EXPECT_THAT([&] { acquire_pictures(options, permit); },
              testing::ThrowsMessage<ConfigError>(HasSubstr("another plan, cell, scene or")))
      << "pictures of another prototype";
  write_file(scene("wide"), scene_text(60));
  write_file(options.out / "views/view_1/frame_000.png", "other bytes");
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
  std::filesystem::remove(options.out / "views/view_1/frame_000.png");
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
}

}  // namespace
}  // namespace glint
