// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// "0.1.0"
std::string program_version();

/// A moment without a place: "2026-11-23 08:10:05 UTC".
std::string utc_text(std::chrono::system_clock::time_point moment);

/// A time as a person says it: "8 s", "1 min 7 s", "2 h 5 min".
std::string duration_words(double seconds);

/// Date and duration for a page: "2026-11-23 08:10:05 UTC, 1 min 7 s".
std::string moment_text(const std::string& started, double seconds);

/// For people: version, compiler, instruction set, machine and libraries, on a few lines.
std::string version_text();

/// Version, compiler, instruction set, machine and libraries: what a result may depend on beside
/// its input.
nlohmann::ordered_json provenance();

}  // namespace glint
