// SPDX-License-Identifier: GPL-3.0-or-later
//
// Why grey values of real pictures differ from simulated ones: exposure, power of segments and
// place of the light, roughness. Method: docs/validate.md.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/light_changes.h"

namespace glint {

/// A real picture and the scene that shows it, of equal size, one viewpoint.
struct GreyView {
  SceneSettings scene;
  ImageF real;  ///< linear, full scale 1
};

enum class GreyFault : std::size_t { kExposure, kSegments, kLightPlace, kRoughness };

inline constexpr std::size_t kGreyFaults = 4;

/// "exposure", "segment_power", "light_place", "roughness".
std::string name_of(GreyFault fault);

/// One number of the fit.
struct GreyValue {
  GreyFault fault = GreyFault::kExposure;
  std::string light;   ///< empty: of the whole picture
  int index = 0;       ///< of the segment, or of the axis x, y, z
  double value = 0.0;  ///< factor; of a place mm
  double sigma = 0.0;
};

struct GreyFit {
  bool is_known = false;          ///< false: too few pixels of the part, or no light
  std::vector<GreyFault> faults;  ///< that the pictures ask for; exposure is always free
  std::vector<GreyValue> values;  ///< of exposure and these
  SceneChange change;             ///< the same for scenes
  double before = 0.0;            ///< rms of even differences, share of the mean grey
  double exposed = 0.0;           ///< after the exposure alone
  double after = 0.0;             ///< after all
  int renders = 0;
};

struct GreyOptions {
  bool is_searching = true;   ///< false: exposure alone
  double good_share = 0.015;  ///< no further cause is looked for below that rms of even differences
  std::size_t max_views = 3;  ///< of a design that take part, spread over all
};

/// Fits all views of one design together in pictures reduced to some 96 pixels of width.
/// @throws ConfigError, IoError as rendering does
GreyFit fit_grey(SceneStore& store, std::span<const GreyView> views, const GreyOptions& options);

}  // namespace glint
