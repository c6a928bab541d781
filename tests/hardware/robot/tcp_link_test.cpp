// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/tcp_link.h"

#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>

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

/// As long as it lives the process gets no further descriptor.
class NoDescriptors {
 public:
  NoDescriptors() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const int next = ::dup(STDERR_FILENO);
    ::close(next);
    const rlimit none = {.rlim_cur = static_cast<rlim_t>(next), .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
  }

  ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }

  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_ = {};
};

// A stop may have to go out just then: no other kind of exception ends the thread that tries.
TEST(TcpLink, SaysThatThereAreNoDescriptorsLeft) {
  std::string failure;
  {
    const NoDescriptors none;
    failure = failure_of("127.0.0.1", 7, resolve_host);
  }
  EXPECT_THAT(failure, HasSubstr("127.0.0.1:7: "));
  EXPECT_THAT(failure, HasSubstr("open files"));
}

/// A link whose peer reads nothing, filled until its machine takes no more: bytes wait to be sent.
struct FullLink {
  FullLink() {
    const std::string script(std::size_t{1} << 20U, 'x');
    try {
      for (int i = 0; i < 100; ++i) {
        link.write(script, 0.05);
      }
    } catch (const IoError&) {
      is_full = true;
    }
  }

  ~FullLink() { ::close(peer); }

  FullLink(const FullLink&) = delete;
  FullLink& operator=(const FullLink&) = delete;

  /// Reads all that the peer gets. @return what its last read said, 0 at the end of the connection
  ssize_t read_all() const {
    std::array<char, 65536> bytes = {};
    ssize_t count = 1;
    while (count > 0) {
      count = ::recv(peer, bytes.data(), bytes.size(), 0);
    }
    return count;
  }

  LoopbackListener listener;
  TcpLink link{"127.0.0.1", listener.port(), 1.0};
  int peer = listener.accept(1000);
  bool is_full = false;
};

// As a motion that was sent when the cable was out: it does not begin when it is plugged in again.
TEST(TcpLink, DeliversNothingAfterTheLongestTimeForIt) {
  FullLink full;
  ASSERT_TRUE(full.is_full);
  full.link.set_longest_delivery(0.2);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(full.link.read(5.0), IoError) << "the connection is closed";
  EXPECT_LT(seconds_since(begin), 4.0);
}

// As a motion that has not arrived when it is to be stopped.
TEST(TcpLink, TellsThatBytesWaitToBeDelivered) {
  const FullLink full;
  ASSERT_TRUE(full.is_full);
  EXPECT_TRUE(full.link.has_undelivered());
}

TEST(TcpLink, HasNothingUndeliveredWhenThePeerHasIt) {
  const LoopbackListener listener;
  TcpLink link("127.0.0.1", listener.port(), 1.0);
  EXPECT_FALSE(link.has_undelivered());
  link.write("stopj(2)", 1.0);
  const auto begin = std::chrono::steady_clock::now();
  while (link.has_undelivered() && seconds_since(begin) < 2.0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(link.has_undelivered());
}

// As a motion whose stop goes out on another connection.
TEST(TcpLink, DeliversNothingThatWaitsWhenItIsAbandoned) {
  FullLink full;
  ASSERT_TRUE(full.is_full);
  full.link.abandon();
  EXPECT_EQ(full.read_all(), -1);
  EXPECT_EQ(errno, ECONNRESET) << "the rest was thrown away";
}

}  // namespace
}  // namespace glint
