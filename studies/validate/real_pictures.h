// SPDX-License-Identifier: GPL-3.0-or-later
//
// The real side of a validation: pictures of each design, with what is known of the poses they were
// taken at.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image/image.h"
#include "core/pose.h"

namespace glint {

/// A folder that is as it should be, but has no picture that can be compared: all were rejected, or
/// no scan is whole.
class NoWholeView : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

/// A picture of one view.
struct RealView {
  std::string name;  ///< of the view: "view_03"
  std::filesystem::path picture;
  std::filesystem::path frame = {};  ///< as the camera recorded it, where the picture is the mean
                                     ///< of several; empty: the picture itself
  std::optional<RigidTransform> base_from_flange = {};  ///< as the robot told it
  double position_sigma_mm = 0.0;                       ///< of that; 0: not told
  double rotation_sigma_rad = 0.0;
};

struct RealDesign {
  std::string name;
  std::filesystem::path folder;
  std::filesystem::path calibration =
      {};  ///< calibration.toml that they were taken by; empty: none
  bool is_of_twin = false;
  bool is_by_render = false;       ///< views of `glint render`, at sensor.exposure in any case
  std::vector<RealView> views;     ///< at least one
  std::vector<std::string> notes;  ///< what was left out
};

/// The step of a camera's grey values, full scale 1: that of the recorded picture; a black one does
/// not show it, and the sensor tells it. @param bits  of the scene's sensor; 0: 8 are taken
double camera_step(const ImageF& recorded, int bits);

/// camera_step() of a view: off its first frame, as a mean of several is rounded to finer steps
/// than each of them was. @param real  its picture @throws IoError where the frame cannot be read
double camera_step(const RealView& view, const ImageF& real, int bits);

/// Reads a folder of pictures: what `glint acquire` has written (acquired.json), or pictures and
/// rendered views that carry the names of the design's views.
/// @throws NoWholeView; ConfigError for a folder without pictures, or an acquired.json that is
/// none;
///         IoError
RealDesign read_real_design(const std::string& name, const std::filesystem::path& folder);

}  // namespace glint
