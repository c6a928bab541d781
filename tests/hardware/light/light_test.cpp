// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/light/light.h"

#include <gmock/gmock.h>

#include <vector>

#include "core/error.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(OutputLight, IsBehindItsOutput) {
  std::vector<std::uint64_t> seen;
  SimulatedOutputs outputs(8, [&](std::uint64_t bits) { seen.push_back(bits); });
  OutputLight ring("ring", outputs, 3);
  OutputLight dome("dome", outputs, 0);
  EXPECT_FALSE(ring.is_on());
  ring.set(true);
  dome.set(true);
  ring.set(false);
  EXPECT_FALSE(ring.is_on());
  EXPECT_TRUE(dome.is_on());
  EXPECT_THAT(seen, ElementsAre(8, 9, 1));  // bit 3, bits 3 and 0, bit 0
}

TEST(OutputLight, IsNeverBelievedToBeOnWhenTheDeviceTellsOtherwise) {
  SimulatedOutputs outputs(8);
  OutputLight ring("ring", outputs, 3);
  outputs.block(3);
  EXPECT_THROW(ring.set(true), IoError);
  outputs.block(-1);
  ring.set(true);
  EXPECT_TRUE(ring.is_on());
}

TEST(OutputLight, NeedsAnOutputThatThereIs) {
  SimulatedOutputs outputs(8);
  try {
    const OutputLight light("ring", outputs, 8);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("lights.ring.output: is 8, the device has outputs 0 to 7"));
  }
}

TEST(PromptedLight, IsAsTheLastPersonConfirmed) {
  std::vector<std::string> asked;
  std::vector<bool> states;
  bool answer = true;
  PromptedLight bar("bar", [&](bool is_on, const std::string& what) {
    states.push_back(is_on);
    asked.push_back(what);
    return answer;
  });
  bar.set(true);
  EXPECT_TRUE(bar.is_on());
  answer = false;
  EXPECT_THROW(bar.set(false), IoError);
  EXPECT_TRUE(bar.is_on());
  EXPECT_THAT(asked,
              ElementsAre("turn on the light bar, then leave the arm's reach",
                          "turn off the light bar, then leave the arm's reach"));
  EXPECT_THAT(states, ElementsAre(true, false));
  EXPECT_THROW(PromptedLight("bar", {}).set(true), IoError);
}

}  // namespace
}  // namespace glint
