// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/rtde_package.h"

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

std::string_view payload_of(const std::string& package) {
  return std::string_view(package).substr(3);
}

// 125 Hz = 0x405F400000000000; the names follow as they are.
TEST(OutputsRequest, HasTheRateThenTheNames) {
  const std::string package = outputs_request(125.0, {"timestamp", "actual_q"});
  EXPECT_EQ(package.size(), 3U + 8U + 18U);
  EXPECT_EQ(package.substr(0, 11), std::string("\x00\x1dO\x40\x5f\x40\x00\x00\x00\x00\x00", 11));
  EXPECT_EQ(package.substr(11), "timestamp,actual_q");
}

// INT32 -2 = ff ff ff fe, UINT64 1, BOOL true; recipe 7.
TEST(DataPackage, IsBigEndianWithoutGaps) {
  const std::string package = data_package(7, {std::int32_t{-2}, std::uint64_t{1}, true});
  EXPECT_EQ(package,
            std::string("\x00\x11U\x07\xff\xff\xff\xfe\x00\x00\x00\x00\x00\x00\x00\x01\x01", 17));
}

RtdeValue random_value(RtdeType type, Rng& rng) {
  std::string bytes(size_of(type), '\0');
  for (char& byte : bytes) {
    byte = static_cast<char>(rng.next_u32());
  }
  if (type == RtdeType::kBool) {
    bytes[0] = static_cast<char>(bytes[0] & 1);
  }
  ByteReader reader(bytes);
  return take(reader, type);
}

TEST(ParseData, GivesBackWhatWasPacked) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(5, Stream::kTest, i);
    RtdeRecipe recipe = {.id = 3, .names = {}, .types = {}};
    std::vector<RtdeValue> values;
    for (int k = 0; k < 12; ++k) {
      recipe.types.push_back(static_cast<RtdeType>(rng.next_u32() % kRtdeTypeNames.size()));
      values.push_back(random_value(recipe.types.back(), rng));
    }
    const std::string package = data_package(3, values);
    EXPECT_EQ(package.size(), 4 + recipe.size_bytes());
    // Compared as bytes, as numbers may be NaN.
    EXPECT_EQ(data_package(3, parse_data(payload_of(package), recipe)), package);
  }
}

TEST(ParseData, RefusesAnotherLengthAndAnotherRecipe) {
  const RtdeRecipe recipe = {.id = 3, .names = {"timestamp"}, .types = {RtdeType::kDouble}};
  EXPECT_THROW(parse_data("", recipe), ProtocolError);
  EXPECT_THROW(parse_data(std::string(8, '\3'), recipe), ProtocolError);
  EXPECT_THROW(parse_data(std::string(10, '\3'), recipe), ProtocolError);
  EXPECT_THROW(parse_data(std::string(9, '\2'), recipe), ProtocolError);
  EXPECT_NO_THROW(parse_data(std::string(9, '\3'), recipe));
}

TEST(RecipeReply, HasTypesOrSaysWhyNot) {
  const RecipeReply reply = parse_recipe_reply(
      payload_of(recipe_reply(RtdeKind::kOutputs, {1, {"DOUBLE", "NOT_FOUND"}})));
  EXPECT_EQ(reply.id, 1);
  EXPECT_EQ(reply.types, (std::vector<std::string>{"DOUBLE", "NOT_FOUND"}));
  EXPECT_THROW(parse_recipe_reply(""), ProtocolError);
  EXPECT_THROW(parse_recipe_reply("\1"), ProtocolError);
  EXPECT_THROW(parse_recipe_reply("\1FLOAT"), ProtocolError);
}

TEST(ControllerVersion, IsFourNumbers) {
  const ControllerVersion version = {.major = 5, .minor = 11, .bugfix = 4, .build = 108320};
  EXPECT_EQ(parse_controller_version(payload_of(controller_version_reply(version))).text(),
            "5.11.4.108320");
  EXPECT_THROW(parse_controller_version(std::string(15, '\0')), ProtocolError);
}

TEST(TextPackage, IsReadBackAndItsLengthsAreChecked) {
  const RtdeText text =
      parse_text(payload_of(text_package({.message = "hello", .source = "RTDE", .level = 1})));
  EXPECT_EQ(text.message, "hello");
  EXPECT_EQ(text.source, "RTDE");
  EXPECT_EQ(text.level, 1);
  EXPECT_THROW(parse_text("\xffshort"), ProtocolError);
}

// Of the issue: the types that controllers give.
TEST(OutputType, IsThatOfTheControllersTable) {
  EXPECT_EQ(output_type("timestamp"), RtdeType::kDouble);
  EXPECT_EQ(output_type("speed_scaling"), RtdeType::kDouble);
  EXPECT_EQ(output_type("actual_q"), RtdeType::kVector6d);
  EXPECT_EQ(output_type("actual_TCP_speed"), RtdeType::kVector6d);
  EXPECT_EQ(output_type("robot_mode"), RtdeType::kInt32);
  EXPECT_EQ(output_type("safety_mode"), RtdeType::kInt32);
  EXPECT_EQ(output_type("output_int_register_23"), RtdeType::kInt32);
  EXPECT_EQ(output_type("runtime_state"), RtdeType::kUint32);
  EXPECT_EQ(output_type("robot_status_bits"), RtdeType::kUint32);
  EXPECT_EQ(output_type("safety_status_bits"), RtdeType::kUint32);
  EXPECT_EQ(output_type("actual_digital_output_bits"), RtdeType::kUint64);
  EXPECT_EQ(output_type("output_int_register_48"), std::nullopt);
  EXPECT_EQ(output_type("output_int_register_"), std::nullopt);
  EXPECT_EQ(output_type("output_int_register_1x"), std::nullopt);
  EXPECT_EQ(output_type("no_such_output"), std::nullopt);
  EXPECT_EQ(input_type("standard_digital_output_mask"), RtdeType::kUint8);
}

}  // namespace
}  // namespace glint
