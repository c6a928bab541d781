// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/side_channel/side_channel.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

constexpr int kPollMs = 50;
constexpr int kClientMs = 1000;
constexpr std::size_t kLongestLine = 4096;

/// A folder that only this user may enter; made where there is none.
/// @throws IoError when it is somebody else's, or open to others
void make_private_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    throw IoError(folder.string() + ": " + last_system_error());
  }
  struct stat status = {};
  const bool is_own = ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
                      status.st_uid == ::geteuid() && (status.st_mode & 0077U) == 0;
  if (!is_own) {
    throw IoError(folder.string() + ": must be a folder that only you may enter (mode 0700)");
  }
}

std::filesystem::path socket_folder() {
  return std::filesystem::temp_directory_path() / fmt::format("glint-{}", ::geteuid());
}

}  // namespace

SideChannel::SideChannel(std::filesystem::path socket,
                         std::function<std::string(const std::string&)> answer)
    : path_(std::move(socket)),
      answer_(std::move(answer)),
      listening_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  make_private_folder(path_.parent_path());
  if (path_.native().size() >= sizeof(address.sun_path)) {
    throw IoError(path_.string() + ": is too long for a socket");
  }
  std::memcpy(address.sun_path, path_.c_str(), path_.native().size());
  ::unlink(path_.c_str());  // of a twin that was killed: its address is ours now
  if (::bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 ||
      ::chmod(path_.c_str(), 0600) != 0 || ::listen(listening_, 4) != 0) {
    const std::string reason = last_system_error();
    ::close(listening_);
    throw IoError(fmt::format("{}: {}", path_.string(), reason));
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
}

SideChannel::~SideChannel() {
  thread_ = {};
  ::close(listening_);
  ::unlink(path_.c_str());
}

void SideChannel::serve(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    pollfd waiting = {.fd = listening_, .events = POLLIN, .revents = 0};
    if (::poll(&waiting, 1, kPollMs) <= 0) {
      continue;
    }
    const int client = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client >= 0) {
      answer_client(client);
      ::close(client);
    }
  }
}

void SideChannel::answer_client(int client) {
  std::string line;
  while (line.size() < kLongestLine && !line.ends_with('\n')) {
    pollfd waiting = {.fd = client, .events = POLLIN, .revents = 0};
    std::array<char, 256> bytes = {};
    if (::poll(&waiting, 1, kClientMs) <= 0) {
      return;
    }
    const ssize_t count = ::recv(client, bytes.data(), bytes.size(), 0);
    if (count <= 0) {
      return;
    }
    line.append(bytes.data(), static_cast<std::size_t>(count));
  }
  const std::string reply = answer_(line.substr(0, line.find('\n'))) + "\n";
  ::send(client, reply.data(), reply.size(), MSG_NOSIGNAL);
}

std::uint64_t fresh_token() {
  std::uint64_t token = 0;
  while (token == 0) {
    if (::getentropy(&token, sizeof(token)) != 0) {
      throw IoError("no random numbers: " + last_system_error());
    }
  }
  return token;
}

std::filesystem::path camera_twin_socket(const std::string& address) {
  return socket_folder() / fmt::format("camera-{}.sock", address);
}

std::filesystem::path stage_twin_socket(int port) {
  return socket_folder() / fmt::format("stage-{}.sock", port);
}

}  // namespace glint
