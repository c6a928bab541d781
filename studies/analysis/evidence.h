// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether a model of a run may be believed, and how many designs it lacks.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace glint {

/// What leave-one-out has to explain of the variance at least.
inline constexpr double kNeededQ2 = 0.7;

struct Evidence {
  double q2 = 0.0;
  bool is_covered = false;   ///< the points leave no large part of the box empty
  bool is_constant = false;  ///< all points have the same value: nothing to explain
  int points = 0;
  int wanted = 0;  ///< further space-filling designs; 0 where the evidence is enough

  bool is_enough() const { return is_covered && q2 >= kNeededQ2; }

  /// Why it is not enough; empty when it is.
  std::string reason() const;
};

/// Mean distance from places all over the unit cube to their nearest point, about 0.5 sqrt(d) for
/// a single one; infinite without points.
/// @param points  any number, of the same dimension >= 1
double emptiness(std::span<const std::vector<double>> points, int dimension);

/// Points cover the box where its emptiness is at most 1.1 times that of max(10, 5 d) points of a
/// Sobol sequence. No q2 (all values are
/// the same) is not enough. Wanted are: as many more points of such a sequence as it takes to cover
/// the box, and where q2 is too small as many as there are, 10 d in all at least.
/// @param points     in the unit cube
/// @param dimension  >= 0; a box without dimensions is covered by one point
Evidence evidence_of(std::optional<double> q2,
                     std::span<const std::vector<double>> points,
                     int dimension);

}  // namespace glint
