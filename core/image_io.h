// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/image.h"

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

/// The PNG bytes of a linear grey image in 8 bits, for embedding in a report.
std::string png_bytes(const ImageF& image);

/// Standard base64 of any bytes.
std::string base64(const std::string& bytes);

/// The image reduced by an integer factor, each new pixel the mean of factor x factor old ones;
/// a remainder at the right and bottom is left out.
ImageF reduce(const ImageF& image, int factor);

}  // namespace glint
