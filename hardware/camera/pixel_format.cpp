// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/pixel_format.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

enum class Layout { kByte, kTwoBytes, kThreeBytesForTwo, kBitStream };

struct FormatRow {
  PixelFormat format;
  std::string_view name;
  std::uint32_t number;  ///< mono, bits that a pixel takes, and a running number
  int bits;
  Layout layout;
};

constexpr std::array<FormatRow, 8> kRows = {{
    {PixelFormat::kMono8, "Mono8", 0x01080001, 8, Layout::kByte},
    {PixelFormat::kMono10, "Mono10", 0x01100003, 10, Layout::kTwoBytes},
    {PixelFormat::kMono12, "Mono12", 0x01100005, 12, Layout::kTwoBytes},
    {PixelFormat::kMono16, "Mono16", 0x01100007, 16, Layout::kTwoBytes},
    {PixelFormat::kMono10Packed, "Mono10Packed", 0x010c0004, 10, Layout::kThreeBytesForTwo},
    {PixelFormat::kMono12Packed, "Mono12Packed", 0x010c0006, 12, Layout::kThreeBytesForTwo},
    {PixelFormat::kMono10p, "Mono10p", 0x010a0046, 10, Layout::kBitStream},
    {PixelFormat::kMono12p, "Mono12p", 0x010c0047, 12, Layout::kBitStream},
}};

const FormatRow& row_of(PixelFormat format) {
  return kRows.at(static_cast<std::size_t>(format));
}

std::uint16_t code(unsigned value) {
  return static_cast<std::uint16_t>(value);
}

std::uint8_t byte(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xffU);
}

void unpack_two_bytes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) {
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = code(bytes[2 * i] | (static_cast<unsigned>(bytes[2 * i + 1]) << 8U));
  }
}

/// @param low_bits  of a value that lie in the byte between: 2 or 4
void unpack_three_bytes(std::span<const std::uint8_t> bytes,
                        unsigned low_bits,
                        std::span<std::uint16_t> codes) {
  const unsigned mask = (1U << low_bits) - 1U;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::size_t first = i / 2 * 3;
    const bool is_second = i % 2 == 1;
    const unsigned high = bytes[first + (is_second ? 2 : 0)];
    const unsigned low = (bytes[first + 1] >> (is_second ? 4U : 0U)) & mask;
    codes[i] = code((high << low_bits) | low);
  }
}

void unpack_bit_stream(std::span<const std::uint8_t> bytes,
                       unsigned bits,
                       std::span<std::uint16_t> codes) {
  std::uint32_t held = 0;
  unsigned num_held = 0;
  std::size_t next = 0;
  for (std::uint16_t& value : codes) {
    for (; num_held < bits; num_held += 8) {
      held |= static_cast<std::uint32_t>(bytes[next++]) << num_held;
    }
    value = code(held & ((1U << bits) - 1U));
    held >>= bits;
    num_held -= bits;
  }
}

void pack_three_bytes(std::span<const std::uint16_t> codes,
                      unsigned low_bits,
                      std::span<std::uint8_t> bytes) {
  const unsigned mask = (1U << low_bits) - 1U;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const std::size_t first = i / 2 * 3;
    const bool is_second = i % 2 == 1;
    bytes[first + (is_second ? 2 : 0)] = byte(static_cast<unsigned>(codes[i]) >> low_bits);
    bytes[first + 1] = byte(bytes[first + 1] | ((codes[i] & mask) << (is_second ? 4U : 0U)));
  }
}

void pack_bit_stream(std::span<const std::uint16_t> codes,
                     unsigned bits,
                     std::span<std::uint8_t> bytes) {
  std::uint32_t held = 0;
  unsigned num_held = 0;
  std::size_t next = 0;
  for (const std::uint16_t value : codes) {
    held |= static_cast<std::uint32_t>(value) << num_held;
    for (num_held += bits; num_held >= 8; num_held -= 8) {
      bytes[next++] = byte(held);
      held >>= 8U;
    }
  }
  if (num_held > 0) {
    bytes[next] = byte(held);
  }
}

/// @param bytes  as many as the codes need, or more
void unpack(std::span<const std::uint8_t> bytes,
            PixelFormat format,
            std::span<std::uint16_t> codes) {
  const auto bits = static_cast<unsigned>(bits_of(format));
  switch (row_of(format).layout) {
    case Layout::kByte:
      std::ranges::copy(bytes.first(codes.size()), codes.begin());
      break;
    case Layout::kTwoBytes:
      unpack_two_bytes(bytes, codes);
      break;
    case Layout::kThreeBytesForTwo:
      unpack_three_bytes(bytes, bits - 8, codes);
      break;
    case Layout::kBitStream:
      unpack_bit_stream(bytes, bits, codes);
      break;
  }
}

}  // namespace

std::string_view name_of(PixelFormat format) {
  return row_of(format).name;
}

std::uint32_t genicam_number(PixelFormat format) {
  return row_of(format).number;
}

std::optional<PixelFormat> pixel_format_of_number(std::uint32_t number) {
  const auto row = std::ranges::find(kRows, number, &FormatRow::number);
  return row == kRows.end() ? std::nullopt : std::optional(row->format);
}

int bits_of(PixelFormat format) {
  return row_of(format).bits;
}

std::size_t bytes_of(PixelFormat format, std::size_t num_pixels) {
  switch (row_of(format).layout) {
    case Layout::kByte:
      return num_pixels;
    case Layout::kTwoBytes:
      return 2 * num_pixels;
    case Layout::kThreeBytesForTwo:
      return (num_pixels + 1) / 2 * 3;
    case Layout::kBitStream:
      break;
  }
  return (num_pixels * static_cast<std::size_t>(bits_of(format)) + 7) / 8;
}

Image<std::uint16_t> unpacked(std::span<const std::uint8_t> bytes,
                              PixelFormat format,
                              int width_px,
                              int height_px) {
  auto image = Image<std::uint16_t>::uninitialized(width_px, height_px);
  const std::size_t wanted = bytes_of(format, image.size());
  if (bytes.size() < wanted) {
    throw ConfigError(fmt::format("a picture of {} x {} pixels in {} has {} bytes, must have {}",
                                  width_px,
                                  height_px,
                                  name_of(format),
                                  bytes.size(),
                                  wanted));
  }
  unpack(bytes, format, image.values());
  return image;
}

std::vector<std::uint8_t> packed(std::span<const std::uint16_t> codes, PixelFormat format) {
  std::vector<std::uint8_t> bytes(bytes_of(format, codes.size()));
  const auto bits = static_cast<unsigned>(bits_of(format));
  switch (row_of(format).layout) {
    case Layout::kByte:
      std::ranges::transform(codes, bytes.begin(), [](std::uint16_t value) { return byte(value); });
      break;
    case Layout::kTwoBytes:
      for (std::size_t i = 0; i < codes.size(); ++i) {
        bytes[2 * i] = byte(codes[i]);
        bytes[2 * i + 1] = byte(static_cast<unsigned>(codes[i]) >> 8U);
      }
      break;
    case Layout::kThreeBytesForTwo:
      pack_three_bytes(codes, bits - 8, bytes);
      break;
    case Layout::kBitStream:
      pack_bit_stream(codes, bits, bytes);
      break;
  }
  return bytes;
}

}  // namespace glint
