// SPDX-License-Identifier: GPL-3.0-or-later
//
// Moves an arm along the legs of a tour, and nowhere else. After anything that the arm itself does
// not do as told it moves no more.
#pragma once

#include <functional>
#include <string>

#include "hardware/acquisition/tour.h"
#include "hardware/robot/robot.h"

namespace glint {

/// The arm did not do what it was told, or is where it must not be moved from.
struct ArmFailure {
  std::string text;
  bool is_off_tour = false;
};

class ArmGuide {
 public:
  /// @param tour, robot  outlive the guide
  ArmGuide(const Tour& tour, Robot& robot, double speed_share)
      : tour_(tour), robot_(robot), speed_share_(speed_share) {}

  /// Waits until the arm stands still, and finds it on the tour. @throws ArmFailure
  /// @param near  of several points at the same place the one that is nearest to this one
  void find_place(std::size_t near = 0);

  /// Points to go to for a view's. @throws ArmFailure when the place is not known
  std::vector<std::size_t> way(std::size_t goal) const;

  /// One leg, from a point beside it or from the leg itself. @throws ArmFailure; the guide moves
  /// nothing any more then
  void go(std::size_t point);

  /// To the tour's last point where that is safe; else back.
  /// @param before_each  is called before each leg, and may throw
  void go_to_end(const std::function<void()>& before_each);

  /// To the safe point that the fewest legs lead to, on or back; from a safe one nowhere.
  /// @param before_each  as above
  void go_to_safe_point(const std::function<void()>& before_each);

  bool is_at_end() const;

  /// To the nearest safe point along the way the arm came: only with a safety mode that is normal,
  /// and from a place on the tour. @throws ArmFailure when it did not get there
  void back_out();

  /// The standstill at the point that the arm was sent to last.
  /// @throws ArmFailure when the arm does not come to rest, or rests elsewhere
  StillPose still_at_point(double timeout_s);

  /// @throws ArmFailure when it has moved from that pose, or was stopped, if only for a moment, or
  ///         is not ready any more: without power, guided by hand, by another program
  void check_still(const StillPose& pose) const;

  /// For people.
  std::string place() const;

 private:
  StillPose still(double timeout_s);
  RobotState fresh_state() const;
  void normal_state() const;

  const Tour& tour_;
  Robot& robot_;
  double speed_share_;
  std::optional<TourPlace> place_;
  std::size_t last_point_ = 0;  ///< that the arm was sent to
  bool has_failed_ = false;
};

}  // namespace glint
