// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint stability` on two sweeps.
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;

TEST(StabilityVerb, WritesItsFilesAndExitsWithTheVerdict) {
  const TemporaryFolder folder;
  const Arguments arguments = {"stability",
                               "--sweep",
                               "winner_blur",
                               "--sweep",
                               "switches",
                               "--out",
                               "s",
                               "--json",
                               "--quiet"};
  const ProgramResult result = glint_in(folder, arguments);
  ASSERT_EQ(result.code, 0) << result.err;
  const Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["totals"]["silently_wrong"], 0);
  EXPECT_EQ(printed["totals"]["right"], 8);
  for (const std::string name : {"stability.json", "stability.html", "run.json"}) {
    EXPECT_TRUE(fs::exists(folder / "s" / name)) << name;
  }
  Arguments strict = arguments;
  strict.insert(strict.end(), {"--h_points", "1e-9"});
  EXPECT_EQ(glint_in(folder, strict).code, 1) << "a bound that no method keeps";
}

TEST(StabilityVerb, ListsItsSweepsAndRefusesUnknownOnes) {
  const TemporaryFolder folder;
  EXPECT_THAT(glint_in(folder, {"stability", "--list"}).out, HasSubstr("gain"));
  const ProgramResult unknown = glint_in(folder, {"stability", "--sweep", "gian", "--out", "s"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("--sweep: is \"gian\", allowed: positions_over_period"));
  EXPECT_FALSE(fs::exists(folder / "s"));
}

}  // namespace
}  // namespace glint::test
