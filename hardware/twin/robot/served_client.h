// SPDX-License-Identifier: GPL-3.0-or-later
//
// Included by twin_server.cpp alone, as Boost.Asio takes long to compile.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio.hpp>

#include "hardware/robot/protocol/message_splitter.h"

namespace glint {

/// A client that lets more than this wait is dropped.
inline constexpr std::size_t kMaxWaitingBytes = 1 << 20;

/// One connection: what comes goes to a handler, what is sent waits its turn.
class ServedClient : public std::enable_shared_from_this<ServedClient> {
 public:
  using OnBytes = std::function<std::string(std::string_view)>;

  ServedClient(boost::asio::ip::tcp::socket socket,
               OnBytes on_bytes,
               std::function<void()> on_drained)
      : socket_(std::move(socket)),
        on_bytes_(std::move(on_bytes)),
        on_drained_(std::move(on_drained)) {}

  bool is_open() const { return socket_.is_open(); }

  std::size_t waiting_bytes() const { return waiting_.size() + sending_.size(); }

  void set_split(bool is_split) { is_split_ = is_split; }

  void close() {
    boost::system::error_code ignored;
    socket_.close(ignored);
    on_bytes_ = nullptr;
  }

  /// Sends what still waits, then closes.
  void close_when_sent() {
    is_closing_ = true;
    if (waiting_bytes() == 0) {
      close();
    }
  }

  void send(std::string_view bytes) {
    if (!is_open() || bytes.empty()) {
      return;
    }
    waiting_ += bytes;
    if (waiting_.size() > kMaxWaitingBytes) {
      close();
    } else if (sending_.empty()) {
      write();
    }
  }

  void read() {
    socket_.async_read_some(
        boost::asio::buffer(bytes_),
        [self = shared_from_this()](const boost::system::error_code& error, std::size_t count) {
          self->on_read(error, count);
        });
  }

 private:
  void on_read(const boost::system::error_code& error, std::size_t count) {
    if (error || !on_bytes_) {
      close();
      return;
    }
    const OnBytes handler = on_bytes_;  // it may close this client while it runs
    try {
      send(handler({bytes_.data(), count}));
    } catch (const ProtocolError&) {
      close();
      return;
    }
    if (is_open()) {
      read();
    }
  }

  void write() {
    const std::size_t count = is_split_ ? 1 : waiting_.size();
    sending_ = waiting_.substr(0, count);
    waiting_.erase(0, count);
    boost::asio::async_write(
        socket_,
        boost::asio::buffer(sending_),
        [self = shared_from_this()](const boost::system::error_code& error, std::size_t) {
          self->sending_.clear();
          if (error || (self->waiting_.empty() && self->is_closing_)) {
            self->close();
          } else if (!self->waiting_.empty()) {
            self->write();
          } else if (self->on_drained_) {
            self->on_drained_();
          }
        });
  }

  boost::asio::ip::tcp::socket socket_;
  OnBytes on_bytes_;
  std::function<void()> on_drained_;
  std::array<char, 16384> bytes_ = {};
  std::string waiting_;
  std::string sending_;
  bool is_split_ = false;
  bool is_closing_ = false;
};

}  // namespace glint
