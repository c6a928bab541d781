// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint acquire`: the arm goes over the views of a plan, a design or the cell's file, and takes
// their pictures into a folder (acquired.h).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hardware/light/light.h"
#include "hardware/planning/view_plan.h"
#include "hardware/robot/motion_permit.h"
#include "studies/acquire/confirmed_lights.h"
#include "studies/acquire/mounted_prototypes.h"
#include "studies/cell/cell_file.h"

namespace glint {

struct AcquireOptions {
  std::filesystem::path source;  ///< scene, plan.json or their folder; empty: the cell's views
  std::filesystem::path made_from = {};  ///< source that this one was copied from; empty: none
  std::filesystem::path cell;
  std::vector<CellPosition> views = {};  ///< in the place of the cell's own; empty: those
  std::optional<ViewPlan> plan = {};     ///< of these views; none: planned by their joints
  std::filesystem::path out;             ///< empty: out/<name>/acquire
  std::filesystem::path twin;            ///< ready file whose ports take the place of the cell's
  double speed_share = 0.5;              ///< of the cell's limits of speed
  std::vector<std::string> confirmed;    ///< manual lights that a person has set beforehand
  std::vector<std::string> mounted;      ///< designs whose prototypes a person has mounted
  Confirm confirm = {};                  ///< asks a person; empty: nobody is there
  /// What became of `confirmed` in earlier acquisitions of the same command; null: this is the
  /// only one.
  ConfirmedLights* lights = nullptr;
  const std::atomic<int>* interrupt = nullptr;
  /// Pictures that are there, of how many, and where; may be empty.
  std::function<void(int done, int total, const std::string& note)> progress = {};
};

/// What would be done. Reads files, connects to nothing.
nlohmann::ordered_json describe_acquisition(const AcquireOptions& options);

/// What "end" tells where a person was asked for something and nothing has been done: null, or,
/// with the "cause" "interrupted", that the user wanted it to end instead.
nlohmann::ordered_json interrupted_end(const AcquireOptions& options);

/// Takes what the folder does not have yet. A design whose lights may not be the ones that are
/// mounted waits for a person, who is asked, or has named it in options.mounted: nothing is
/// connected before. Nor is it where nobody is there to switch the manual lights that the first
/// picture needs, and options.confirmed does not name them; one that has to be switched later ends
/// the acquisition there.
/// @return what acquired.json holds, and "folder", "ok", "counts"; of a design that waits "status"
///         "waiting", "ok" false, and "next" with what is to be done as "text", and the "design",
///         or the "lights" that are to be switched and what options.confirmed then says of them as
///         "confirm"; "end" is then interrupted_end()
/// @throws NoViewTaken, ConfigError, IoError: before anything has moved
nlohmann::ordered_json acquire_pictures(const AcquireOptions& options, const MotionPermit& permit);

/// The same for one design of several. @param prototypes  what is mounted, and then was mounted;
///                                                       in the place of options.mounted
nlohmann::ordered_json acquire_pictures(const AcquireOptions& options,
                                        MountedPrototypes& prototypes,
                                        const MotionPermit& permit);

}  // namespace glint
