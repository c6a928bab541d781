// SPDX-License-Identifier: GPL-3.0-or-later
//
// The controller's side of one RTDE connection, without a network.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hardware/robot/protocol/rtde_package.h"
#include "hardware/twin/robot/twin_controller.h"

namespace glint {

/// Which connection holds an input: a second one that asks for it is told IN_USE.
using HeldInputs = std::map<std::string, const void*, std::less<>>;

class RtdeSession {
 public:
  /// Both outlive the session.
  RtdeSession(TwinController& twin, HeldInputs& held) : twin_(twin), held_(held) {}

  ~RtdeSession();  ///< gives its inputs back
  RtdeSession(const RtdeSession&) = delete;
  RtdeSession& operator=(const RtdeSession&) = delete;

  /// @return the replies
  /// @throws ProtocolError for what is no RTDE: the connection is to be closed
  std::string on_bytes(std::string_view bytes);

  /// Once a cycle of the controller, before it is stepped again.
  /// @return a package of data; empty: none is due
  std::string on_cycle();

  bool has_started() const { return has_started_; }

 private:
  struct Inputs {
    std::vector<std::string> names;
    RtdeRecipe recipe;
  };

  std::string reply_to(const FrameSplitter::Frame& frame);
  std::uint8_t next_id();
  std::string set_up_outputs(std::string_view payload);
  std::string set_up_inputs(std::string_view payload);
  std::string take_data(std::string_view payload);

  TwinController& twin_;
  HeldInputs& held_;
  FrameSplitter splitter_ = FrameSplitter::of_rtde();
  RtdeRecipe outputs_;
  std::vector<Inputs> inputs_;
  bool has_outputs_ = false;
  bool has_started_ = false;
  double every_cycles_ = 1.0;
  double waited_cycles_ = 0.0;
  std::uint8_t newest_id_ = 0;  ///< of a recipe
  std::string newest_;          ///< package of data, for stamps that stand still
};

}  // namespace glint
