// SPDX-License-Identifier: GPL-3.0-or-later
//
// Streams of bytes into messages, however the network has cut or glued them. What is kept is never
// more than one message of the greatest length allowed; a longer one is refused when its length has
// been read, an endless line when it has grown too long.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"

namespace glint {

/// The peer does not speak the protocol. The connection is of no use any more.
class ProtocolError : public IoError {
 public:
  using IoError::IoError;
};

/// Frames of RTDE and of the primary interface: a length that counts itself, a kind, a payload.
class FrameSplitter {
 public:
  struct Frame {
    std::uint8_t kind = 0;
    std::string payload;
  };

  /// RTDE: uint16 length, uint8 kind; at most 65,535 bytes.
  static FrameSplitter of_rtde() { return {"RTDE", 2, 65535}; }

  /// Primary and secondary interface: int32 length, uint8 kind; at most max_bytes.
  static FrameSplitter of_primary(std::size_t max_bytes = 65536) {
    return {"primary interface", 4, max_bytes};
  }

  void append(std::string_view bytes);

  /// The next whole frame; none: more bytes are needed.
  /// @throws ProtocolError for a length below that of the head or above the greatest
  std::optional<Frame> next();

  std::size_t buffered_bytes() const { return buffer_.size() - begin_; }

 private:
  FrameSplitter(const char* name, std::size_t length_bytes, std::size_t max_bytes)
      : name_(name), length_bytes_(length_bytes), max_bytes_(max_bytes) {}

  const char* name_;
  std::size_t length_bytes_;
  std::size_t max_bytes_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of what is not read yet
};

/// Lines that end in a newline, returned without it and without a carriage return before it.
class LineSplitter {
 public:
  explicit LineSplitter(std::size_t max_bytes = 4096) : max_bytes_(max_bytes) {}

  void append(std::string_view bytes) { buffer_.append(bytes); }

  /// @throws ProtocolError when no newline came within max_bytes
  std::optional<std::string> next();

  std::size_t buffered_bytes() const { return buffer_.size(); }

 private:
  std::size_t max_bytes_;
  std::string buffer_;
};

}  // namespace glint
