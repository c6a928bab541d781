// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/error.h"

namespace glint {

/// A TCP port of 127.0.0.1 that is listened on.
class LoopbackListener {
 public:
  LoopbackListener() : number_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* plain = reinterpret_cast<sockaddr*>(&address);
    GLINT_CHECK(::bind(number_, plain, size) == 0 && ::listen(number_, 8) == 0, "a free port");
    ::getsockname(number_, plain, &size);
    port_ = ntohs(address.sin_port);
  }

  ~LoopbackListener() { ::close(number_); }

  LoopbackListener(const LoopbackListener&) = delete;
  LoopbackListener& operator=(const LoopbackListener&) = delete;

  int port() const { return port_; }

  /// The next peer, on which neither sending nor receiving waits longer; -1 after shut_down().
  int accept(int timeout_ms) const {
    const int peer = ::accept4(number_, nullptr, nullptr, SOCK_CLOEXEC);
    const timeval timeout = {.tv_sec = 0, .tv_usec = 1000 * timeout_ms};
    ::setsockopt(peer, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
    ::setsockopt(peer, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof(timeout));
    return peer;
  }

  /// Wakes whoever waits in accept().
  void shut_down() const { ::shutdown(number_, SHUT_RDWR); }

 private:
  int number_;
  int port_ = 0;
};

}  // namespace glint
