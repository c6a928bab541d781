// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace glint {

/// How a picture's file says that it is to be shown, which read_picture() leaves alone.
/// @return in [1, 8] as EXIF and TIFF number it: 1 as it is stored, or the file says nothing; from
///         5 on with rows and columns exchanged
/// @throws IoError when the file cannot be opened; ConfigError when it holds no picture
int picture_orientation(const std::filesystem::path& path);

}  // namespace glint
