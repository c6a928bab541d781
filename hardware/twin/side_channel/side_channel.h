// SPDX-License-Identifier: GPL-3.0-or-later
//
// The side channel of a twin: a Unix socket that only its user may open (mode 0600, in a folder of
// mode 0700). A client sends one line and gets one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

namespace glint {

class SideChannel {
 public:
  /// @param answer  to a line without its end; called from a thread of the channel
  /// @throws IoError when the folder is not this user's alone, or the socket cannot be made
  SideChannel(std::filesystem::path socket, std::function<std::string(const std::string&)> answer);
  ~SideChannel();
  SideChannel(const SideChannel&) = delete;
  SideChannel& operator=(const SideChannel&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void serve(const std::stop_token& stop);
  void answer_client(int client);

  std::filesystem::path path_;
  std::function<std::string(const std::string&)> answer_;
  int listening_ = -1;
  std::jthread thread_;
};

/// A random number of the system that is not 0: what a twin proves itself with.
/// @throws IoError when there is none
std::uint64_t fresh_token();

/// The socket of the camera twin that listens at this address: <temporary
/// folder>/glint-<user>/camera-<address>.sock
std::filesystem::path camera_twin_socket(const std::string& address);

/// That of the stage twin at this port: stage-<port>.sock there.
std::filesystem::path stage_twin_socket(int port);

}  // namespace glint
