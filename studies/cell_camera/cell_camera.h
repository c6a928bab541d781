// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint cell` does with the camera of a cell. Each function returns the object that --json
// prints; "ok" tells whether the program ends with exit code 0 or 1. None of them moves anything.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hardware/camera/camera.h"
#include "studies/cell/cell_file.h"

namespace glint {

/// All cameras that answer; which of them are twins is what their side channels prove.
nlohmann::ordered_json list_cameras();

/// Whether the camera at this address is a twin of Glint: its side channel, which only this user
/// can have opened, tells the token that the camera itself tells where no user can write.
bool is_camera_twin(const std::string& address, const std::string& manufacturer_info);

/// In a cell of twins the camera has to prove that it is the one of the ready file, before it is
/// opened; in others nobody is asked.
/// @throws IoError when it does not; ConfigError when the cell has no camera
void check_camera_twin(const Cell& cell);

/// What the cell file says about pictures. @throws ConfigError for a region that is none
CameraConfiguration camera_configuration_of(const CellCamera& camera);

/// The cell's camera, opened: by its address, or by its id, or the only one that answers.
/// @throws ConfigError when several answer and the cell does not say which, IoError
std::unique_ptr<Camera> open_camera_of(const CellCamera& camera);

struct GrabOptions {
  int count = 1;              ///< >= 1
  std::filesystem::path out;  ///< empty: out/<name of the cell>/grab
  double reopen_s = 20.0;     ///< for a camera that is lost
};

/// Takes pictures and writes them as PNG (8 bits from 8-bit cameras, else 16 bits: code / largest
/// code x 65535) with frames.csv. A picture that does not come is named there and in the result.
/// @param told  each frame as it comes; may be empty
/// @throws ConfigError before anything is connected to, when the folder holds pictures of an
///         earlier call, or somebody else's files
nlohmann::ordered_json grab_pictures(const Cell& cell,
                                     const GrabOptions& options,
                                     const std::function<void(int, const Frame&)>& told = {});

}  // namespace glint
