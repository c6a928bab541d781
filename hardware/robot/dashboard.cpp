// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/dashboard.h"

#include <chrono>

#include <fmt/format.h>

#include "core/wall_clock.h"
#include "hardware/robot/protocol/dashboard_text.h"

namespace glint {

Dashboard::Dashboard(const std::string& host, int port, double timeout_s)
    : link_(host, port, timeout_s), timeout_s_(timeout_s) {
  // Another port might run what is meant as a question: nothing is written to it.
  if (line().find("Dashboard Server") == std::string::npos) {
    throw ProtocolError(
        fmt::format("{}: does not greet as the dashboard of a controller does", link_.peer()));
  }
}

std::string Dashboard::ask(const std::string& query) {
  GLINT_CHECK(is_query(query), "a dashboard command that only asks");
  return reply_to(query);
}

std::string Dashboard::command(const std::string& command, const MotionPermit&) {
  return reply_to(command);
}

std::string Dashboard::reply_to(const std::string& text) {
  link_.write(text + "\n", timeout_s_);
  return line();
}

std::string Dashboard::line() {
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    if (auto line = lines_.next()) {
      return *line;
    }
    const double left_s = timeout_s_ - seconds_since(start);
    if (left_s <= 0.0) {
      throw IoError(fmt::format("{}: no reply within {:.1f} s", link_.peer(), timeout_s_));
    }
    lines_.append(link_.read(left_s));
  }
}

}  // namespace glint
