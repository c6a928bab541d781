// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/light/text_link.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kLongestLine = 1000;

speed_t speed_of(int baud) {
  constexpr std::array<std::pair<int, speed_t>, 5> kSpeeds = {
      {{9600, B9600}, {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}}};
  const auto found =
      std::ranges::find_if(kSpeeds, [&](const auto& speed) { return speed.first == baud; });
  if (found == kSpeeds.end()) {
    throw ConfigError("baud",
                      fmt::format("is {}, must be one of 9600, 19200, 38400, 57600, 115200", baud));
  }
  return found->second;
}

bool wait_for(int descriptor, short events, Clock::time_point until) {
  pollfd waiting = {.fd = descriptor, .events = events, .revents = 0};
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  return ::poll(&waiting, 1, static_cast<int>(std::max<std::int64_t>(0, left))) > 0;
}

}  // namespace

TextLink TextLink::serial(const std::filesystem::path& device, int baud) {
  const speed_t speed = speed_of(baud);
  TextLink link(::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  termios settings = {};
  if (link.descriptor_ < 0 || ::tcgetattr(link.descriptor_, &settings) != 0) {
    throw IoError(fmt::format("{}: {}", device.string(), last_system_error()));
  }
  ::cfmakeraw(&settings);
  settings.c_cflag = (settings.c_cflag & ~static_cast<tcflag_t>(HUPCL)) | CLOCAL | CREAD;
  ::cfsetispeed(&settings, speed);
  ::cfsetospeed(&settings, speed);
  if (::tcsetattr(link.descriptor_, TCSANOW, &settings) != 0) {
    throw IoError(fmt::format("{}: {}", device.string(), last_system_error()));
  }
  link.is_serial_ = true;
  return link;
}

TextLink TextLink::tcp(const std::string& ipv4, int port, std::chrono::milliseconds within) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, ipv4.c_str(), &address.sin_addr) != 1) {
    throw ConfigError("address", ipv4 + " is no IPv4 address");
  }
  TextLink link(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const bool is_refused =  // at once; most peers are still awaited
      ::connect(link.descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 &&
      errno != EINPROGRESS;
  int failure = is_refused ? errno : ETIMEDOUT;
  socklen_t size = sizeof(failure);
  if (!is_refused && wait_for(link.descriptor_, POLLOUT, Clock::now() + within)) {
    ::getsockopt(link.descriptor_, SOL_SOCKET, SO_ERROR, &failure, &size);
  }
  if (failure != 0) {
    errno = failure;
    throw IoError(fmt::format("{}:{}: {}", ipv4, port, last_system_error()));
  }
  return link;
}

TextLink::~TextLink() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

TextLink::TextLink(TextLink&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      is_serial_(other.is_serial_),
      received_(std::move(other.received_)) {}

void TextLink::send(const std::string& text) {
  const auto until = Clock::now() + std::chrono::seconds(2);
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t count = ::write(descriptor_, text.data() + sent, text.size() - sent);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno != EAGAIN || !wait_for(descriptor_, POLLOUT, until)) {
      throw IoError("the device takes no more: " + last_system_error());
    }
  }
}

std::optional<std::string> TextLink::line(std::chrono::milliseconds within) {
  const auto until = Clock::now() + within;
  for (;;) {
    const std::size_t end = received_.find('\n');
    if (end != std::string::npos) {
      std::string text = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (text.ends_with('\r')) {
        text.pop_back();
      }
      return text;
    }
    if (received_.size() > kLongestLine) {
      throw IoError("the device sends a line without an end");
    }
    if (!wait_for(descriptor_, POLLIN, until)) {
      return std::nullopt;
    }
    std::array<char, 256> buffer = {};
    const ssize_t count = ::read(descriptor_, buffer.data(), buffer.size());
    if (count == 0 || (count < 0 && errno != EAGAIN)) {
      throw IoError("the device is gone");
    }
    received_.append(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  }
}

}  // namespace glint
