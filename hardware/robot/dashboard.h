// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hardware/robot/motion_permit.h"
#include "hardware/robot/protocol/message_splitter.h"
#include "hardware/robot/tcp_link.h"

namespace glint {

/// The dashboard server of a controller.
class Dashboard {
 public:
  /// Connects and reads the greeting, "Connected: Universal Robots Dashboard Server".
  /// @throws IoError; ProtocolError for another greeting: nothing has been written then
  Dashboard(const std::string& host, int port, double timeout_s);

  /// A command that only asks (is_query()). @throws IoError, ProtocolError
  std::string ask(const std::string& query);

  /// A command that changes the controller's state. @throws IoError, ProtocolError
  std::string command(const std::string& command, const MotionPermit& permit);

 private:
  std::string line();
  std::string reply_to(const std::string& text);

  TcpLink link_;
  LineSplitter lines_;
  double timeout_s_;
};

}  // namespace glint
