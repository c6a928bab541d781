// SPDX-License-Identifier: GPL-3.0-or-later
//
// A port before another one: what can happen to a connection between a robot and its controller.
#pragma once

#include <linux/filter.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <iterator>
#include <list>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "tests/support/loopback_listener.h"

namespace glint {

/// Passes on what comes at a port of its own, each connection to a new one.
class Relay {
 public:
  enum class Way { kThereAlone, kBoth };

  /// @param to_port  of 127.0.0.1
  /// @param way      kThereAlone: what comes back is kept from the client
  explicit Relay(int to_port, Way way = Way::kBoth)
      : to_port_(to_port), way_(way), acceptor_([this] { accept_all(); }) {}

  ~Relay() {
    listener_.shut_down();
    acceptor_.join();
    for (Connection& connection : connections_) {
      ::shutdown(connection.client, SHUT_RDWR);
      ::shutdown(connection.server, SHUT_RDWR);
    }
    for (Connection& connection : connections_) {
      connection.there.join();
      connection.back.join();
      ::close(connection.client);
      ::close(connection.server);
    }
  }

  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  int port() const { return listener_.port(); }

  /// Sent to the first client, between what the server sends.
  void inject(std::string_view bytes) {
    const std::lock_guard lock(mutex_);
    ::send(connections_.front().client, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }

  /// The cable of the first connection is out: its client's bytes do not arrive, and none is
  /// acknowledged. Other connections go on. @return the system does it
  bool pull() {
    const std::lock_guard lock(mutex_);
    sock_filter drop_all = {.code = BPF_RET | BPF_K, .jt = 0, .jf = 0, .k = 0};
    const sock_fprog program = {.len = 1, .filter = &drop_all};
    return ::setsockopt(connections_.front().client,
                        SOL_SOCKET,
                        SO_ATTACH_FILTER,
                        &program,
                        sizeof(program)) == 0;
  }

  /// It is in again: what the client's machine still has to send arrives soon.
  void plug() {
    const std::lock_guard lock(mutex_);
    const int none = 0;
    ::setsockopt(connections_.front().client, SOL_SOCKET, SO_DETACH_FILTER, &none, sizeof(none));
    // A client that is not there any more answers to this byte that it is not.
    ::send(connections_.front().client, "\n", 1, MSG_NOSIGNAL);
  }

  std::size_t num_connections() const {
    const std::lock_guard lock(mutex_);
    return connections_.size();
  }

  /// What has come from a client, the first one is 0.
  std::string received(std::size_t index) const {
    const std::lock_guard lock(mutex_);
    return std::next(connections_.begin(), static_cast<std::ptrdiff_t>(index))->received;
  }

  /// The first client's machine knows nothing of the connection any more.
  bool is_reset() const {
    const std::lock_guard lock(mutex_);
    return connections_.front().is_reset;
  }

 private:
  struct Connection {
    int client = -1;
    int server = -1;
    std::string received;
    bool is_reset = false;
    std::thread there;
    std::thread back;
  };

  void accept_all() {
    for (int client = 0; (client = listener_.accept(0)) >= 0;) {
      const int server = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address = {};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(to_port_));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      ::connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
      const std::lock_guard lock(mutex_);
      Connection& connection = connections_.emplace_back();
      connection.client = client;
      connection.server = server;
      connection.there = std::thread([this, &connection] { pass_there(connection); });
      connection.back = std::thread([this, &connection] { pass_back(connection); });
    }
  }

  void pass_there(Connection& connection) {
    std::array<char, 65536> bytes = {};
    ssize_t count = 0;
    while ((count = ::recv(connection.client, bytes.data(), bytes.size(), 0)) > 0) {
      const std::lock_guard lock(mutex_);
      connection.received.append(bytes.data(), static_cast<std::size_t>(count));
      ::send(connection.server, bytes.data(), static_cast<std::size_t>(count), MSG_NOSIGNAL);
    }
    const bool is_reset = count < 0 && errno == ECONNRESET;
    const std::lock_guard lock(mutex_);
    connection.is_reset = is_reset;
    ::shutdown(connection.server, SHUT_WR);
  }

  void pass_back(Connection& connection) {
    std::array<char, 65536> bytes = {};
    ssize_t count = 0;
    while ((count = ::recv(connection.server, bytes.data(), bytes.size(), 0)) > 0) {
      const std::lock_guard lock(mutex_);
      if (way_ == Way::kBoth) {
        ::send(connection.client, bytes.data(), static_cast<std::size_t>(count), MSG_NOSIGNAL);
      }
    }
    ::shutdown(connection.client, SHUT_WR);
  }

  int to_port_;
  Way way_;
  LoopbackListener listener_;
  mutable std::mutex mutex_;
  std::list<Connection> connections_;
  std::thread acceptor_;  // last: uses the others
};

}  // namespace glint
