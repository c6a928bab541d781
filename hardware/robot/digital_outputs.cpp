// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/digital_outputs.h"

#include <chrono>

#include <fmt/format.h>

#include "core/wall_clock.h"
#include "hardware/robot/rtde_client.h"
#include "hardware/robot/tcp_link.h"

namespace glint {

void set_digital_outputs(const std::string& host,
                         int rtde_port,
                         std::uint8_t mask,
                         std::uint8_t values,
                         const MotionPermit&,
                         double timeout_s) {
  constexpr const char* kBits = "actual_digital_output_bits";
  constexpr double kReplyS = 0.05;
  TcpLink link(host, rtde_port, timeout_s);
  RtdeClient client({.outputs = {kBits},
                     .newer = {},
                     .inputs = {"standard_digital_output_mask", "standard_digital_output"},
                     .rate_hz = 0.0});
  const auto start = std::chrono::steady_clock::now();
  bool is_sent = false;
  bool is_set = false;
  while (!is_set) {
    if (seconds_since(start) > timeout_s) {
      throw IoError(fmt::format("{}: the digital outputs do not follow", link.peer()));
    }
    if (client.is_streaming() && !is_sent) {
      client.send_inputs({mask, static_cast<std::uint8_t>(values & mask)});
      is_sent = true;
    }
    if (const std::string output = client.take_output(); !output.empty()) {
      link.write(output, timeout_s);
    }
    client.feed(link.read(kReplyS), [&] {
      is_set = is_sent && (client.get<std::uint64_t>(kBits) & mask) == (values & mask);
    });
  }
}

}  // namespace glint
