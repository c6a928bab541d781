// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/find_cameras.h"

#include <algorithm>

#include "hardware/camera/aravis.h"
#include "hardware/gige/discovery.h"

namespace glint {
namespace {

FoundCamera found_camera(const FoundDevice& device) {
  return {.id = device.vendor + "-" + device.serial,
          .vendor = device.vendor,
          .model = device.model,
          .serial = device.serial,
          .address = device.address,
          .manufacturer_info = device.manufacturer_info,
          .user_name = device.user_name,
          .protocol = "GigEVision"};
}

/// Those that Aravis finds by broadcasts and on USB.
std::vector<FoundCamera> found_by_aravis() {
  arv_update_device_list();
  std::vector<FoundCamera> cameras;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    cameras.push_back({.id = aravis::text_of(arv_get_device_id(i)),
                       .vendor = aravis::text_of(arv_get_device_vendor(i)),
                       .model = aravis::text_of(arv_get_device_model(i)),
                       .serial = aravis::text_of(arv_get_device_serial_nbr(i)),
                       .address = aravis::text_of(arv_get_device_address(i)),
                       .protocol = aravis::text_of(arv_get_device_protocol(i))});
  }
  return cameras;
}

}  // namespace

std::vector<FoundCamera> find_cameras_at(std::span<const std::string> also, int timeout_ms) {
  std::vector<std::uint32_t> addresses;
  for (std::uint32_t i = 0; i < kLoopbackAddresses; ++i) {
    addresses.push_back(kFirstLoopback + i);
  }
  for (const std::string& text : also) {
    const auto address = parse_ipv4(text);
    if (address && std::ranges::find(addresses, *address) == addresses.end()) {
      addresses.push_back(*address);
    }
  }
  std::vector<FoundCamera> cameras;
  for (const FoundDevice& device : discover_at(addresses, timeout_ms)) {
    cameras.push_back(found_camera(device));
  }
  return cameras;
}

std::vector<FoundCamera> find_cameras(std::span<const std::string> also) {
  constexpr int kTimeoutMs = 200;
  std::vector<FoundCamera> cameras = found_by_aravis();
  for (FoundCamera& camera : find_cameras_at(also, kTimeoutMs)) {
    const bool is_known = std::ranges::any_of(cameras, [&](const FoundCamera& known) {
      return known.address == camera.address && known.serial == camera.serial;
    });
    if (!is_known) {
      cameras.push_back(std::move(camera));
    }
  }
  std::ranges::sort(cameras, {}, &FoundCamera::id);
  return cameras;
}

}  // namespace glint
