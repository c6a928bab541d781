// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>

#include "core/image/image.h"

namespace glint {

/// How a linear grey value is stored in an integer file: 1.0 becomes the largest code.
enum class PixelDepth { k8Bit, k16Bit };

/// Writes a linear grey image as PNG (values clamped to [0, 1]); the file appears by rename and
/// carries no time stamp, so equal images give equal bytes.
/// @throws IoError when the file cannot be written.
void write_png(const std::filesystem::path& path, const ImageF& image, PixelDepth depth);

/// Writes a mask as an 8-bit PNG, 255 inside and 0 outside. @throws IoError
void write_mask_png(const std::filesystem::path& path, const Mask& mask);

/// Writes a linear grey image as 32-bit float OpenEXR. @throws IoError
void write_exr(const std::filesystem::path& path, const ImageF& image);

/// Reads the first channel of any picture OpenImageIO knows, as linear values (integers divided by
/// the largest code of their type). @throws IoError when it cannot be read or holds no pixel.
ImageF read_image(const std::filesystem::path& path);

/// The values of a picture as its file holds them.
using Pixels = std::variant<Image<std::uint8_t>, Image<std::uint16_t>, ImageF>;

/// A picture somebody else made, as one channel.
struct Picture {
  /// Codes of 8 or 16 bits where the file is grey and has these; else linear values, integers
  /// divided by the largest code of their type. Colour is reduced to luminance (0.2126 R + 0.7152 G
  /// + 0.0722 B of the values as they stand in the file); alpha is left out.
  Pixels pixels;
  int bits = 8;           ///< of the file's values: 8, 16 or 32
  bool is_float = false;  ///< the file's values are; they may be no finite numbers
  int channels = 1;       ///< in the file, without alpha
  bool has_more = false;  ///< the file holds further pictures, of which none is read

  int width() const {
    return std::visit([](const auto& image) { return image.width(); }, pixels);
  }

  int height() const {
    return std::visit([](const auto& image) { return image.height(); }, pixels);
  }
};

/// No picture may have more pixels.
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

/// Reads PNG, JPEG, TIFF, PNM or OpenEXR, told apart by their first bytes.
/// @throws IoError when the file cannot be read, ConfigError when it is no whole picture
Picture read_picture(const std::filesystem::path& path);

/// As linear values: codes divided by the largest one.
ImageF linear_values(const Pixels& pixels);

/// Red, green and blue.
using ImageRgb = Image<std::array<std::uint8_t, 3>>;

/// The PNG bytes of a linear grey image in 8 bits, for embedding in a report.
std::string png_bytes(const ImageF& image);
std::string png_bytes(const ImageRgb& image);

/// Standard base64 of any bytes.
std::string base64(const std::string& bytes);

/// The image reduced by an integer factor, each new pixel the mean of factor x factor old ones;
/// a remainder at the right and bottom is left out.
ImageF reduce(const ImageF& image, int factor);

}  // namespace glint
