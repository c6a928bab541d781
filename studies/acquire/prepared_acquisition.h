// SPDX-License-Identifier: GPL-3.0-or-later
//
// What an acquisition reads before it connects to anything, and what its folder has already.
// Private to the room.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "studies/acquire/acquire_plan.h"
#include "studies/acquire/acquire_run.h"
#include "studies/acquire/acquired.h"

namespace glint::acquire_detail {

/// Everything that is read before anything is connected.
struct Prepared {
  Cell cell;
  AcquireSource source;
  AcquireWork work;
  std::filesystem::path folder;
  std::string digest;  ///< digest_in() the folder
};

/// @throws NoViewTaken, ConfigError, IoError
Prepared prepare(const AcquireOptions& options);

/// Whether one of these pictures is the accepted one of a task at a position of the stage.
bool has_picture(const std::vector<AcquiredPicture>& pictures, const ViewTask& task, int position);

/// The first view in the order of the tour of which pictures are still to be taken; null: of none.
const ViewTask* next_task(const Prepared& ready);

/// Every picture that is wanted is there, as it was taken.
bool is_whole(const Prepared& ready);

/// What a folder tells in which nothing is missing: nobody has to move for it. Empty: something is,
/// or it was cut short before it could tell.
std::optional<nlohmann::ordered_json> nothing_to_take(const Prepared& ready);

}  // namespace glint::acquire_detail
