// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: camera_twin_host ADDRESS FIRST_FRAME_ID
//
// A simulated camera that shows test patterns, as a process of its own that tests can stop and
// kill. Writes "ready" when it listens, and ends when its input does.
#include <cstdio>
#include <cstdlib>

#include "core/error.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/camera/test_pattern.h"

int main(int count, char** words) {
  const auto address = count == 3 ? glint::parse_ipv4(words[1]) : std::nullopt;
  if (!address) {
    return 2;
  }
  try {
    glint::CameraTwinSettings settings;
    settings.address = *address;
    settings.first_frame_id = static_cast<std::uint16_t>(std::atoi(words[2]));
    glint::TestPatternSource source(settings.sensor_width_px, settings.sensor_height_px);
    const glint::CameraTwin twin(settings, source);
    std::puts("ready");
    std::fflush(stdout);
    while (std::getchar() != EOF) {
    }
  } catch (const glint::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
  return 0;
}
