// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores of a scan in double, from the rays on: what derivatives are compared with. The program
// computes in float, whose rounding drowns the difference of two scores over a step as short as the
// ripple of few frames needs. Written anew where the program has fast forms: walls are met exactly,
// every cell is integrated over its polygon, and the mean is the mean of all frames.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "simulator/render/scan/closed_scan.h"
#include "tests/studies/evaluation/exact_frames.h"
#include "tests/studies/imaging/exact_wall.h"

namespace glint {

/// h_rms, mean and min_cnr.
using ExactValues = std::array<double, 3>;

/// Scores near a scene, with hits that are the program's there and move exactly from there. Held
/// are which grey values clip (the derivative at the scene is that of the branch it lies on, and a
/// step across the bend would mix two), which pixels are made how, the region, the defects' pixels,
/// and what single places of cells see that are not smooth.
class ExactScores {
 public:
  /// @param traced, footprints, plan  of this scene; must outlive this object
  ExactScores(const SceneSettings& scene,
              const TracedScene& traced,
              const Footprints& footprints,
              const ScanPlan& plan,
              double sigma_floor);

  ExactValues at(const SceneSettings& scene, const ExactPicture& picture) const;

  /// The aspect image behind them, row by row.
  std::vector<double> aspect_of(const SceneSettings& scene, const ExactPicture& picture) const;

  /// How near a grey value of a frame is to where it clips, as a share of full scale.
  double clearance(const SceneSettings& scene, const ExactPicture& picture) const;

 private:
  template <class Use>
  void for_each_grey(const SceneSettings& scene, const ExactPicture& picture, const Use& use) const;
  ExactValues scores_of(const std::vector<double>& aspect) const;

  const TracedScene& traced_;
  const ScanPlan& plan_;
  double sigma_floor_;
  HitErrors errors_;
  Mask wanted_;                             ///< pixels whose frames are needed
  Mask rendered_;                           ///< and what blurs into them
  std::vector<std::vector<double>> held_;   ///< radiance of single places, frame by frame
  std::vector<std::vector<char>> is_full_;  ///< pixels that clip, frame by frame
};

}  // namespace glint
