// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/confirmed_lights.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquire_run.h"
#include "studies/cell/typed_permit.h"
#include "tests/studies/acquire/run_of_prototypes.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two lights that a person switches, and one behind an output.
Cell hand_lit_cell() {
  Cell cell;
  cell.file = "cell.toml";
  cell.lights = {{.name = "ring", .kind = CellLight::Kind::kManual},
                 {.name = "bar", .kind = CellLight::Kind::kDigitalOutput},
                 {.name = "dome", .kind = CellLight::Kind::kManual}};
  return cell;
}

TEST(ConfirmedLights, CountForTheStateThatIsNeededFirst) {
  ConfirmedLights lights({"ring"});
  EXPECT_TRUE(lights.is_set("ring", true));
  EXPECT_TRUE(lights.is_set("ring", false)) << "nothing was needed of it so far";
  EXPECT_FALSE(lights.is_set("dome", true)) << "is not named";
  lights.note("ring", true);
  EXPECT_TRUE(lights.is_set("ring", true));
  EXPECT_FALSE(lights.is_set("ring", false));
}

// A view that was rejected comes first again, with another light than the last one that was asked
// for.
TEST(ConfirmedLights, CountForTheStateThatIsTold) {
  const ConfirmedLights lights({"ring=off", "dome=on"});
  EXPECT_FALSE(lights.is_set("ring", true)) << "though it is needed first";
  EXPECT_TRUE(lights.is_set("ring", false));
  EXPECT_TRUE(lights.is_set("dome", true));
  EXPECT_FALSE(lights.is_set("dome", false));
}

TEST(ConfirmedLights, FollowAPersonWhoSwitchesThem) {
  ConfirmedLights lights({"ring"});
  lights.note("ring", true);
  lights.note("ring", false);  // was asked for, and done
  EXPECT_TRUE(lights.is_set("ring", false));
  EXPECT_FALSE(lights.is_set("ring", true));
  lights.note("dome", true);
  EXPECT_FALSE(lights.is_set("dome", true)) << "of others somebody is asked each time";
}

TEST(LightWish, NamesWhatAPersonHasToSwitch) {
  const Cell cell = hand_lit_cell();
  const ViewTask task = {.lights = {"ring", "bar"}};
  const auto both = light_wish(ConfirmedLights(), cell, task);
  ASSERT_TRUE(both.has_value());
  EXPECT_THAT(both->lights, ElementsAre("ring", "dome"));
  EXPECT_THAT(both->confirm, ElementsAre("ring=on", "dome=off"));
  EXPECT_EQ(both->text,
            "turn on the light ring, turn off the light dome, then leave the arm's reach");
  EXPECT_FALSE(light_wish(ConfirmedLights({"ring", "dome"}), cell, task).has_value());
  ConfirmedLights off({"ring", "dome"});
  off.note("ring", false);  // of the design before
  EXPECT_THAT(light_wish(off, cell, task).value().lights, ElementsAre("ring"));
}

TEST(CheckConfirmed, RefusesWhatNobodySwitches) {
  const Cell cell = hand_lit_cell();
  EXPECT_NO_THROW(check_confirmed({"ring", "dome=off"}, cell));
  for (const char* name : {"rnig", "bar", "bar=on", "ring=of"}) {
    EXPECT_THAT([&] { check_confirmed({name}, cell); },
                testing::ThrowsMessage<ConfigError>(HasSubstr("these are ring, dome")));
  }
  EXPECT_THAT([] { check_confirmed({"ring"}, Cell{.file = "dark.toml"}); },
              testing::ThrowsMessage<ConfigError>(
                  HasSubstr("--confirmed ring: is no light of dark.toml that a person switches; it "
                            "has none")));
}

// The design before was taken under the ring: for the one without it, which needs no other
// prototype, somebody has to switch it off.
TEST_F(PrototypesOfARun, DoNotTakeALightForOffThatWasConfirmedForADesignBefore) {
  std::string cell = kLonelyCell;
  cell.replace(cell.find("output = 0"), 10, "kind = \"manual\"");
  write_file(folder_ / "cell.toml", cell);
  ConfirmedLights lights({"ring"});
  const AcquireOptions options = {.source = scene("dark"),
                                  .cell = folder_ / "cell.toml",
                                  .out = folder_ / "out",
                                  .confirmed = {"ring"},
                                  .mounted = {"dark"},
                                  .lights = &lights};
  const MotionPermit permit = typed_permit(true, "validate --cell");
  EXPECT_THROW(acquire_pictures(options, permit), IoError) << "nobody listens, nobody is asked";
  lights.note("ring", true);
  const nlohmann::json waiting = acquire_pictures(options, permit);
  EXPECT_EQ(waiting["status"], "waiting");
  EXPECT_EQ(waiting["next"]["lights"], nlohmann::json::array({"ring"}));
  EXPECT_EQ(waiting["next"]["text"], "turn off the light ring, then leave the arm's reach");
  EXPECT_FALSE(std::filesystem::exists(options.out));
}

}  // namespace
}  // namespace glint
