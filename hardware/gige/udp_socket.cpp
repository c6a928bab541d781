// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/gige/udp_socket.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

sockaddr_in system_address(const Endpoint& endpoint) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  address.sin_addr.s_addr = htonl(endpoint.address);
  return address;
}

Endpoint endpoint_of(const sockaddr_in& address) {
  return {.address = ntohl(address.sin_addr.s_addr), .port = ntohs(address.sin_port)};
}

/// The system's calls take the address of any family.
sockaddr* generic(sockaddr_in& address) {
  return reinterpret_cast<sockaddr*>(&address);
}

}  // namespace

std::optional<std::uint32_t> parse_ipv4(const std::string& text) {
  in_addr address = {};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) {
    return std::nullopt;
  }
  return ntohl(address.s_addr);
}

std::string ipv4_text(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}",
                     address >> 24U,
                     (address >> 16U) & 0xffU,
                     (address >> 8U) & 0xffU,
                     address & 0xffU);
}

bool is_loopback(std::uint32_t address) {
  return (address >> 24U) == 127;
}

UdpSocket::UdpSocket(const Endpoint& local)
    : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  sockaddr_in address = system_address(local);
  if (descriptor_ < 0 || ::bind(descriptor_, generic(address), sizeof(address)) != 0) {
    const std::string reason = last_system_error();
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    throw IoError(fmt::format(
        "cannot listen at {} port {}: {}", ipv4_text(local.address), local.port, reason));
  }
}

UdpSocket::~UdpSocket() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

std::uint16_t UdpSocket::port() const {
  sockaddr_in address = {};
  socklen_t size = sizeof(address);
  ::getsockname(descriptor_, generic(address), &size);
  return ntohs(address.sin_port);
}

void UdpSocket::set_buffer_bytes(int bytes) {
  for (const int option : {SO_RCVBUFFORCE, SO_RCVBUF, SO_SNDBUF}) {
    if (::setsockopt(descriptor_, SOL_SOCKET, option, &bytes, sizeof(bytes)) != 0) {
      continue;  // forcing needs a privilege; the system then gives what it allows
    }
  }
}

bool UdpSocket::send(const Endpoint& to, BytesView packet) {
  sockaddr_in address = system_address(to);
  for (int tries = 0; tries < 100; ++tries) {
    const ssize_t sent =
        ::sendto(descriptor_, packet.data(), packet.size(), 0, generic(address), sizeof(address));
    if (sent >= 0) {
      return true;
    }
    if (errno != EAGAIN && errno != ENOBUFS && errno != ECONNREFUSED) {
      return false;
    }
    pollfd waiting = {.fd = descriptor_, .events = POLLOUT, .revents = 0};
    ::poll(&waiting, 1, 1);
  }
  return false;
}

bool UdpSocket::receive(Bytes& packet, Endpoint& from) {
  constexpr std::size_t kMaxBytes = 65536;
  packet.resize(kMaxBytes);
  sockaddr_in address = {};
  socklen_t size = sizeof(address);
  ssize_t count = -1;
  for (int tries = 0; tries < 8 && count < 0; ++tries) {
    count = ::recvfrom(descriptor_, packet.data(), packet.size(), 0, generic(address), &size);
    if (count < 0 && errno != ECONNREFUSED && errno != EINTR) {
      break;  // nothing there; a refusal is of an earlier packet to somebody who has left
    }
  }
  packet.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  from = endpoint_of(address);
  return count >= 0;
}

bool UdpSocket::wait(std::chrono::microseconds timeout) const {
  pollfd waiting = {.fd = descriptor_, .events = POLLIN, .revents = 0};
  const auto seconds = std::chrono::floor<std::chrono::seconds>(timeout);
  const timespec limit = {.tv_sec = seconds.count(),
                          .tv_nsec = std::chrono::nanoseconds(timeout - seconds).count()};
  return ::ppoll(&waiting, 1, &limit, nullptr) > 0;
}

}  // namespace glint
