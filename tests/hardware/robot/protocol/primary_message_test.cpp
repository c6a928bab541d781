// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/primary_message.h"

#include <gtest/gtest.h>

#include "hardware/robot/protocol/message_splitter.h"

namespace glint {
namespace {

std::optional<PrimaryMessage> read_back(const std::string& bytes) {
  FrameSplitter splitter = FrameSplitter::of_primary();
  splitter.append(bytes);
  const auto frame = splitter.next();
  return parse_primary(frame->kind, frame->payload);
}

TEST(PrimaryMessage, IsReadBack) {
  using enum PrimaryMessage::Kind;
  for (const PrimaryMessage::Kind kind : {kText, kErrorCode, kKey, kRuntimeException}) {
    const auto message = read_back(primary_frame(
        {.stamp_us = 17, .kind = kind, .code = 0, .argument = 0, .text = "singularity"}));
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(message->kind, kind);
    EXPECT_EQ(message->stamp_us, 17U);
    EXPECT_EQ(message->text, "singularity");
  }
}

TEST(PrimaryMessage, StatesAndUnknownKindsAreSkipped) {
  EXPECT_FALSE(read_back(primary_state_frame(1, true, false, 7)).has_value());
  EXPECT_FALSE(
      read_back(primary_frame({.kind = static_cast<PrimaryMessage::Kind>(42), .text = "x"}))
          .has_value());
}

TEST(PrimaryMessage, ShortOnesAreRefusedAndTextsAreMadePlain) {
  EXPECT_THROW(parse_primary(kPrimaryRobotMessage, "short"), ProtocolError);
  EXPECT_EQ(read_back(primary_frame({.text = "a\x1b[31m\n"}))->text, "a?[31m?");
}

}  // namespace
}  // namespace glint
