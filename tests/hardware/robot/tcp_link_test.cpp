// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/tcp_link.h"

#include <chrono>
#include <future>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/wall_clock.h"
#include "tests/support/loopback_listener.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// What connecting fails with; empty: nothing.
std::string failure_of(const std::string& host, int port, const ResolveHost& resolve) {
  try {
    const TcpLink link(host, port, 0.2, resolve);
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

TEST(TcpLink, LooksUpNamesAndNoNumbers) {
  const LoopbackListener listener;
  const ResolveHost refuses = [](const std::string&) -> std::vector<std::string> {
    throw IoError("asked");
  };
  EXPECT_EQ(failure_of("127.0.0.1", listener.port(), refuses), "");
  EXPECT_EQ(failure_of("robot.example", 7, refuses), "robot.example:7: asked");
  const TcpLink link("localhost", listener.port(), 2.0);
  EXPECT_TRUE(link.is_loopback());
  EXPECT_THAT(link.peer(), HasSubstr("localhost"));
}

TEST(TcpLink, TriesAllAddressesOfAName) {
  const LoopbackListener listener;
  const ResolveHost two = [](const std::string&) {
    return std::vector<std::string>{"127.0.0.77", "127.0.0.1"};
  };
  EXPECT_EQ(failure_of("robot.example", listener.port(), two), "");
}

TEST(TcpLink, DoesNotWaitForANameServerThatIsSilent) {
  std::promise<void> end;
  const std::shared_future<void> ended = end.get_future().share();
  const ResolveHost silent = [ended](const std::string&) -> std::vector<std::string> {
    ended.wait();
    return {};
  };
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(failure_of("robot.example", 7, silent),
            "robot.example:7: the name is not looked up within 0.2 s");
  EXPECT_LT(seconds_since(begin), 2.0);
  end.set_value();
}

// A link to nobody names whom it was for, also where a name has no address.
TEST(TcpLink, NamesHostAndPortOfWhatFails) {
  const ResolveHost none = [](const std::string&) { return std::vector<std::string>{}; };
  EXPECT_THAT(failure_of("robot.example", 7, none), HasSubstr("robot.example:7: "));
  int free_port = 0;
  {
    const LoopbackListener closed;
    free_port = closed.port();
  }
  EXPECT_THAT(failure_of("127.0.0.1", free_port, resolve_host), HasSubstr("refused"));
}

}  // namespace
}  // namespace glint
