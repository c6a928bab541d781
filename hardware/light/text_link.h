// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of text to a device and back: over a serial line, or over TCP.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace glint {

class TextLink {
 public:
  /// A serial line, 8 bits, no parity. Many boards restart when DTR rises: it stays up when the
  /// line is closed, so that a board restarts at the first opening alone.
  /// @param baud  115200, 57600, 38400, 19200 or 9600
  /// @throws IoError, ConfigError for another baud
  static TextLink serial(const std::filesystem::path& device, int baud);

  /// @throws IoError when nobody listens there
  static TextLink tcp(const std::string& ipv4, int port, std::chrono::milliseconds within);

  ~TextLink();
  TextLink(TextLink&& other) noexcept;
  TextLink& operator=(TextLink&&) = delete;
  TextLink(const TextLink&) = delete;
  TextLink& operator=(const TextLink&) = delete;

  /// @throws IoError when the other side is gone
  void send(const std::string& text);

  /// The next line without its end, at most 1000 characters; empty: none within that time.
  /// @throws IoError when the other side is gone, or a line has no end
  std::optional<std::string> line(std::chrono::milliseconds within);

  bool is_serial() const { return is_serial_; }

 private:
  explicit TextLink(int descriptor) : descriptor_(descriptor) {}

  int descriptor_ = -1;
  bool is_serial_ = false;
  std::string received_;
};

}  // namespace glint
