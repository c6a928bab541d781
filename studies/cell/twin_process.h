// SPDX-License-Identifier: GPL-3.0-or-later
//
// Twins as a program: in the foreground until they are told to end, or apart from the terminal,
// with a file that appears when they are ready.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hardware/twin/robot/twin_server.h"
#include "studies/cell/cell_file.h"

namespace glint {

/// A twin that serves until it is destroyed.
class ServingTwin {
 public:
  virtual ~ServingTwin() = default;

  /// Its own object in the ready file: {"kind": "robot", ...ports, ...}
  virtual nlohmann::ordered_json description() const = 0;

  /// Its side channel was told to stop, or it has failed.
  virtual bool has_ended() const = 0;
};

using ServingTwins = std::vector<std::unique_ptr<ServingTwin>>;

struct TwinProcessOptions {
  bool is_detached = false;
  std::filesystem::path ready_file;  ///< empty: none; needed when detached
};

/// Makes the twins and serves until one has ended, or SIGINT or SIGTERM came. Detached: in a child
/// of its own session; returns when the ready file is there.
/// @return the ready file's object: {"schema", "pid", "twins": [...]}
/// @throws what make() throws, also when it threw in the child; ConfigError for options that do not
///         go together and for a ready file that is another file, or, detached, that is there;
///         IoError when the child ended before it was ready
nlohmann::ordered_json serve_twins(const std::function<ServingTwins()>& make,
                                   const TwinProcessOptions& options,
                                   const std::function<void(const nlohmann::ordered_json&)>& tell);

/// Ends the twins of a ready file by their side channels, waits for their process and removes the
/// file. Only a process whose side channel tells the file's token is told to end.
/// @throws IoError when they do not end within 10 s, ConfigError for a file that is no ready file
nlohmann::ordered_json stop_twins(const std::filesystem::path& ready_file);

/// Tells the camera's twin that the part has been lifted and put down again, as a person would have
/// done it. @param placement  counted from 1
/// @throws IoError when no twin of a camera listens; ConfigError for a file that is no ready file
nlohmann::ordered_json place_in_twins(const std::filesystem::path& ready_file, int placement);

/// Tells the camera's twin that a person has switched a light of the cell.
/// @throws IoError when no twin of a camera listens or no person switches that light; ConfigError
///         for a file that is no ready file
nlohmann::ordered_json switch_light_in_twins(const std::filesystem::path& ready_file,
                                             const std::string& light,
                                             bool is_on);

/// @param port  as robot_twin_of()
/// @throws ConfigError where the robot's twin would have ports that with_ports() refuses
void check_robot_twin_port(const Cell& cell, std::optional<int> port);

/// What robot_twin_of() serves, for those who wire it to other twins.
TwinServerSettings robot_twin_settings(const Cell& cell, std::optional<int> port);

/// Its object in a ready file.
nlohmann::ordered_json robot_twin_description(const TwinServer& server);

/// The twin of a cell's robot: arm, TCP and payload as the cell says, at the first safe position.
/// @param port  of RTDE; the primary, secondary and dashboard ports follow it. 0: free ones; none:
///              those of the cell
std::unique_ptr<ServingTwin> robot_twin_of(const Cell& cell, std::optional<int> port);

}  // namespace glint
