// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

/// A TCP connection on which nothing takes longer than it may. For one thread at a time.
class TcpLink {
 public:
  /// @throws IoError naming host and port: unknown, refused, no answer in time
  TcpLink(const std::string& host, int port, double timeout_s);
  ~TcpLink();
  TcpLink(TcpLink&&) noexcept;
  TcpLink& operator=(TcpLink&&) noexcept;

  /// @throws IoError when the peer is gone or does not take the bytes in time
  void write(std::string_view bytes, double timeout_s);

  /// What has come, at most 64 kB: empty when nothing came in time.
  /// @throws IoError when the peer has closed the connection
  std::string read(double timeout_s);

  /// "127.0.0.1:30004", of the peer as it was reached.
  const std::string& peer() const;

  /// The peer's address lies in 127.0.0.0/8.
  bool is_loopback() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
