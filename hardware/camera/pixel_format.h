// SPDX-License-Identifier: GPL-3.0-or-later
//
// How grey values lie in the bytes that a camera sends: one or two bytes each, or packed. All
// functions are pure.
//
//   kMono8          8 bits in a byte
//   kMono10 kMono12 kMono16   in two bytes, the lower one first
//   kMono10Packed kMono12Packed   GigE Vision's own: two values in three bytes; the first byte
//   holds
//                   the upper 8 bits of the first value, the third byte those of the second, and
//                   the byte between them the lower bits, of the first value in its lower half
//   kMono10p kMono12p   GenICam's: values follow each other without gaps, each from its lowest bit,
//                   bytes are filled from their lowest bit
//
// Source: GenICam Pixel Format Naming Convention (PFNC) 2.x; GigE Vision's packed formats as Aravis
// numbers them. The tests work each layout by hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/image.h"

namespace glint {

enum class PixelFormat {
  kMono8,
  kMono10,
  kMono12,
  kMono16,
  kMono10Packed,
  kMono12Packed,
  kMono10p,
  kMono12p
};

inline constexpr std::array<PixelFormat, 8> kPixelFormats = {PixelFormat::kMono8,
                                                             PixelFormat::kMono10,
                                                             PixelFormat::kMono12,
                                                             PixelFormat::kMono16,
                                                             PixelFormat::kMono10Packed,
                                                             PixelFormat::kMono12Packed,
                                                             PixelFormat::kMono10p,
                                                             PixelFormat::kMono12p};

/// As GenICam and the cell file spell it: "Mono8", "Mono12Packed", "Mono12p".
std::string_view name_of(PixelFormat format);

/// GenICam's number of the format, as it stands in the leader of a stream.
std::uint32_t genicam_number(PixelFormat format);

/// Empty for a format that is none of ours.
std::optional<PixelFormat> pixel_format_of_number(std::uint32_t number);

/// Of a value: 8, 10, 12 or 16. The largest code is 2^bits - 1.
int bits_of(PixelFormat format);

/// Of a picture without padding of its rows; the last byte may be partly unused.
std::size_t bytes_of(PixelFormat format, std::size_t num_pixels);

/// The codes of a picture.
/// @param bytes  at least bytes_of(format, width * height); more is left alone
/// @throws ConfigError when there are fewer
Image<std::uint16_t> unpacked(std::span<const std::uint8_t> bytes,
                              PixelFormat format,
                              int width_px,
                              int height_px);

/// The inverse: bytes of codes, which must not be larger than the format's largest.
std::vector<std::uint8_t> packed(std::span<const std::uint16_t> codes, PixelFormat format);

}  // namespace glint
