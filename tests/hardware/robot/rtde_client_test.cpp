// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/rtde_client.h"

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace glint {
namespace {

/// A controller's side of a session whose one output it sends as this value.
std::string session_with(const std::string& type, const RtdeValue& value) {
  return flag_reply(RtdeKind::kProtocolVersion, true) +
         controller_version_reply({.major = 5, .minor = 11, .bugfix = 0, .build = 0}) +
         recipe_reply(RtdeKind::kOutputs, {1, {type}}) + flag_reply(RtdeKind::kStart, true) +
         data_package(1, {value});
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

}  // namespace
}  // namespace glint
