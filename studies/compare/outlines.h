// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the part is in both pictures of a comparison.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/image/image.h"
#include "metrics/overlap/boundary.h"
#include "metrics/overlap/outline_motion.h"
#include "studies/compare/compared_picture.h"

namespace glint {

/// How the part was found.
enum class OutlineMethod {
  kMask,       ///< a mask was given
  kTruth,      ///< the simulated picture's own coverage
  kThreshold,  ///< brighter than the background
  kGrabCut,    ///< by a cut around where the simulation says it is
  kGuided,     ///< by either of the two, edges looked for along the simulated outline
  kInner       ///< not at all: edges inside the pictures serve
};

std::string name_of(OutlineMethod method);

/// The part's outline in a picture.
struct PartOutline {
  OutlineMethod method = OutlineMethod::kInner;
  std::vector<Boundary> rough;    ///< closed outlines, or edges inside the picture
  std::vector<Boundary> located;  ///< at the edges by grey values, broken where there are none
  ImageF coverage;                ///< of the refined outline; empty for kInner
};

inline constexpr double kMostlyShown = 0.6;  ///< OutlinePair::shown from which motions are sure

struct OutlinePair {
  PartOutline simulated;
  PartOutline real;
  /// Of the simulated outline onto the real one, where the latter was found along it, and which
  /// share of the simulated outline's edges the real picture has there.
  std::optional<OutlineMotion> motion = {};
  double shown = 0.0;
  std::vector<std::string> notes;
};

/// From the middle of the simulated region to that of the real one; 0 where there are not both.
Eigen::Vector2d middle_shift_px(const OutlinePair& outlines);

/// What the user allows.
enum class OutlineChoice { kAuto, kThreshold, kGrabCut, kInner };

/// "auto", "threshold", "grab_cut", "inner". @throws ConfigError for anything else
OutlineChoice outline_choice(const std::string& name);

/// Outlines of both pictures, found alike, so that what finding them does to both cancels:
/// segmented at up to a quarter of the size, refined at the edges. Where the renderer knows the
/// part's outline and no method is chosen, edges and regions are those along it.
/// @param real_mask  bright where the real part is; empty: to be found
/// @throws ConfigError where a mask, given or the renderer's, has another size than the pictures,
/// or where what was chosen cannot be done
OutlinePair find_outlines(const ComparedPicture& simulated,
                          const ComparedPicture& real,
                          const std::filesystem::path& real_mask,
                          OutlineChoice choice);

}  // namespace glint
