// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/gige/discovery.h"

#include <algorithm>
#include <chrono>
#include <map>

namespace glint {
namespace {

/// Sockets of loopback speak to loopback alone.
std::uint32_t own_address(std::uint32_t peer) {
  return is_loopback(peer) ? 0x7f000001U : 0U;
}

/// A socket for each address, from which it was asked what it is.
std::vector<UdpSocket> ask(std::span<const std::uint32_t> addresses) {
  std::vector<UdpSocket> sockets;
  std::uint16_t id = 0;
  for (const std::uint32_t address : addresses) {
    ++id;
    sockets.emplace_back(Endpoint{.address = own_address(address), .port = 0});
    const Bytes request = gvcp_request(GvcpCommand::kDiscovery, id, {}, kWantsAcknowledgement);
    sockets.back().send({.address = address, .port = kGvcpPort}, request);
  }
  return sockets;
}

}  // namespace

std::optional<FoundDevice> parse_discovery(BytesView payload) {
  if (payload.size() < gige_register::kDiscoveryEnd) {
    return std::nullopt;
  }
  return FoundDevice{.vendor = field_text(payload, gige_register::kManufacturer, 32),
                     .model = field_text(payload, gige_register::kModel, 32),
                     .serial = field_text(payload, gige_register::kSerial, 16),
                     .manufacturer_info = field_text(payload, gige_register::kManufacturerInfo, 48),
                     .user_name = field_text(payload, gige_register::kUserName, 16),
                     .address = ipv4_text(read_u32(payload, gige_register::kCurrentIp))};
}

std::vector<FoundDevice> discover_at(std::span<const std::uint32_t> addresses, int timeout_ms) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::milliseconds(timeout_ms);
  std::map<std::uint32_t, FoundDevice> found;
  std::vector<UdpSocket> sockets = ask(addresses);
  Bytes packet;
  Endpoint from;
  while (found.size() < addresses.size() && Clock::now() < deadline) {
    for (UdpSocket& socket : sockets) {
      if (!socket.wait(std::chrono::milliseconds(1)) || !socket.receive(packet, from)) {
        continue;
      }
      const auto answer = parse_gvcp_acknowledgement(packet);
      const auto device = answer ? parse_discovery(answer->payload) : std::nullopt;
      if (device && std::ranges::find(addresses, from.address) != addresses.end()) {
        found.emplace(from.address, *device);
      }
    }
  }
  std::vector<FoundDevice> devices;
  for (const std::uint32_t address : addresses) {
    if (const auto device = found.find(address); device != found.end()) {
      devices.push_back(device->second);
    }
  }
  return devices;
}

}  // namespace glint
