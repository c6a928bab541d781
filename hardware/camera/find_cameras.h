// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace glint {

/// A camera that somebody could open.
struct FoundCamera {
  std::string id;  ///< "vendor-serial", as Aravis names it
  std::string vendor;
  std::string model;
  std::string serial;
  std::string address;
  /// That no user can change; empty where it is not asked for, as the next.
  std::string manufacturer_info;
  std::string user_name;  ///< the DeviceUserID that a user gave it
  std::string protocol;   ///< "GigEVision", "USB3Vision"
};

/// All cameras on networks and USB that answer within about a second, by their ids. Cameras at
/// addresses of this machine alone do not hear broadcasts: kLoopbackAddresses (discovery.h) from
/// 127.0.0.1 on and `also` are asked one by one.
/// @param also  IPv4 addresses; what is none is left out
std::vector<FoundCamera> find_cameras(std::span<const std::string> also = {});

/// Only those of this machine's addresses and `also`, within the time.
std::vector<FoundCamera> find_cameras_at(std::span<const std::string> also, int timeout_ms);

}  // namespace glint
