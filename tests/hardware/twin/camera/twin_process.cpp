// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/twin/camera/twin_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "core/error.h"
#include "hardware/gige/udp_socket.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): not in every header

namespace glint {

std::uint32_t test_address(int index) {
  const auto process = static_cast<std::uint32_t>(::getpid());
  return 0x7f000000U | ((1 + process % 253) << 16U) | ((1 + process / 253 % 253) << 8U) |
         static_cast<std::uint32_t>(index);
}

TwinProcess::TwinProcess(std::uint32_t address, int first_frame_id)
    : address_(address), first_frame_id_(first_frame_id) {
  start();
}

TwinProcess::~TwinProcess() {
  kill();
}

void TwinProcess::start() {
  std::array<int, 2> to = {};
  std::array<int, 2> from = {};
  GLINT_CHECK(::pipe2(to.data(), O_CLOEXEC) == 0 && ::pipe2(from.data(), O_CLOEXEC) == 0, "pipes");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to[0], 0);
  posix_spawn_file_actions_adddup2(&actions, from[1], 1);
  std::string program = CAMERA_TWIN_HOST;
  std::string address = ipv4_text(address_);
  std::string id = std::to_string(first_frame_id_);
  std::array<char*, 4> words = {program.data(), address.data(), id.data(), nullptr};
  const int failure =
      ::posix_spawn(&process_, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(to[0]);
  ::close(from[1]);
  input_ = to[1];
  std::array<char, 16> line = {};
  const bool is_ready = failure == 0 && ::read(from[0], line.data(), line.size()) > 0;
  ::close(from[0]);
  if (!is_ready) {
    throw IoError("the simulated camera does not start at " + address);
  }
}

void TwinProcess::kill() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    ::close(input_);
    process_ = -1;
  }
}

void TwinProcess::freeze() {
  ::kill(process_, SIGSTOP);
}

void TwinProcess::thaw() {
  ::kill(process_, SIGCONT);
}

}  // namespace glint
