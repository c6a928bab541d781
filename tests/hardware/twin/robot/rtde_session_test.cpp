// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/rtde_session.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/hardware/twin/robot/twin_harness.h"

namespace glint {
namespace {

struct Bench {
  TwinController twin{test_twin(ArmModel::kUr3)};
  HeldInputs held;
  RtdeSession session{twin, held};

  /// Types of a reply to a recipe.
  static RecipeReply recipe(RtdeSession& session, const std::string& request) {
    return parse_recipe_reply(std::string_view(session.on_bytes(request)).substr(3));
  }

  /// Packages of data in a second.
  int packages() {
    int count = 0;
    for (int i = 0; i < 125; ++i) {
      twin.step(0.008);
      count += session.on_cycle().empty() ? 0 : 1;
    }
    return count;
  }
};

TEST(RtdeSession, AcceptsVersionTwoAlone) {
  Bench bench;
  EXPECT_EQ(bench.session.on_bytes(version_request(2)),
            flag_reply(RtdeKind::kProtocolVersion, true));
  EXPECT_EQ(bench.session.on_bytes(version_request(3)),
            flag_reply(RtdeKind::kProtocolVersion, false));
}

TEST(RtdeSession, SaysNotFoundAndThenDoesNotStart) {
  Bench bench;
  const RecipeReply reply =
      Bench::recipe(bench.session, outputs_request(125.0, {"timestamp", "no_such", "robot_mode"}));
  EXPECT_EQ(reply.types, (std::vector<std::string>{"DOUBLE", "NOT_FOUND", "INT32"}));
  EXPECT_EQ(bench.session.on_bytes(start_request()), flag_reply(RtdeKind::kStart, false));
  EXPECT_EQ(bench.packages(), 0);
}

TEST(RtdeSession, SendsAtTheRateAskedForUntilPaused) {
  for (const double rate_hz : {125.0, 100.0, 62.5, 25.0, 10.0, 1.0}) {
    Bench bench;
    Bench::recipe(bench.session, outputs_request(rate_hz, {"timestamp"}));
    EXPECT_EQ(bench.packages(), 0) << "not started";
    EXPECT_EQ(bench.session.on_bytes(start_request()), flag_reply(RtdeKind::kStart, true));
    EXPECT_NEAR(bench.packages(), rate_hz, 1.0);
    EXPECT_EQ(bench.session.on_bytes(rtde_package(RtdeKind::kPause, {})),
              flag_reply(RtdeKind::kPause, true));
    EXPECT_EQ(bench.packages(), 0);
  }
}

TEST(RtdeSession, AnInputIsHeldByOneClient) {
  Bench bench;
  const std::string request = inputs_request({"input_int_register_24"});
  EXPECT_EQ(Bench::recipe(bench.session, request).types[0], "INT32");
  {
    RtdeSession second(bench.twin, bench.held);
    EXPECT_EQ(Bench::recipe(second, request).types[0], "IN_USE");
    EXPECT_EQ(Bench::recipe(second, request).id, 0);
    EXPECT_EQ(Bench::recipe(second, inputs_request({"standard_digital_output"})).types[0], "UINT8");
  }
  RtdeSession third(bench.twin, bench.held);
  EXPECT_EQ(Bench::recipe(third, inputs_request({"standard_digital_output"})).types[0], "UINT8")
      << "a client that is gone holds nothing";
}

// One byte holds the id of a recipe, 0 stands for none.
TEST(RtdeSession, NoIdOfARecipeIsGivenTwiceHoweverOftenOutputsAreSetUp) {
  Bench bench;
  const std::uint8_t inputs =
      Bench::recipe(bench.session, inputs_request({"speed_slider_mask"})).id;
  EXPECT_GT(inputs, 0);
  for (int i = 0; i < 600; ++i) {
    const std::uint8_t outputs =
        Bench::recipe(bench.session, outputs_request(125.0, {"timestamp"})).id;
    ASSERT_NE(outputs, 0) << i;
    ASSERT_NE(outputs, inputs) << i;
  }
}

// Mask 0b110, values 0b011: output 1 on, output 2 off, output 0 as it was.
TEST(RtdeSession, DigitalOutputsFollowTheirMask) {
  Bench bench;
  const RecipeReply reply = Bench::recipe(
      bench.session, inputs_request({"standard_digital_output_mask", "standard_digital_output"}));
  bench.session.on_bytes(data_package(reply.id, {std::uint8_t{6}, std::uint8_t{3}}));
  EXPECT_EQ(bench.twin.view().digital_outputs, 2U);
  bench.session.on_bytes(data_package(reply.id, {std::uint8_t{1}, std::uint8_t{1}}));
  EXPECT_EQ(bench.twin.view().digital_outputs, 3U);
}

TEST(RtdeSession, DataThatFitNoRecipeAreAnsweredWithAWarning) {
  Bench bench;
  const std::string reply = bench.session.on_bytes(data_package(9, {1.0}));
  EXPECT_EQ(static_cast<RtdeKind>(reply.at(2)), RtdeKind::kText);
  EXPECT_EQ(parse_text(std::string_view(reply).substr(3)).level, 2);
}

TEST(RtdeSession, RefusesWhatIsNoRtdeAndRecipesThatAreTooLong) {
  Bench bench;
  EXPECT_THROW(bench.session.on_bytes(std::string("\x00\x03?", 3)), ProtocolError);
  Bench other;
  EXPECT_EQ(Bench::recipe(other.session,
                          outputs_request(125.0, std::vector<std::string>(300, "timestamp")))
                .types[0],
            "NOT_FOUND");
}

TEST(RtdeSession, OlderControllersDoNotKnowNewerOutputs) {
  TwinSettings settings = test_twin(ArmModel::kUr3);
  settings.has_newer_outputs = false;
  TwinController twin(settings);
  HeldInputs held;
  RtdeSession session(twin, held);
  EXPECT_EQ(Bench::recipe(session, outputs_request(125.0, {"payload"})).types[0], "NOT_FOUND");
}

TEST(RtdeClient, KeepsTheNewestTexts) {
  RtdeClient client({.outputs = {"timestamp"}});
  for (int i = 1; i <= 25; ++i) {
    client.feed(text_package({.message = fmt::format("{}", i), .source = "test", .level = 1}),
                [] {});
  }
  ASSERT_EQ(client.texts().size(), 20U);
  EXPECT_EQ(client.texts().front(), "6");
  EXPECT_EQ(client.texts().back(), "25");
}

}  // namespace
}  // namespace glint
