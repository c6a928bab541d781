// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of many channels as OpenEXR, colour as PNG and TIFF. Files appear by rename and carry no
// time stamp: equal pixels give equal bytes.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/image/image_io.h"

namespace glint {

/// One channel of an OpenEXR file.
struct ExrChannel {
  std::string name;  ///< "R", "normal.x": what stands before the last dot is the layer
  /// Writes the values of one row of the picture, from left to right.
  std::function<void(int y, float* row)> fill;
};

/// A channel that shows an image, which must outlive it.
ExrChannel exr_channel(std::string name, const ImageF& image);

/// Writes 32-bit float channels of one picture. Rows are asked for as they are written, so that
/// channels need not exist as images.
/// @param channels  at least one; names differ
/// @throws IoError when the file cannot be written
void write_exr_channels(const std::filesystem::path& path,
                        int width_px,
                        int height_px,
                        std::span<const ExrChannel> channels);

/// Channels of an OpenEXR file.
/// @param names  as they are called in the file
/// @returns an image for each name @throws IoError when the file cannot be read, ConfigError when
/// it
///          holds no such channel
std::vector<ImageF> read_exr_channels(const std::filesystem::path& path,
                                      std::span<const std::string> names);

/// Red, green and blue of a picture of at least three channels as linear values (integers divided
/// by the largest code of their type); alpha is left out and changes nothing. Ask read_picture()
/// before whether it is a whole picture.
/// @throws IoError when it cannot be read, ConfigError when it has fewer colours
std::vector<ImageF> read_colours(const std::filesystem::path& path);

/// Writes linear values as TIFF of 16 bits, clamped to [0, 1].
/// @param channels  1 (grey) or 3 (red, green, blue) images of one size
/// @throws IoError
void write_tiff(const std::filesystem::path& path, std::span<const ImageF> channels);

/// Three linear images of one size as 8-bit colour, clamped to [0, 1]; one image becomes grey.
ImageRgb rgb_of(std::span<const ImageF> channels);

/// Writes 8-bit colour. @throws IoError
void write_png(const std::filesystem::path& path, const ImageRgb& image);

}  // namespace glint
