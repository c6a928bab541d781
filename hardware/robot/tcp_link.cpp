// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/tcp_link.h"

#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <boost/asio.hpp>

#include "core/error.h"
#include "core/wall_clock.h"

namespace glint {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

std::chrono::microseconds duration_of(double seconds) {
  return std::chrono::microseconds(static_cast<std::int64_t>(1e6 * seconds));
}

constexpr std::size_t kReadBytes = 65536;

/// A look-up cannot be broken off: it has a thread of its own, which is left alone when it takes
/// too long, and ends with it.
/// @throws what the look-up does; IoError when it takes longer
std::vector<std::string> resolved(const std::string& host,
                                  double timeout_s,
                                  const ResolveHost& resolve) {
  std::packaged_task<std::vector<std::string>()> task([resolve, host] { return resolve(host); });
  std::future<std::vector<std::string>> result = task.get_future();
  std::thread(std::move(task)).detach();
  if (result.wait_for(duration_of(timeout_s)) != std::future_status::ready) {
    throw IoError(fmt::format("the name is not looked up within {:.1f} s", timeout_s));
  }
  return result.get();
}

/// Numbers need no look-up.
std::vector<tcp::endpoint> endpoints_of(const std::string& host,
                                        int port,
                                        double timeout_s,
                                        const ResolveHost& resolve) {
  error_code error;
  const auto number = static_cast<unsigned short>(port);
  if (const auto address = asio::ip::make_address(host, error); !error) {
    return {{address, number}};
  }
  std::vector<tcp::endpoint> endpoints;
  for (const std::string& address : resolved(host, timeout_s, resolve)) {
    endpoints.emplace_back(asio::ip::make_address(address), number);
  }
  return endpoints;
}

}  // namespace

std::vector<std::string> resolve_host(const std::string& host) {
  asio::io_context context;
  tcp::resolver resolver(context);
  error_code error;
  std::vector<std::string> addresses;
  for (const auto& entry : resolver.resolve(host, "", error)) {
    addresses.push_back(entry.endpoint().address().to_string());
  }
  if (error) {
    throw IoError(error.message());
  }
  return addresses;
}

struct TcpLink::Impl {
  asio::io_context context;
  tcp::socket socket{context};
  std::string peer;
  bool is_loopback = false;
  std::array<char, kReadBytes> bytes = {};

  /// Runs until the operation is done; what is not done in time is cancelled.
  /// @return it was done
  bool run(const bool& is_done, double timeout_s) {
    context.restart();
    context.run_for(duration_of(timeout_s));
    if (is_done) {
      return true;
    }
    error_code ignored;
    socket.cancel(ignored);
    context.restart();
    context.run();
    return false;
  }
};

TcpLink::TcpLink(const std::string& host, int port, double timeout_s, const ResolveHost& resolve) {
  const std::string peer = fmt::format("{}:{}", host, port);
  try {
    impl_ = std::make_unique<Impl>();
  } catch (const boost::system::system_error& error_of_system) {
    throw IoError(fmt::format("{}: {}", peer, error_of_system.what()));
  }
  impl_->peer = peer;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<tcp::endpoint> found;
  try {
    found = endpoints_of(host, port, timeout_s, resolve);
  } catch (const IoError& error) {
    throw IoError(fmt::format("{}: {}", impl_->peer, error.what()));
  }
  error_code error;
  bool is_done = false;
  asio::async_connect(
      impl_->socket, found, [&](const error_code& result, const tcp::endpoint& endpoint) {
        error = result;
        impl_->is_loopback = !result && endpoint.address().is_loopback();
        is_done = true;
      });
  if (!impl_->run(is_done, std::max(0.0, timeout_s - seconds_since(begin)))) {
    throw IoError(fmt::format("{}: no answer within {:.1f} s", impl_->peer, timeout_s));
  }
  if (error) {
    throw IoError(fmt::format("{}: {}", impl_->peer, error.message()));
  }
  impl_->socket.set_option(tcp::no_delay(true), error);
}

TcpLink::~TcpLink() = default;
TcpLink::TcpLink(TcpLink&&) noexcept = default;
TcpLink& TcpLink::operator=(TcpLink&&) noexcept = default;

void TcpLink::write(std::string_view bytes, double timeout_s) {
  bool is_done = false;
  error_code error;
  asio::async_write(impl_->socket,
                    asio::buffer(bytes.data(), bytes.size()),
                    [&](const error_code& result, std::size_t) {
                      error = result;
                      is_done = true;
                    });
  if (!impl_->run(is_done, timeout_s)) {
    throw IoError(fmt::format("{}: takes no bytes", impl_->peer));
  }
  if (error) {
    throw IoError(fmt::format("{}: {}", impl_->peer, error.message()));
  }
}

void TcpLink::set_longest_delivery(double seconds) {
  const auto milliseconds = static_cast<unsigned>(1e3 * seconds);
  ::setsockopt(impl_->socket.native_handle(),
               IPPROTO_TCP,
               TCP_USER_TIMEOUT,
               &milliseconds,
               sizeof(milliseconds));
}

bool TcpLink::has_undelivered() const {
  int bytes = 0;
  return ::ioctl(impl_->socket.native_handle(), SIOCOUTQ, &bytes) == 0 && bytes > 0;
}

std::string TcpLink::read(double timeout_s) {
  bool is_done = false;
  error_code error;
  std::size_t count = 0;
  impl_->socket.async_read_some(asio::buffer(impl_->bytes),
                                [&](const error_code& result, std::size_t length) {
                                  error = result;
                                  count = length;
                                  is_done = true;
                                });
  const bool is_in_time = impl_->run(is_done, timeout_s);
  if (error && (is_in_time || error != asio::error::operation_aborted)) {
    throw IoError(fmt::format("{}: the connection was closed", impl_->peer));
  }
  return {impl_->bytes.data(), count};
}

void TcpLink::finish(double timeout_s) {
  const auto begin = std::chrono::steady_clock::now();
  error_code ignored;
  impl_->socket.shutdown(tcp::socket::shutdown_send, ignored);
  try {
    while (seconds_since(begin) < timeout_s) {
      read(timeout_s - seconds_since(begin));
    }
  } catch (const IoError&) {
    return;  // closed
  }
}

void TcpLink::abandon() {
  error_code ignored;
  impl_->socket.set_option(tcp::socket::linger(true, 0), ignored);
  impl_->socket.close(ignored);
}

const std::string& TcpLink::peer() const {
  return impl_->peer;
}

bool TcpLink::is_loopback() const {
  return impl_->is_loopback;
}

}  // namespace glint
