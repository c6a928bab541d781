// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/mounted_prototypes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquire_run.h"
#include "studies/cell/typed_permit.h"
#include "studies/definition/study.h"
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

TEST_F(PrototypesOfARun, AreThoseOfLightsThatShineWhateverTheirPower) {
  write_file(scene("bright"), scene_text(50, 9, 3));
  const auto lights_of = [&](const std::string& design) {
    return built_lights(load_study(scene(design), {}).scene);
  };
  EXPECT_EQ(lights_of("narrow"), lights_of("bright"));
  EXPECT_NE(lights_of("narrow"), lights_of("wide"));
  EXPECT_EQ(lights_of("narrow").at("bar"), lights_of("wide").at("bar"));
  EXPECT_THAT(lights_of("dark"), ElementsAre(Pair("bar", _)));
}

TEST_F(PrototypesOfARun, AreNeverTakenForMounted) {
  MountedPrototypes unknown = prototypes();
  EXPECT_THAT(unknown.wish("wide").value_or(""), HasSubstr("prototype of wide (ring)"));
  EXPECT_TRUE(unknown.wish("narrow").has_value());
  EXPECT_FALSE(unknown.wish("dark").has_value()) << "outputs switch the bar that all share";
  unknown.mount("wide");
  EXPECT_FALSE(unknown.wish("wide").has_value());
  EXPECT_TRUE(unknown.wish("narrow").has_value());
  unknown.mount("narrow");
  EXPECT_TRUE(unknown.wish("wide").has_value()) << "the other ring is off again";
  EXPECT_FALSE(prototypes({"dark", "wide"}).wish("wide").has_value());
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
  EXPECT_FALSE(none.wish(MountedPrototypes::design_in(folder_ / "scene.toml")).has_value());
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
}

}  // namespace
}  // namespace glint
