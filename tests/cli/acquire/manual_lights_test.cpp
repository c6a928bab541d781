// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint acquire` where a person switches a light: what --confirmed says, and what it does not.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/acquire/small_twins.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// The gallery's views straight, under the ring, and front, under the bar alone.
std::string two_views() {
  const std::string cell = fast_cell();
  const auto at = [&cell](const std::string& view) {
    return cell.find("[[view]]\nname = \"" + view + "\"");
  };
  return cell.substr(0, at("left")) + cell.substr(at("front"), at("back") - at("front"));
}

// The ring was said to be on: what has to be taken without it is not while nobody switches it off.
TEST(Acquire, TakesNoPictureUnderALightThatNobodySwitchedOff) {
  const SmallTwins twins(two_views());
  const ProgramResult on = glint_in(twins.folder, SmallTwins::acquire("by_hand"));
  EXPECT_EQ(on.code, 1) << on.err;
  const json acquired = twins.acquired("by_hand");
  EXPECT_EQ(acquired["end"]["cause"], "light");
  EXPECT_EQ(acquired["end"]["how"], "backed_out");
  EXPECT_EQ(acquired["end"]["where"], "above");
  EXPECT_THAT(acquired["end"]["text"].get<std::string>(),
              HasSubstr("nobody confirms that it is off"));
  ASSERT_EQ(acquired["pictures"].size(), 1U);
  EXPECT_EQ(acquired["pictures"][0]["view"], "straight");
  json_of(twins.folder, {"cell", "twin", "light", "twin.json", "ring", "off"});
  const ProgramResult off = glint_in(twins.folder, SmallTwins::acquire("by_hand"));
  EXPECT_EQ(off.code, 0) << off.err << off.out;
  EXPECT_EQ(twins.acquired("by_hand")["pictures"].size(), 2U);
}

TEST(Acquire, WaitsForAManualLightBeforeItConnects) {
  const TemporaryFolder folder;
  const std::string cell = kGalleryCell / "cell.toml";  // nobody serves it
  Arguments call = {"acquire", "--cell", cell, "--out", "out", "--move"};
  const ProgramResult waiting = glint_in(folder, call);
  EXPECT_EQ(waiting.code, 1) << waiting.err;
  EXPECT_EQ(waiting.out,
            "waiting: turn on the light ring, then leave the arm's reach; then the same command "
            "with --confirmed ring=on\n");
  EXPECT_FALSE(fs::exists(folder / "out"));
  call.insert(call.end(), {"--confirmed", "rnig"});
  const ProgramResult misspelt = glint_in(folder, call);
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("--confirmed rnig: is no light of " + cell));
  EXPECT_THAT(misspelt.err, HasSubstr("these are ring"));
}

}  // namespace
}  // namespace glint::test
