// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/gige/packets.h"

#include <algorithm>

#include "core/error.h"

namespace glint {
namespace {

constexpr std::uint8_t kRequestKey = 0x42;
constexpr std::uint8_t kExtendedIds = 0x10;
constexpr std::size_t kHeaderBytes = 8;
constexpr std::uint16_t kImagePayload = 1;

std::uint8_t low_byte(std::uint32_t value) {
  return static_cast<std::uint8_t>(value & 0xffU);
}

Bytes stream_packet(std::uint16_t frame_id, StreamContent content, std::uint32_t packet_id) {
  Bytes packet;
  append_u16(packet, 0);
  append_u16(packet, frame_id);
  append_u32(packet, (static_cast<std::uint32_t>(content) << 24U) | (packet_id & 0xffffffU));
  return packet;
}

}  // namespace

std::uint16_t read_u16(BytesView bytes, std::size_t at) {
  GLINT_CHECK(at + 2 <= bytes.size(), "a packet is read within its bounds");
  return static_cast<std::uint16_t>((bytes[at] << 8U) | bytes[at + 1]);
}

std::uint32_t read_u32(BytesView bytes, std::size_t at) {
  return (static_cast<std::uint32_t>(read_u16(bytes, at)) << 16U) | read_u16(bytes, at + 2);
}

void append_u16(Bytes& bytes, std::uint32_t value) {
  bytes.push_back(low_byte(value >> 8U));
  bytes.push_back(low_byte(value));
}

void append_u32(Bytes& bytes, std::uint32_t value) {
  append_u16(bytes, value >> 16U);
  append_u16(bytes, value & 0xffffU);
}

void store_u32(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t value) {
  GLINT_CHECK(at + 4 <= bytes.size(), "a packet is written within its bounds");
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = low_byte(value >> (24U - 8U * static_cast<unsigned>(i)));
  }
}

std::optional<GvcpRequest> parse_gvcp_request(BytesView packet) {
  if (packet.size() < kHeaderBytes || packet[0] != kRequestKey) {
    return std::nullopt;
  }
  const std::size_t size = read_u16(packet, 4);
  if (packet.size() < kHeaderBytes + size) {
    return std::nullopt;
  }
  return GvcpRequest{.command = read_u16(packet, 2),
                     .id = read_u16(packet, 6),
                     .wants_acknowledgement = (packet[1] & kWantsAcknowledgement) != 0,
                     .has_extended_ids = (packet[1] & kExtendedIds) != 0,
                     .payload = packet.subspan(kHeaderBytes, size)};
}

Bytes gvcp_request(GvcpCommand command, std::uint16_t id, BytesView payload, std::uint8_t flags) {
  Bytes packet = {kRequestKey, flags};
  append_u16(packet, static_cast<std::uint16_t>(command));
  append_u16(packet, static_cast<std::uint32_t>(payload.size()));
  append_u16(packet, id);
  packet.insert(packet.end(), payload.begin(), payload.end());
  return packet;
}

std::optional<GvcpAcknowledgement> parse_gvcp_acknowledgement(BytesView packet) {
  if (packet.size() < kHeaderBytes) {
    return std::nullopt;
  }
  const std::size_t size = read_u16(packet, 4);
  if (packet.size() < kHeaderBytes + size) {
    return std::nullopt;
  }
  return GvcpAcknowledgement{.status = read_u16(packet, 0),
                             .command = read_u16(packet, 2),
                             .id = read_u16(packet, 6),
                             .payload = packet.subspan(kHeaderBytes, size)};
}

Bytes gvcp_acknowledgement(GvcpCommand command,
                           std::uint16_t id,
                           GvcpStatus status,
                           BytesView payload) {
  Bytes packet;
  append_u16(packet, static_cast<std::uint16_t>(status));
  append_u16(packet, static_cast<std::uint32_t>(command) + 1);
  append_u16(packet, static_cast<std::uint32_t>(payload.size()));
  append_u16(packet, id);
  packet.insert(packet.end(), payload.begin(), payload.end());
  return packet;
}

// Channel and picture id of 16 bits each, first and last packet; with extended ids the second
// number is reserved and the picture's id of 64 bits follows the packets.
std::optional<ResendRequest> parse_resend(const GvcpRequest& request) {
  const BytesView bytes = request.payload;
  if (bytes.size() < (request.has_extended_ids ? 20U : 12U)) {
    return std::nullopt;
  }
  ResendRequest resend = {
      .frame_id = read_u16(bytes, 2), .first = read_u32(bytes, 4), .last = read_u32(bytes, 8)};
  if (request.has_extended_ids) {
    resend.frame_id =
        (static_cast<std::uint64_t>(read_u32(bytes, 12)) << 32U) | read_u32(bytes, 16);
  } else {
    resend.first &= 0xffffffU;
    resend.last &= 0xffffffU;
  }
  return resend;
}

std::optional<StreamHeader> parse_stream_header(BytesView packet) {
  if (packet.size() < kHeaderBytes || (packet[4] & 0x80U) != 0) {
    return std::nullopt;
  }
  return StreamHeader{.status = read_u16(packet, 0),
                      .frame_id = read_u16(packet, 2),
                      .content = static_cast<StreamContent>(packet[4]),
                      .packet_id = read_u32(packet, 4) & 0xffffffU};
}

Bytes stream_leader(std::uint16_t frame_id, const StreamLeader& leader) {
  Bytes packet = stream_packet(frame_id, StreamContent::kLeader, 0);
  append_u16(packet, 0);
  append_u16(packet, kImagePayload);
  append_u32(packet, static_cast<std::uint32_t>(leader.timestamp_ticks >> 32U));
  append_u32(packet, static_cast<std::uint32_t>(leader.timestamp_ticks & 0xffffffffU));
  for (const std::uint32_t value : {leader.pixel_format,
                                    leader.width_px,
                                    leader.height_px,
                                    leader.offset_x_px,
                                    leader.offset_y_px,
                                    0U}) {  // the last one: padding of rows and at the end
    append_u32(packet, value);
  }
  return packet;
}

Bytes stream_data(std::uint16_t frame_id, std::uint32_t packet_id, BytesView data) {
  Bytes packet = stream_packet(frame_id, StreamContent::kData, packet_id);
  packet.insert(packet.end(), data.begin(), data.end());
  return packet;
}

Bytes stream_trailer(std::uint16_t frame_id, std::uint32_t packet_id, std::uint32_t height_px) {
  Bytes packet = stream_packet(frame_id, StreamContent::kTrailer, packet_id);
  append_u32(packet, kImagePayload);
  append_u32(packet, height_px);
  return packet;
}

std::string field_text(BytesView bytes, std::size_t at, std::size_t size) {
  const BytesView field = bytes.subspan(at, size);
  return std::string(field.begin(), std::ranges::find(field, std::uint8_t{0}));
}

}  // namespace glint
