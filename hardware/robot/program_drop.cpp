// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/program_drop.h"

#include "hardware/robot/dashboard.h"
#include "hardware/robot/protocol/dashboard_text.h"

namespace glint {

std::string drop_program(const UrSettings& settings, const MotionPermit& permit) {
  constexpr double kDropS = 1.0;  ///< for each line
  try {
    Dashboard dashboard(settings.host, settings.dashboard_port, kDropS);
    const std::string reply = dashboard.command("stop", permit);
    // It fails where there is nothing to stop.
    const bool is_gone = is_success(reply) || dashboard.ask("programState").starts_with("STOPPED");
    return is_gone ? std::string() : reply.substr(0, 80);
  } catch (const IoError& error) {
    return error.what();
  }
}

}  // namespace glint
