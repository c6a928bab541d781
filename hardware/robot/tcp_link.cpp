// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/tcp_link.h"

#include <array>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <boost/asio.hpp>

#include "core/error.h"

namespace glint {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

std::chrono::microseconds duration_of(double seconds) {
  return std::chrono::microseconds(static_cast<std::int64_t>(1e6 * seconds));
}

constexpr std::size_t kReadBytes = 65536;

}  // namespace

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

TcpLink::TcpLink(const std::string& host, int port, double timeout_s)
    : impl_(std::make_unique<Impl>()) {
  impl_->peer = fmt::format("{}:{}", host, port);
  error_code error;
  tcp::resolver resolver(impl_->context);
  const auto found = resolver.resolve(host, std::to_string(port), error);
  if (error) {
    throw IoError(fmt::format("{}: {}", impl_->peer, error.message()));
  }
  bool is_done = false;
  asio::async_connect(
      impl_->socket, found, [&](const error_code& result, const tcp::endpoint& endpoint) {
        error = result;
        impl_->is_loopback = !result && endpoint.address().is_loopback();
        is_done = true;
      });
  if (!impl_->run(is_done, timeout_s)) {
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

const std::string& TcpLink::peer() const {
  return impl_->peer;
}

bool TcpLink::is_loopback() const {
  return impl_->is_loopback;
}

}  // namespace glint
