// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// The addresses of a host's name, as numbers. May take as long as it likes.
using ResolveHost = std::function<std::vector<std::string>(const std::string& host)>;

/// As the system knows it. @throws IoError when it does not
std::vector<std::string> resolve_host(const std::string& host);

/// A TCP connection on which nothing takes longer than it may. For one thread at a time.
class TcpLink {
 public:
  /// @param host  an address, or a name: looked up and connected to within the time together
  /// @throws IoError naming host and port: unknown, refused, no answer in time; the system has no
  ///         descriptors left
  TcpLink(const std::string& host,
          int port,
          double timeout_s,
          const ResolveHost& resolve = resolve_host);
  ~TcpLink();
  TcpLink(TcpLink&&) noexcept;
  TcpLink& operator=(TcpLink&&) noexcept;

  /// @throws IoError when the peer is gone or does not take the bytes in time
  void write(std::string_view bytes, double timeout_s);

  /// What the peer's machine has not acknowledged within this time is thrown away with the
  /// connection, also when this process has ended meanwhile.
  /// @param seconds  0: as long as the system tries, which may be a quarter of an hour
  void set_longest_delivery(double seconds);

  /// Bytes that were written wait to be sent, or the peer's machine has not acknowledged them.
  bool has_undelivered() const;

  /// What has come, at most 64 kB: empty when nothing came in time.
  /// @throws IoError when the peer has closed the connection
  std::string read(double timeout_s);

  /// Tells the peer that nothing more comes, and waits until it closes, too: what was closed at
  /// once might be thrown away unread.
  void finish(double timeout_s);

  /// Closes the connection at once: what waits to be sent is thrown away. Nothing is read or
  /// written any more.
  void abandon();

  /// "127.0.0.1:30004", of the peer as it was reached.
  const std::string& peer() const;

  /// The peer's address lies in 127.0.0.0/8.
  bool is_loopback() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
