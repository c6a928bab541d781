// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reads IES LM-63 files (1986 to 2019), type C.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "simulator/light/area/ies_table.h"

namespace glint {

/// @throws ConfigError with file:line:column: damaged, photometry of type A or B, TILT in another
/// file, angles that no symmetry allows
IesTable parse_ies(std::string_view text, const std::string& file);

/// @throws IoError, ConfigError
IesTable read_ies(const std::filesystem::path& path);

}  // namespace glint
