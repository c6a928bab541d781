// SPDX-License-Identifier: GPL-3.0-or-later
//
// The packets of GigE Vision as they stand on the wire, all numbers big endian: those of control
// (GVCP, requests and acknowledgements of 8 bytes and a payload) and those of the stream (GVSP, a
// leader, data and a trailer for each picture, with picture ids of 16 bits). Only what a camera
// with one stream and no chunks, events or actions needs.
//
// Source: the packet layouts that the public clients and servers of the protocol agree on
// (Aravis 0.8 above all); the tests hold the bytes of each packet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace glint {

using Bytes = std::vector<std::uint8_t>;
using BytesView = std::span<const std::uint8_t>;

/// Where cameras listen for control packets.
inline constexpr std::uint16_t kGvcpPort = 3956;

/// What a packet of control asks for; an acknowledgement has the next higher number.
enum class GvcpCommand : std::uint16_t {
  kDiscovery = 0x0002,
  kPacketResend = 0x0040,
  kReadRegister = 0x0080,
  kWriteRegister = 0x0082,
  kReadMemory = 0x0084,
  kWriteMemory = 0x0086,
  kPending = 0x0088  ///< only ever acknowledged: the answer takes longer
};

enum class GvcpStatus : std::uint16_t {
  kSuccess = 0x0000,
  kNotImplemented = 0x8001,
  kInvalidParameter = 0x8002,
  kInvalidAddress = 0x8003,
  kWriteProtect = 0x8004,
  kBadAlignment = 0x8005,
  kAccessDenied = 0x8006,
  kBusy = 0x8007
};

/// Addresses of the registers that all cameras have.
namespace gige_register {
inline constexpr std::uint32_t kVersion = 0x0000;
inline constexpr std::uint32_t kDeviceMode = 0x0004;
inline constexpr std::uint32_t kMacHigh = 0x0008;
inline constexpr std::uint32_t kMacLow = 0x000c;
inline constexpr std::uint32_t kIpConfiguration = 0x0010;
inline constexpr std::uint32_t kCurrentIpConfiguration = 0x0014;
inline constexpr std::uint32_t kCurrentIp = 0x0024;
inline constexpr std::uint32_t kSubnetMask = 0x0034;
inline constexpr std::uint32_t kManufacturer = 0x0048;
inline constexpr std::uint32_t kModel = 0x0068;
inline constexpr std::uint32_t kDeviceVersion = 0x0088;
inline constexpr std::uint32_t kManufacturerInfo = 0x00a8;
inline constexpr std::uint32_t kSerial = 0x00d8;
inline constexpr std::uint32_t kUserName = 0x00e8;
inline constexpr std::uint32_t kDiscoveryEnd = 0x00f8;
inline constexpr std::uint32_t kXmlUrl = 0x0200;
inline constexpr std::uint32_t kNetworkInterfaces = 0x0600;
inline constexpr std::uint32_t kStreamChannels = 0x0904;
inline constexpr std::uint32_t kCapability = 0x0934;
inline constexpr std::uint32_t kHeartbeatTimeoutMs = 0x0938;
inline constexpr std::uint32_t kTickFrequencyLow = 0x0940;
inline constexpr std::uint32_t kPrivilege = 0x0a00;
inline constexpr std::uint32_t kStreamPort = 0x0d00;
inline constexpr std::uint32_t kPacketSize = 0x0d04;
inline constexpr std::uint32_t kPacketDelay = 0x0d08;
inline constexpr std::uint32_t kStreamAddress = 0x0d18;
inline constexpr std::uint32_t kStreamSourcePort = 0x0d1c;
}  // namespace gige_register

std::uint16_t read_u16(BytesView bytes, std::size_t at);
std::uint32_t read_u32(BytesView bytes, std::size_t at);
void append_u16(Bytes& bytes, std::uint32_t value);
void append_u32(Bytes& bytes, std::uint32_t value);
void store_u32(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t value);

struct GvcpRequest {
  std::uint16_t command = 0;  ///< one of GvcpCommand, or what nobody knows
  std::uint16_t id = 0;
  bool wants_acknowledgement = false;
  bool has_extended_ids = false;
  BytesView payload;  ///< of the packet that was parsed
};

/// Empty for what is no whole request.
std::optional<GvcpRequest> parse_gvcp_request(BytesView packet);

/// Flag of requests.
inline constexpr std::uint8_t kWantsAcknowledgement = 0x01;

Bytes gvcp_request(GvcpCommand command, std::uint16_t id, BytesView payload, std::uint8_t flags);

struct GvcpAcknowledgement {
  std::uint16_t status = 0;
  std::uint16_t command = 0;  ///< of the request, plus 1
  std::uint16_t id = 0;
  BytesView payload;
};

std::optional<GvcpAcknowledgement> parse_gvcp_acknowledgement(BytesView packet);
Bytes gvcp_acknowledgement(GvcpCommand command,
                           std::uint16_t id,
                           GvcpStatus status,
                           BytesView payload);

/// Asks for packets of the stream once more.
struct ResendRequest {
  std::uint64_t frame_id = 0;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// Empty when the payload is too short.
std::optional<ResendRequest> parse_resend(const GvcpRequest& request);

/// A picture as its leader describes it.
struct StreamLeader {
  std::uint64_t timestamp_ticks = 0;
  std::uint32_t pixel_format = 0;  ///< GenICam's number
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint32_t offset_x_px = 0;
  std::uint32_t offset_y_px = 0;
};

enum class StreamContent : std::uint8_t { kLeader = 1, kTrailer = 2, kData = 3 };

struct StreamHeader {
  std::uint16_t status = 0;
  std::uint16_t frame_id = 0;
  StreamContent content = StreamContent::kData;
  std::uint32_t packet_id = 0;  ///< 0 is the leader
};

/// IP, UDP and GVSP headers, which the packet size of a stream counts.
inline constexpr std::size_t kStreamOverheadBytes = 20 + 8 + 8;

/// Empty for packets with ids of 64 bits and what is none.
std::optional<StreamHeader> parse_stream_header(BytesView packet);
Bytes stream_leader(std::uint16_t frame_id, const StreamLeader& leader);
Bytes stream_data(std::uint16_t frame_id, std::uint32_t packet_id, BytesView data);
Bytes stream_trailer(std::uint16_t frame_id, std::uint32_t packet_id, std::uint32_t height_px);

/// The text of a fixed field, up to its first zero.
std::string field_text(BytesView bytes, std::size_t at, std::size_t size);

}  // namespace glint
