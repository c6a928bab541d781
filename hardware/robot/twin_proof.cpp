// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/twin_proof.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstring>

#include <fmt/format.h>

#include "core/error.h"
#include "core/wall_clock.h"
#include "hardware/robot/protocol/message_splitter.h"
#include "hardware/robot/rtde_client.h"
#include "hardware/robot/tcp_link.h"

namespace glint {
namespace {

constexpr double kTimeoutS = 1.0;

/// A file descriptor that is closed at the end.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}

  ~Descriptor() {
    if (number_ >= 0) {
      ::close(number_);
    }
  }

  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

bool is_ours_alone(const std::filesystem::path& socket) {
  struct stat status = {};
  return ::lstat(socket.c_str(), &status) == 0 && S_ISSOCK(status.st_mode) &&
         status.st_uid == ::geteuid() && (status.st_mode & 0777) == 0600;
}

bool connect_to(const Descriptor& descriptor, const std::filesystem::path& socket) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (socket.native().size() >= sizeof(address.sun_path)) {
    return false;
  }
  std::memcpy(address.sun_path, socket.c_str(), socket.native().size());
  return ::connect(descriptor.number(),
                   reinterpret_cast<const sockaddr*>(&address),
                   sizeof(address)) == 0;
}

std::optional<std::string> reply_on(const Descriptor& descriptor, double timeout_s) {
  const auto start = std::chrono::steady_clock::now();
  LineSplitter lines(65536);
  for (;;) {
    if (auto line = lines.next()) {
      return line;
    }
    pollfd poll = {.fd = descriptor.number(), .events = POLLIN, .revents = 0};
    const double left_s = timeout_s - seconds_since(start);
    if (left_s <= 0.0 || ::poll(&poll, 1, static_cast<int>(1e3 * left_s) + 1) <= 0) {
      return std::nullopt;
    }
    std::array<char, 4096> bytes = {};
    const ssize_t count = ::recv(descriptor.number(), bytes.data(), bytes.size(), 0);
    if (count <= 0) {
      return std::nullopt;
    }
    lines.append({bytes.data(), static_cast<std::size_t>(count)});
  }
}

std::optional<std::uint64_t> token_by_rtde(const std::string& host, int port) {
  TcpLink link(host, port, kTimeoutS);
  if (!link.is_loopback()) {
    return std::nullopt;
  }
  RtdeClient client({.outputs = {kTwinTokenOutput}, .newer = {}, .inputs = {}, .rate_hz = 0.0});
  std::optional<std::uint64_t> token;
  const auto start = std::chrono::steady_clock::now();
  while (!token && seconds_since(start) < kTimeoutS) {
    if (const std::string output = client.take_output(); !output.empty()) {
      link.write(output, kTimeoutS);
    }
    client.feed(link.read(0.05), [&] { token = client.get<std::uint64_t>(kTwinTokenOutput); });
  }
  return token;
}

}  // namespace

std::filesystem::path twin_socket_path(int rtde_port) {
  return std::filesystem::temp_directory_path() / fmt::format("glint-{}", ::geteuid()) /
         fmt::format("robot-{}.sock", rtde_port);
}

std::optional<std::string> ask_side_channel(const std::filesystem::path& socket,
                                            const std::string& line,
                                            double timeout_s) {
  if (!is_ours_alone(socket)) {
    return std::nullopt;
  }
  const Descriptor descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (descriptor.number() < 0 || !connect_to(descriptor, socket)) {
    return std::nullopt;
  }
  const std::string bytes = line + "\n";
  if (::send(descriptor.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(bytes.size())) {
    return std::nullopt;
  }
  return reply_on(descriptor, timeout_s);
}

std::optional<std::uint64_t> proven_token(const std::string& host, int rtde_port) {
  try {
    const auto said = ask_side_channel(twin_socket_path(rtde_port), "token");
    std::uint64_t token = 0;
    if (!said || said->empty() ||
        std::from_chars(said->data(), said->data() + said->size(), token).ptr !=
            said->data() + said->size()) {
      return std::nullopt;
    }
    const bool is_proven = token != 0 && token_by_rtde(host, rtde_port) == token;
    return is_proven ? std::optional(token) : std::nullopt;
  } catch (const IoError&) {
    return std::nullopt;
  }
}

bool is_proven_twin(const std::string& host, int rtde_port) {
  return proven_token(host, rtde_port).has_value();
}

}  // namespace glint
