// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/dashboard.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/loopback_listener.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// Greets its one client, answers each piece of text by one line, and keeps what it was sent.
class GreetingPeer {
 public:
  explicit GreetingPeer(std::string greeting)
      : thread_([this, greeting = std::move(greeting)] { serve(greeting); }) {}

  ~GreetingPeer() { end(); }

  GreetingPeer(const GreetingPeer&) = delete;
  GreetingPeer& operator=(const GreetingPeer&) = delete;

  int port() const { return listener_.port(); }

  /// All that came, when the client has gone.
  const std::string& received() {
    end();
    return received_;
  }

 private:
  void end() {
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  void serve(const std::string& greeting) {
    const int peer = listener_.accept(2000);
    ::send(peer, greeting.data(), greeting.size(), MSG_NOSIGNAL);
    std::array<char, 256> bytes = {};
    ssize_t count = 0;
    while ((count = ::recv(peer, bytes.data(), bytes.size(), 0)) > 0) {
      received_.append(bytes.data(), static_cast<std::size_t>(count));
      ::send(peer, "true\n", 5, MSG_NOSIGNAL);
    }
    ::close(peer);
  }

  std::string received_;
  LoopbackListener listener_;
  std::thread thread_;  // last: uses the others
};

TEST(Dashboard, AsksWhoGreetsAsADashboard) {
  GreetingPeer peer("Connected: Universal Robots Dashboard Server\n");
  {
    Dashboard dashboard("127.0.0.1", peer.port(), 1.0);
    EXPECT_EQ(dashboard.ask("running"), "true");
  }
  EXPECT_EQ(peer.received(), "running\n");
}

// The primary interface begins with a message of its version: what is asked there is a program.
TEST(Dashboard, WritesNothingToAPortThatGreetsOtherwise) {
  for (const std::string& greeting :
       {std::string("\0\0\0\x37\x14URControl\n", 15), std::string("hello\n"), std::string("\n")}) {
    GreetingPeer peer(greeting);
    EXPECT_THROW(Dashboard("127.0.0.1", peer.port(), 1.0), ProtocolError);
    EXPECT_EQ(peer.received(), "");
  }
}

}  // namespace
}  // namespace glint
