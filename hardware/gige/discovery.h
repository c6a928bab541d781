// SPDX-License-Identifier: GPL-3.0-or-later
//
// Asks single addresses for a camera. Broadcasts find the cameras of a network; one that listens at
// an address of this machine alone never hears them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hardware/gige/udp_socket.h"

namespace glint {

/// The addresses of this machine at which simulated cameras are looked for, and take a free one.
inline constexpr std::uint32_t kFirstLoopback = 0x7f000001;  // 127.0.0.1
inline constexpr std::uint32_t kLoopbackAddresses = 32;

/// What a camera says about itself before anybody opens it.
struct FoundDevice {
  std::string vendor;
  std::string model;
  std::string serial;
  std::string manufacturer_info;  ///< that no user can change
  std::string user_name;          ///< the DeviceUserID that a user gave it
  std::string address;
};

/// The payload of an answer to a discovery; empty when it is too short.
std::optional<FoundDevice> parse_discovery(BytesView payload);

/// Those of the addresses that answer within the time, in their order.
std::vector<FoundDevice> discover_at(std::span<const std::uint32_t> addresses, int timeout_ms);

}  // namespace glint
