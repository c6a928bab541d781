// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/protocol/message_splitter.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "hardware/robot/protocol/rtde_package.h"

namespace glint {
namespace {

// 00 05 56 00 02: five bytes, 'V', version 2.
TEST(FrameSplitter, CutsAPackageWorkedByHand) {
  FrameSplitter splitter = FrameSplitter::of_rtde();
  splitter.append(std::string_view("\x00\x05V\x00\x02", 5));
  const auto frame = splitter.next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->kind, 'V');
  EXPECT_EQ(frame->payload, std::string_view("\x00\x02", 2));
  EXPECT_EQ(version_request(), std::string_view("\x00\x05V\x00\x02", 5));
}

TEST(FrameSplitter, GivesTheSameFramesHoweverTheStreamIsCut) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Rng rng(seed, Stream::kTest, 1);
    std::string stream;
    std::vector<std::string> payloads;
    for (int i = 0; i < 10; ++i) {
      payloads.emplace_back(static_cast<std::size_t>(rng.uniform(0, 300)), 'a');
      stream += rtde_package(RtdeKind::kData, payloads.back());
    }
    FrameSplitter splitter = FrameSplitter::of_rtde();
    std::size_t count = 0;
    for (std::size_t at = 0; at < stream.size();) {
      const auto length = 1 + static_cast<std::size_t>(rng.uniform(0, 400));
      splitter.append(std::string_view(stream).substr(at, length));
      at += length;
      while (const auto frame = splitter.next()) {
        EXPECT_EQ(frame->payload, payloads.at(count));
        ++count;
      }
    }
    EXPECT_EQ(count, payloads.size());
    EXPECT_EQ(splitter.buffered_bytes(), 0U);
  }
}

TEST(FrameSplitter, RefusesLengthsThatNoMessageHas) {
  FrameSplitter rtde = FrameSplitter::of_rtde();
  rtde.append(std::string_view("\x00\x02V", 3));
  EXPECT_THROW(rtde.next(), ProtocolError);
  FrameSplitter primary = FrameSplitter::of_primary();
  primary.append(std::string_view("\x7f\xff\xff\xff\x10", 5));
  EXPECT_THROW(primary.next(), ProtocolError);
  FrameSplitter negative = FrameSplitter::of_primary();
  negative.append(std::string_view("\xff\xff\xff\xff\x10", 5));
  EXPECT_THROW(negative.next(), ProtocolError);
}

TEST(FrameSplitter, KeepsNoMoreThanOneMessage) {
  FrameSplitter splitter = FrameSplitter::of_rtde();
  const std::string package = rtde_package(RtdeKind::kData, std::string(60000, 'x'));
  for (int i = 0; i < 1000; ++i) {
    splitter.append(package);
    EXPECT_TRUE(splitter.next().has_value());
    EXPECT_EQ(splitter.buffered_bytes(), 0U);
  }
}

TEST(LineSplitter, CutsLinesAndRefusesEndlessOnes) {
  LineSplitter lines(10);
  lines.append("Robot");
  EXPECT_FALSE(lines.next().has_value());
  lines.append("\r\nx\n");
  EXPECT_EQ(lines.next(), "Robot");
  EXPECT_EQ(lines.next(), "x");
  lines.append("0123456789");
  EXPECT_FALSE(lines.next().has_value());
  lines.append("a");
  EXPECT_THROW(lines.next(), ProtocolError);
}

}  // namespace
}  // namespace glint
