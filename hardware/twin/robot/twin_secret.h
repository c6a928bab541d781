// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

namespace glint {

/// A random number of the system that is not 0. @throws IoError when there is none
std::uint64_t fresh_token();

/// Makes a folder that only this user may enter, or finds it.
/// @throws IoError when it is somebody else's, or open to others
void make_private_folder(const std::filesystem::path& folder);

}  // namespace glint
