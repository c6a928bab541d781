// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "core/image/image.h"

namespace glint::test {

inline void append_little_endian(std::uint32_t value, int bytes, std::string& text) {
  for (int i = 0; i < bytes; ++i) {
    text += static_cast<char>(value >> (8 * i) & 0xffU);
  }
}

/// The bytes of a grey TIFF of 8 bits whose tag 274 says how it is to be shown (TIFF 6.0, p. 36).
/// @param orientation  in [1, 8]
inline std::string oriented_tiff(const Image<std::uint8_t>& picture, std::uint32_t orientation) {
  const auto width = static_cast<std::uint32_t>(picture.width());
  const auto height = static_cast<std::uint32_t>(picture.height());
  constexpr std::uint32_t kFirstPixel = 8 + 2 + 10 * 12 + 4;
  const std::array<std::pair<std::uint32_t, std::uint32_t>, 10> tags = {{{256, width},
                                                                         {257, height},
                                                                         {258, 8},
                                                                         {259, 1},
                                                                         {262, 1},
                                                                         {273, kFirstPixel},
                                                                         {274, orientation},
                                                                         {277, 1},
                                                                         {278, height},
                                                                         {279, width * height}}};
  std::string text("II*\0\x08\0\0\0", 8);
  append_little_endian(tags.size(), 2, text);
  for (const auto& [tag, value] : tags) {
    const bool is_short = tag == 274 || tag == 258 || tag == 259 || tag == 262 || tag == 277;
    append_little_endian(tag, 2, text);
    append_little_endian(is_short ? 3 : 4, 2, text);  // SHORT or LONG
    append_little_endian(1, 4, text);
    append_little_endian(value, 4, text);
  }
  append_little_endian(0, 4, text);
  for (const std::uint8_t code : picture.values()) {
    text += static_cast<char>(code);
  }
  return text;
}

}  // namespace glint::test
