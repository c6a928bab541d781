// SPDX-License-Identifier: GPL-3.0-or-later
//
// The way of an arm over all its views: joints, one after the other, each leg between two of them a
// movej that was looked at beforehand. Where the arm is on it, and how it gets back.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hardware/robot/kinematics/denavit_hartenberg.h"

namespace glint {

struct TourPoint {
  std::string name;  ///< of a view or safe position; empty: on the way
  JointVector joints_rad = JointVector::Zero();
  bool is_safe = false;  ///< the arm may be left there
};

/// The first point is safe.
using Tour = std::vector<TourPoint>;

/// A place on a leg of a tour, or at a point.
struct TourPlace {
  std::size_t leg = 0;   ///< from point `leg` to the next one; of the last point: its own number
  bool is_point = true;  ///< at point `leg` itself
  double off_rad = 0.0;  ///< largest difference of a joint from the leg

  /// The next point on the way forwards, and back; at a point that point itself.
  std::size_t ahead() const { return is_point ? leg : leg + 1; }

  std::size_t behind() const { return leg; }
};

/// How far joints may be from a leg to count as on it.
inline constexpr double kOnTourRad = 2e-3;

/// Where joints lie on the tour; of several places the one that is the fewest points away from
/// `near`. Empty: nowhere.
std::optional<TourPlace> place_on(const Tour& tour,
                                  const JointVector& joints_rad,
                                  std::size_t near);

/// The smallest distance from any leg: of each leg the joint that is farthest off.
double distance_from_tour_rad(const Tour& tour, const JointVector& joints_rad);

/// Points to go to one after the other from a place, so that the last leg is the one that leads to
/// `goal` from before: an arm that comes from the same side stands at the same place.
std::vector<std::size_t> way_to(const TourPlace& place, std::size_t goal);

/// Points back to the nearest safe one along the way it came; empty: it is there.
std::vector<std::size_t> way_back(const Tour& tour, const TourPlace& place);

/// Points to the safe one that the fewest legs lead to, on or back; on, where these are as many.
/// Empty: it is there.
std::vector<std::size_t> way_to_safe_point(const Tour& tour, const TourPlace& place);

/// "home", "between left and right", "at point 3": for people.
std::string place_text(const Tour& tour, const TourPlace& place);

}  // namespace glint
