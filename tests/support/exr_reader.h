// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/image/image.h"

namespace glint::test {

/// All channels of a picture by name, as OpenImageIO reads them: integers over their largest code.
/// @throws IoError
std::map<std::string, ImageF> channels_of(const std::filesystem::path& path);

}  // namespace glint::test
