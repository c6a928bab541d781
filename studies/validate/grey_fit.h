// SPDX-License-Identifier: GPL-3.0-or-later
//
// Why grey values of real pictures differ from simulated ones: exposure, power of segments and
// places of the lights, roughness. Method: docs/validate.md.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/light_changes.h"

namespace glint {

/// A design whose exposure rounding may change by a larger share cannot be judged.
inline constexpr double kMaxRounding = 0.5;

/// A real picture and the scene that shows it, of equal size, one viewpoint.
struct GreyView {
  SceneSettings scene;
  ImageF real;        ///< linear, full scale 1
  double step = 0.0;  ///< of the camera's grey values, full scale 1; 0: read off `real`
  int pose = -1;  ///< index of its view in GreyOptions::camera_covariance; -1: the pose is exact
};

/// The views of a design.
struct GreyDesign {
  std::string name;
  std::vector<GreyView> views;
};

/// kLightPower: of all lights of one design against those of the others.
enum class GreyFault : std::size_t { kExposure, kLightPower, kSegments, kLightPlace, kRoughness };

inline constexpr std::size_t kGreyFaults = 5;

/// "exposure", "light_power", "segment_power", "light_place", "roughness".
std::string name_of(GreyFault fault);

/// One number of the fit.
struct GreyValue {
  GreyFault fault = GreyFault::kExposure;
  std::string light;   ///< empty: of the whole picture; of kLightPower the design
  int index = 0;       ///< of the segment, or of the axis x, y, z
  double value = 0.0;  ///< factor; of a place mm
  double sigma = 0.0;
};

/// What is told of one design. Lights and roughness are those of the cell, so equal for all
/// designs.
struct GreyFit {
  bool is_known = false;  ///< false: too few pixels of the part, or no light
  bool is_exposure_only =
      false;             ///< nothing else is fitted, and `exposed` and `after` are not known
  bool is_thin = false;  ///< its part: most of it shows no even differences
  std::vector<GreyFault> faults;  ///< that the pictures ask for; exposure is always free
  std::vector<GreyValue> values;  ///< of exposure and these
  /// All others, as designed, with the sigma that they would have if they were free beside these;
  /// of each design those of all. Empty where no cause was looked for.
  std::vector<GreyValue> kept;
  SceneChange change;  ///< the same for scenes; exposure with the design's power
  double power = 1.0;  ///< of its lights against those of the other designs of the same fit
  double power_sigma = 0.0;
  bool is_joint = false;  ///< fitted together with other designs, which share its exposure
  double before = 0.0;    ///< rms of even differences, share of the mean grey
  double exposed = 0.0;   ///< after an exposure of its own alone
  double after = 0.0;     ///< after all
  double rounding = 0.0;  ///< largest share by which rounding may change its exposure when
                          ///< it is as bright as designed; infinite: it is black
  int renders = 0;        ///< of all designs
};

/// Standard deviation of `change.exposure`, by those of the fitted exposure and of the design's own
/// power; 0 where neither was fitted.
double sigma_of_exposure(const GreyFit& fit);

struct GreyOptions {
  /// Rms of even differences after the exposure up to which a design agrees: no cause is looked for
  /// when all do.
  double agree_share = 0.0;
  double good_share = 0.015;  ///< no further cause is looked for when all are below that
  std::size_t max_views = 3;  ///< of a design that take part, spread over all
  /// GeometryFit::covariance, which the sigmas of places and roughness then hold; empty: lens and
  /// poses are exact.
  Eigen::MatrixXd camera_covariance = {};
};

/// Fits all views of all designs together in pictures reduced to some 96 pixels of width: one
/// exposure, and lights that stand at one place, where they shine and where they shade others.
/// @return of each design
/// @throws ConfigError, IoError as rendering does
std::vector<GreyFit> fit_grey(SceneStore& store,
                              std::span<const GreyDesign> designs,
                              const GreyOptions& options);

}  // namespace glint
