// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/loopback_listener.h"

namespace glint::test {

/// Listens on a free port and counts who comes and what they send.
class CountingPeer {
 public:
  CountingPeer() : thread_([this] { count(); }) {}

  ~CountingPeer() {
    listener_.shut_down();
    thread_.join();
  }

  CountingPeer(const CountingPeer&) = delete;
  CountingPeer& operator=(const CountingPeer&) = delete;

  int port() const { return listener_.port(); }

  int connections() const { return connections_; }

  long bytes() const { return bytes_; }

 private:
  void count() {
    for (;;) {
      const int peer = listener_.accept(300);
      if (peer < 0) {
        return;
      }
      ++connections_;
      std::array<char, 4096> buffer = {};
      ssize_t count = 0;
      while ((count = ::recv(peer, buffer.data(), buffer.size(), 0)) > 0) {
        bytes_ += count;
      }
      ::close(peer);
    }
  }

  LoopbackListener listener_;
  std::atomic<int> connections_ = 0;
  std::atomic<long> bytes_ = 0;
  std::thread thread_;  // last: uses the others
};

/// A robot of which only the connections are counted.
struct CountingRobot {
  CountingPeer rtde;
  CountingPeer primary;
  CountingPeer secondary;
  CountingPeer dashboard;

  void expect_not_called() const {
    for (const CountingPeer* peer : {&rtde, &primary, &secondary, &dashboard}) {
      EXPECT_EQ(peer->connections(), 0);
      EXPECT_EQ(peer->bytes(), 0);
    }
  }
};

}  // namespace glint::test
