// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of `glint calibrate --sensor`: one HTML file that needs no network.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hardware/photon_transfer/photon_transfer.h"

namespace glint {

/// @param result  what sensor.json holds
/// @param toml    the table [sensor]
std::string sensor_page(const nlohmann::ordered_json& result,
                        std::span<const LevelStatistics> levels,
                        const PhotonTransfer& transfer,
                        const std::string& toml,
                        const std::string& when);

}  // namespace glint
