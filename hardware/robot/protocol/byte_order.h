// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers as the controller sends them: big endian, without gaps.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace glint {

/// Appends numbers to a message.
class ByteWriter {
 public:
  template <std::integral Number>
  void put(Number value) {
    using Bits = std::make_unsigned_t<Number>;
    for (int shift = 8 * (static_cast<int>(sizeof(Bits)) - 1); shift >= 0; shift -= 8) {
      bytes_.push_back(static_cast<char>((static_cast<Bits>(value) >> shift) & 0xff));
    }
  }

  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }

  void put(std::string_view text) { bytes_.append(text); }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Takes numbers from a message. Beyond its end every number is 0, and is_short() says so.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <std::integral Number>
  Number take() {
    using Bits = std::make_unsigned_t<Number>;
    if (bytes_.size() < sizeof(Bits)) {
      is_short_ = true;
      bytes_ = {};
      return Number{};
    }
    Bits bits = 0;
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
      bits = static_cast<Bits>((std::uint64_t{bits} << 8) | static_cast<std::uint8_t>(bytes_[i]));
    }
    bytes_.remove_prefix(sizeof(Bits));
    return static_cast<Number>(bits);
  }

  double take_double() { return std::bit_cast<double>(take<std::uint64_t>()); }

  /// At most so many bytes; fewer where the message ends.
  std::string_view take_text(std::size_t length) {
    is_short_ = is_short_ || length > bytes_.size();
    const std::string_view text = bytes_.substr(0, length);
    bytes_.remove_prefix(text.size());
    return text;
  }

  std::string_view rest() const { return bytes_; }

  bool is_short() const { return is_short_; }

  /// All was taken, and no more.
  bool is_exact() const { return !is_short_ && bytes_.empty(); }

 private:
  std::string_view bytes_;
  bool is_short_ = false;
};

}  // namespace glint
