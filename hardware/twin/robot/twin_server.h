// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "hardware/twin/robot/twin_controller.h"

namespace glint {

/// TCP ports of a controller.
struct TwinPorts {
  int rtde = 30004;
  int primary = 30001;
  int secondary = 30002;
  int dashboard = 29999;
};

struct TwinServerSettings {
  TwinSettings twin;
  std::string address = "127.0.0.1";  ///< within 127.0.0.0/8
  TwinPorts ports;                    ///< 0: a free one
  /// Cycles follow one another as fast as clients take their packages, instead of in real time.
  bool is_as_fast_as_possible = false;
  double speedup = 1.0;  ///< > 0: how much faster than real time its clock goes; packages do not
};

/// A twin on the loopback network: RTDE, primary and secondary interface, dashboard, and a side
/// channel for faults: a Unix socket of mode 0600 (twin_proof.h) that takes lines
///
///     token              the number that the output glint_twin_token tells, too
///     fault KIND [now|moving|still [SECONDS]]          fault.h
///     state              time, joints in rad, still or moving, names of the modes
///     stop               the program that serves the twin shall end
///
/// Serves in a thread of its own until it is destroyed. At most 16 clients a port; one that does
/// not take what it is sent is dropped when 1 MB waits for it.
class TwinServer {
 public:
  /// @throws ConfigError for an address outside 127.0.0.0/8, IoError for a port that is taken
  explicit TwinServer(TwinServerSettings settings);
  ~TwinServer();
  TwinServer(const TwinServer&) = delete;
  TwinServer& operator=(const TwinServer&) = delete;

  /// As they are bound.
  const TwinPorts& ports() const;

  std::uint64_t token() const;

  const std::filesystem::path& side_channel() const;

  void add_fault(const Fault& fault);

  /// The arm waits while this is set; packages go on. For pictures that take longer than the
  /// motion.
  void hold_motion(bool is_held);

  TwinView view() const;

  /// Someone said "stop" on the side channel.
  bool is_stop_asked() const;

  /// Bytes that have come on the primary and the secondary interface and on the dashboard.
  std::uint64_t num_command_bytes() const;

  /// Names of all RTDE inputs that clients have written.
  std::set<std::string> inputs_written() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
