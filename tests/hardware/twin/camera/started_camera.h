// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"

namespace glint {

/// The camera at an address, ready for triggers: 8 bits, 1 ms.
inline std::unique_ptr<AravisCamera> started_camera(std::uint32_t address) {
  auto camera = std::make_unique<AravisCamera>(ipv4_text(address));
  camera->configure({.exposure_us = 1000.0, .packet_size = 9000});
  camera->start();
  return camera;
}

}  // namespace glint
