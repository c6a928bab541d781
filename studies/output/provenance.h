// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// "0.1.0"
std::string program_version();

/// Version, compiler, instruction set and machine: what a result may depend on beside its input.
nlohmann::ordered_json provenance();

}  // namespace glint
