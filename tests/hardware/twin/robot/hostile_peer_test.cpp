// SPDX-License-Identifier: GPL-3.0-or-later
//
// Peers that do not keep to the protocol cost a clear error in time and no memory.
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/wall_clock.h"
#include "hardware/robot/dashboard.h"
#include "hardware/robot/ur_robot.h"
#include "hardware/twin/robot/twin_server.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/twin/robot/twin_harness.h"
#include "tests/support/loopback_listener.h"
#include "tests/support/resident_memory.h"

namespace glint {
namespace {

/// Sends the same bytes again and again to whoever connects.
class HostilePeer {
 public:
  explicit HostilePeer(std::string bytes)
      : bytes_(std::move(bytes)), thread_([this] { serve(); }) {}

  ~HostilePeer() {
    is_over_ = true;
    listener_.shut_down();
    thread_.join();
  }

  HostilePeer(const HostilePeer&) = delete;
  HostilePeer& operator=(const HostilePeer&) = delete;

  int port() const { return listener_.port(); }

 private:
  void serve() {
    while (!is_over_) {
      const int peer = listener_.accept(100);
      if (peer < 0) {
        return;
      }
      ssize_t sent = 1;
      while (!is_over_ && sent > 0) {
        sent = ::send(peer, bytes_.data(), bytes_.size(), MSG_NOSIGNAL);
      }
      ::close(peer);
    }
  }

  std::string bytes_;
  LoopbackListener listener_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;  // last: uses the others
};

std::string garbage(std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 3);
  std::string bytes(65536, '\0');
  for (char& byte : bytes) {
    byte = static_cast<char>(rng.next_u32());
  }
  return bytes;
}

std::vector<std::string> hostile_bytes() {
  return {std::string(65536, 'x'),                  // an endless line
          std::string(65536, '\xff'),               // huge lengths
          std::string(65536, '\0'),                 // lengths below that of a head
          std::string("\xff\xff", 2) + garbage(1),  // the longest package, then garbage
          garbage(2),
          rtde_package(RtdeKind::kText, "\xff"),          // a text that is too short
          flag_reply(RtdeKind::kProtocolVersion, false),  // refuses the version
          recipe_reply(RtdeKind::kOutputs, {1, {"DOUBLE"}})};
}

TEST(UrRobot, AHostilePeerCostsAnErrorInTimeAndNoMemory) {
  const double before_mb = resident_mb();
  for (const std::string& bytes : hostile_bytes()) {
    const HostilePeer peer(bytes);
    UrSettings settings = test_robot(ArmModel::kUr3);
    settings.rtde_port = peer.port();
    const auto start = std::chrono::steady_clock::now();
    EXPECT_THROW(UrRobot(settings, arm_with_tool(settings, test_limits()), 1.0), IoError);
    EXPECT_LT(seconds_since(start), 5.0);
  }
  EXPECT_LT(resident_mb() - before_mb, 50.0);
}

/// What the constructor of a robot at this port says that fails.
std::string error_of_robot_at(int port) {
  UrSettings settings = test_robot(ArmModel::kUr3);
  settings.rtde_port = port;
  try {
    const UrRobot robot(settings, arm_with_tool(settings, test_limits()), 1.0);
  } catch (const IoError& error) {
    return error.what();
  }
  return "";
}

/// Closes each connection at once.
class ClosingPeer {
 public:
  ~ClosingPeer() {
    listener_.shut_down();
    thread_.join();
  }

  int port() const { return listener_.port(); }

 private:
  LoopbackListener listener_;
  std::thread thread_{[this] {
    for (int peer = 0; (peer = listener_.accept(100)) >= 0;) {
      ::close(peer);
    }
  }};
};

TEST(UrRobot, ErrorsNameTheAddressOnce) {
  const ClosingPeer closing;
  EXPECT_EQ(error_of_robot_at(closing.port()),
            fmt::format("127.0.0.1:{}: the connection was closed", closing.port()));
  const HostilePeer hostile(flag_reply(RtdeKind::kProtocolVersion, false));
  const std::string address = fmt::format("127.0.0.1:{}: ", hostile.port());
  EXPECT_THAT(error_of_robot_at(hostile.port()), testing::StartsWith(address));
  EXPECT_THAT(error_of_robot_at(hostile.port()), testing::Not(testing::HasSubstr(": " + address)));
}

TEST(Dashboard, AHostilePeerCostsAnErrorInTime) {
  for (const std::string& bytes : {std::string(65536, 'x'), std::string(65536, '\0')}) {
    const HostilePeer peer(bytes);
    EXPECT_THROW(Dashboard("127.0.0.1", peer.port(), 1.0), IoError);
  }
  EXPECT_THROW(Dashboard("127.0.0.1", 1, 1.0), IoError) << "nobody listens";
}

TEST(TwinServer, HostileClientsAreDroppedAndOthersServed) {
  TwinServer server({.twin = test_twin(ArmModel::kUr3), .ports = {0, 0, 0, 0}});
  for (const int port : {server.ports().rtde,
                         server.ports().primary,
                         server.ports().secondary,
                         server.ports().dashboard}) {
    for (const std::string& bytes : hostile_bytes()) {
      try {
        TcpLink link("127.0.0.1", port, 1.0);
        for (int i = 0; i < 20; ++i) {
          link.write(bytes, 0.2);
        }
      } catch (const IoError&) {
        continue;  // dropped while it was still sending
      }
    }
  }
  UrSettings settings = test_robot(ArmModel::kUr3);
  settings.rtde_port = server.ports().rtde;
  const UrRobot robot(settings, arm_with_tool(settings, test_limits()));
  EXPECT_TRUE(robot.state().has_value());
}

}  // namespace
}  // namespace glint
