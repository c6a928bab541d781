// SPDX-License-Identifier: GPL-3.0-or-later
//
// UDP over IPv4, no more than GigE Vision needs: sockets that are bound to one address and never
// block.
#pragma once

#include <netinet/in.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "hardware/gige/packets.h"

namespace glint {

/// An IPv4 address and a port, both in the machine's byte order.
struct Endpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

/// Empty when the text is no IPv4 address in four numbers.
std::optional<std::uint32_t> parse_ipv4(const std::string& text);
std::string ipv4_text(std::uint32_t address);
bool is_loopback(std::uint32_t address);

class UdpSocket {
 public:
  /// @param local  port 0: any free one
  /// @throws IoError when the address is taken or not this machine's
  explicit UdpSocket(const Endpoint& local);
  ~UdpSocket();
  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&&) = delete;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  int descriptor() const { return descriptor_; }

  std::uint16_t port() const;

  /// Buffers of about that size, as far as the system allows.
  void set_buffer_bytes(int bytes);

  /// False when the packet could not be handed to the system.
  bool send(const Endpoint& to, BytesView packet);

  /// The next packet that has arrived, at most 65536 bytes; false: none has.
  bool receive(Bytes& packet, Endpoint& from);

  /// Waits until a packet has arrived. @return false: none within that time
  bool wait(std::chrono::microseconds timeout) const;

 private:
  int descriptor_ = -1;
};

}  // namespace glint
