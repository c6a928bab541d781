// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/rtde_client.h"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

/// A controller's side of a session up to the types of its outputs.
std::string opened() {
  return flag_reply(RtdeKind::kProtocolVersion, true) +
         controller_version_reply({.major = 5, .minor = 11, .bugfix = 0, .build = 0});
}

std::string outputs_of(const std::vector<std::string>& types, std::uint8_t id = 1) {
  return recipe_reply(RtdeKind::kOutputs, {id, types});
}

std::string started() {
  return flag_reply(RtdeKind::kStart, true);
}

/// A session whose one output it sends as this value.
std::string session_with(const std::string& type, const RtdeValue& value) {
  return opened() + outputs_of({type}) + started() + data_package(1, {value});
}

/// Of an output whose type is not known beforehand.
std::uint64_t token_in(const std::string& session) {
  RtdeClient client({.outputs = {"glint_twin_token"}, .newer = {}, .inputs = {}, .rate_hz = 0.0});
  std::uint64_t token = 0;
  client.feed(session, [&] { token = client.get<std::uint64_t>("glint_twin_token"); });
  return token;
}

TEST(RtdeClient, AnOutputOfAnotherTypeIsAnErrorOfTheProtocol) {
  EXPECT_EQ(token_in(session_with("UINT64", std::uint64_t{77})), 77U);
  EXPECT_THROW(token_in(session_with("DOUBLE", 77.0)), ProtocolError);
  EXPECT_THROW(token_in(session_with("UINT32", std::uint32_t{77})), ProtocolError);
}

/// What is wrong with a session in which timestamp alone is asked for; empty: nothing.
std::string problem_of_session(const std::string& session,
                               const std::vector<std::string>& inputs = {}) {
  RtdeClient client({.outputs = {"timestamp"}, .newer = {}, .inputs = inputs, .rate_hz = 0.0});
  try {
    client.feed(session, [] {});
  } catch (const ProtocolError& error) {
    return error.what();
  }
  return "";
}

TEST(RtdeClient, NamesWhatIsNotAsItWasAskedFor) {
  const std::string doubles = opened() + outputs_of({"DOUBLE"});
  const std::pair<std::string, const char*> cases[] = {
      {flag_reply(RtdeKind::kProtocolVersion, false), "does not know version 2"},
      {flag_reply(RtdeKind::kProtocolVersion, true) +
           rtde_package(RtdeKind::kControllerVersion, std::string(12, '\0')),
       "a controller version of 12 bytes"},
      {outputs_of({"DOUBLE"}), "a package of kind 79, expected was 86"},
      {opened() + outputs_of({"VECTOR6D"}), "timestamp is VECTOR6D, must be DOUBLE"},
      {opened() + outputs_of({"NOT_FOUND"}), "does not know timestamp"},
      {opened() + outputs_of({"DOUBLE", "DOUBLE"}), "types of 2 outputs, asked was for 1"},
      {doubles + flag_reply(RtdeKind::kStart, false), "does not start to send"},
      {doubles + started() + data_package(2, {1.0}), "data of recipe 2, asked was for 1"},
      {doubles + started() + data_package(1, {std::int32_t{1}}), "data of 5 bytes"},
      {doubles + started() + started(), "a package of kind 83, expected was 85"}};
  for (const auto& [session, says] : cases) {
    EXPECT_THAT(problem_of_session(session), HasSubstr(says));
  }
  EXPECT_EQ(problem_of_session(doubles + started() + data_package(1, {1.0})), "");
}

TEST(RtdeClient, WritesNoInputsOfOtherTypesThanItKnows) {
  const std::vector<std::string> outputs = {"standard_digital_output_mask",
                                            "standard_digital_output"};
  const auto problem = [&outputs](const std::vector<std::string>& types) {
    return problem_of_session(
        opened() + outputs_of({"DOUBLE"}) + recipe_reply(RtdeKind::kInputs, {3, types}), outputs);
  };
  EXPECT_EQ(problem({"UINT8", "UINT8"}), "");
  EXPECT_THAT(problem({"UINT8"}), HasSubstr("types of 1 inputs, asked was for 2"));
  EXPECT_THAT(problem({"UINT8", "UINT32"}),
              HasSubstr("standard_digital_output is UINT32, must be UINT8"));
  EXPECT_THAT(problem({"IN_USE", "UINT8"}),
              HasSubstr("standard_digital_output_mask: is held by another client"));
  EXPECT_THAT(problem({"UINT8", "NOT_FOUND"}), HasSubstr("is not known"));
}

TEST(RtdeClient, AsksAgainWithoutWhatAnOlderControllerDoesNotKnow) {
  RtdeClient client(
      {.outputs = {"timestamp"}, .newer = {"payload", "tcp_offset"}, .inputs = {}, .rate_hz = 0.0});
  client.feed(opened(), [] {});
  EXPECT_THAT(client.take_output(), EndsWith("timestamp,payload,tcp_offset"));
  client.feed(outputs_of({"DOUBLE", "NOT_FOUND", "VECTOR6D"}, 0), [] {});
  EXPECT_THAT(client.take_output(), EndsWith("timestamp,tcp_offset"));
  const std::array<double, 6> offset = {1, 2, 3, 4, 5, 6};
  client.feed(outputs_of({"DOUBLE", "VECTOR6D"}, 2) + started() + data_package(2, {0.5, offset}),
              [] {});
  EXPECT_TRUE(client.is_streaming());
  EXPECT_FALSE(client.has("payload"));
  EXPECT_EQ((client.get<std::array<double, 6>>("tcp_offset")), offset);
}

/// The stamps that a session tells when its bytes come in two parts.
std::vector<double> stamps_in(const std::string& session, std::size_t cut) {
  RtdeClient client({.outputs = {"timestamp"}, .newer = {}, .inputs = {}, .rate_hz = 0.0});
  std::vector<double> stamps;
  const auto keep = [&] { stamps.push_back(client.get<double>("timestamp")); };
  client.feed(std::string_view(session).substr(0, cut), keep);
  client.feed(std::string_view(session).substr(cut), keep);
  return stamps;
}

// Several packages at once, and texts between them.
TEST(RtdeClient, ReadsTheSameWhereverTheStreamIsCut) {
  const std::string text = text_package({.message = "a word", .source = "test", .level = 2});
  const std::string session = text + opened() + text + outputs_of({"DOUBLE"}) + started() +
                              data_package(1, {1.0}) + text + data_package(1, {2.0}) +
                              data_package(1, {3.0}) + text;
  for (std::size_t cut = 0; cut <= session.size(); ++cut) {
    EXPECT_THAT(stamps_in(session, cut), ElementsAre(1.0, 2.0, 3.0)) << cut;
  }
}

}  // namespace
}  // namespace glint
