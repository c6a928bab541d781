// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/gige/packets.h"

#include <gmock/gmock.h>

#include "hardware/gige/discovery.h"
#include "hardware/gige/udp_socket.h"

namespace glint {
namespace {

using testing::ElementsAre;

// Key 0x42, flags 1 (wants an answer), command 0x0080, 4 bytes follow, id 0x0007, address 0x0a00.
TEST(GvcpRequest, IsWrittenByteByByte) {
  const Bytes payload = {0x00, 0x00, 0x0a, 0x00};
  const Bytes packet = gvcp_request(GvcpCommand::kReadRegister, 7, payload, 1);
  EXPECT_THAT(packet,
              ElementsAre(0x42, 0x01, 0x00, 0x80, 0x00, 0x04, 0x00, 0x07, 0x00, 0x00, 0x0a, 0x00));
  const auto request = parse_gvcp_request(packet);
  ASSERT_TRUE(request.has_value());
  EXPECT_EQ(request->command, 0x0080);
  EXPECT_EQ(request->id, 7);
  EXPECT_TRUE(request->wants_acknowledgement);
  EXPECT_FALSE(request->has_extended_ids);
  EXPECT_EQ(read_u32(request->payload, 0), 0x0a00U);
}

TEST(GvcpRequest, IsNoneWhenItIsCutOffOrHasAnotherKey) {
  Bytes packet = gvcp_request(GvcpCommand::kReadRegister, 7, Bytes{0, 0, 0, 0}, 1);
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_FALSE(parse_gvcp_request(BytesView(packet).first(size)).has_value()) << size;
  }
  packet[0] = 0x41;
  EXPECT_FALSE(parse_gvcp_request(packet).has_value());
}

// Status 0x8007 (busy), command 0x0083, no payload, id 0x0102.
TEST(GvcpAcknowledgement, IsWrittenByteByByte) {
  const Bytes packet =
      gvcp_acknowledgement(GvcpCommand::kWriteRegister, 0x0102, GvcpStatus::kBusy, {});
  EXPECT_THAT(packet, ElementsAre(0x80, 0x07, 0x00, 0x83, 0x00, 0x00, 0x01, 0x02));
  const auto answer = parse_gvcp_acknowledgement(packet);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->status, 0x8007);
  EXPECT_EQ(answer->id, 0x0102);
}

TEST(ResendRequest, IsReadWithShortAndWithLongIds) {
  // Channel 0, picture 0xffdc, packets 3 to 5.
  const Bytes payload = {0, 0, 0xff, 0xdc, 0, 0, 0, 3, 0, 0, 0, 5};
  const auto brief = parse_resend({.command = 0x40, .has_extended_ids = false, .payload = payload});
  ASSERT_TRUE(brief.has_value());
  EXPECT_EQ(brief->frame_id, 0xffdcU);
  EXPECT_EQ(brief->first, 3U);
  EXPECT_EQ(brief->last, 5U);
  EXPECT_FALSE(parse_resend({.has_extended_ids = true, .payload = payload}).has_value());
  Bytes extended = payload;
  append_u32(extended, 1);
  append_u32(extended, 2);
  const auto wide = parse_resend({.command = 0x40, .has_extended_ids = true, .payload = extended});
  ASSERT_TRUE(wide.has_value());
  EXPECT_EQ(wide->frame_id, (1ULL << 32U) + 2);
}

// Status 0, picture 1, content 1 and packet 0; image payload; time 2^32 + 5; Mono8; 4 x 3 from (1,
// 2).
TEST(StreamPacket, LeaderIsWrittenByteByByte) {
  const Bytes packet = stream_leader(1,
                                     {.timestamp_ticks = (1ULL << 32U) + 5,
                                      .pixel_format = 0x01080001,
                                      .width_px = 4,
                                      .height_px = 3,
                                      .offset_x_px = 1,
                                      .offset_y_px = 2});
  EXPECT_THAT(packet,
              ElementsAre(0,
                          0,
                          0,
                          1,
                          1,
                          0,
                          0,
                          0,
                          0,
                          0,
                          0,
                          1,
                          0,
                          0,
                          0,
                          1,
                          0,
                          0,
                          0,
                          5,
                          1,
                          8,
                          0,
                          1,
                          0,
                          0,
                          0,
                          4,
                          0,
                          0,
                          0,
                          3,
                          0,
                          0,
                          0,
                          1,
                          0,
                          0,
                          0,
                          2,
                          0,
                          0,
                          0,
                          0));
}

TEST(StreamPacket, HeadersOfDataAndTrailerReadBack) {
  const auto data = parse_stream_header(stream_data(65535, 0x012345, Bytes{9}));
  ASSERT_TRUE(data.has_value());
  EXPECT_EQ(data->frame_id, 65535);
  EXPECT_EQ(data->packet_id, 0x012345U);
  EXPECT_EQ(data->content, StreamContent::kData);
  EXPECT_THAT(stream_trailer(2, 3, 2050),
              ElementsAre(0, 0, 0, 2, 2, 0, 0, 3, 0, 0, 0, 1, 0, 0, 8, 2));
  EXPECT_FALSE(parse_stream_header(Bytes(7)).has_value());
  EXPECT_FALSE(parse_stream_header(Bytes{0, 0, 0, 1, 0x83, 0, 0, 1}).has_value());  // long ids
}

TEST(Ipv4, IsReadAndWrittenInFourNumbers) {
  EXPECT_EQ(parse_ipv4("127.0.0.2"), 0x7f000002U);
  EXPECT_EQ(ipv4_text(0xc0a80164), "192.168.1.100");
  EXPECT_FALSE(parse_ipv4("camera-1").has_value());
  EXPECT_FALSE(parse_ipv4("127.0.0.256").has_value());
  EXPECT_TRUE(is_loopback(0x7fffffff));
  EXPECT_FALSE(is_loopback(0x80000000));
}

TEST(Discovery, IsNoneWhenItIsTooShort) {
  EXPECT_FALSE(parse_discovery(Bytes(0xf7)).has_value());
  Bytes payload(0xf8);
  payload[0x24] = 127;
  payload[0x27] = 1;
  payload[0x48] = 'G';
  payload[0xa8] = 'M';
  payload[0xe8] = 'U';
  const auto device = parse_discovery(payload);
  ASSERT_TRUE(device.has_value());
  EXPECT_EQ(device->vendor, "G");
  EXPECT_EQ(device->manufacturer_info, "M");
  EXPECT_EQ(device->user_name, "U");
  EXPECT_EQ(device->address, "127.0.0.1");
}

}  // namespace
}  // namespace glint
