// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace glint {

/// How a picture's file says that it is to be shown, which read_picture() leaves alone.
/// @return in [1, 8] as EXIF and TIFF number it; 1: as it is stored, from 5 on with rows and
/// columns
///         exchanged; 1, too, where the file says nothing
/// @throws as read_picture() of a file that is no picture
int picture_orientation(const std::filesystem::path& path);

}  // namespace glint
