// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>

#include <Eigen/Core>

#include "core/image/image.h"

namespace glint {

/// Red, green and blue of a picture, or three times its grey value.
using TexturePicture = Image<std::array<float, 3>>;

/// What the numbers of a picture file mean.
enum class TextureEncoding {
  kAuto,   ///< integers of 8 bits are sRGB codes, everything else is linear
  kSrgb,   ///< IEC 61966-2-1, for values in [0, 1]
  kLinear  ///< integers divided by the largest code of their type
};

/// Reads any picture that OpenImageIO knows. Colour is the first three channels of three or more,
/// else the first one; alpha is left out.
/// @throws IoError when it cannot be read, ConfigError for values that are no factors in [0, 1]
TexturePicture read_texture_picture(const std::filesystem::path& path, TextureEncoding encoding);

/// Bilinear between the centres of pixels; the picture repeats in both directions.
/// @param place  in pictures: (0, 0) is the top left corner of one, (1, 1) its bottom right corner
Eigen::Array3d bilinear(const TexturePicture& picture, const Eigen::Vector2d& place);

}  // namespace glint
