// SPDX-License-Identifier: GPL-3.0-or-later
//
// Addresses and processes for tests of simulated cameras.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace glint {

/// Sensor of a TwinProcess.
inline constexpr int kTwinWidth = 2448;
inline constexpr int kTwinHeight = 2050;

/// An address of this machine that no other test uses at the same time.
/// @param index  1 to 200
std::uint32_t test_address(int index);

/// A simulated camera in a process of its own; killed at the end.
class TwinProcess {
 public:
  explicit TwinProcess(std::uint32_t address, int first_frame_id = 65500);
  ~TwinProcess();
  TwinProcess(const TwinProcess&) = delete;
  TwinProcess& operator=(const TwinProcess&) = delete;

  void start();  ///< returns when it listens
  void kill();
  void freeze();  ///< until thaw()
  void thaw();

  pid_t id() const { return process_; }

 private:
  std::uint32_t address_ = 0;
  int first_frame_id_ = 1;
  pid_t process_ = -1;
  int input_ = -1;
};

}  // namespace glint
