// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/nearest_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/units.h"

namespace glint {
namespace {

/// Back along the axis, nearer where negative (mm), roll, tilts about x and y (rad).
struct Offset {
  double back_mm = 0.0;
  double roll_rad = 0.0;
  double tilt_x_rad = 0.0;
  double tilt_y_rad = 0.0;

  Offset scaled(double share) const {
    return {share * back_mm, share * roll_rad, share * tilt_x_rad, share * tilt_y_rad};
  }

  double size_mm(double target_mm) const {
    constexpr double kRollMmPerRad = 0.2 * kDegPerRad;
    return std::hypot(
        back_mm, target_mm * std::hypot(tilt_x_rad, tilt_y_rad), kRollMmPerRad * roll_rad);
  }
};

Eigen::Isometry3d moved(const Eigen::Isometry3d& base_from_camera,
                        double target_mm,
                        const Offset& offset) {
  const Eigen::Vector3d target(0.0, 0.0, target_mm);
  return base_from_camera * Eigen::Translation3d(target) *
         Eigen::AngleAxisd(offset.tilt_x_rad, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(offset.tilt_y_rad, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(offset.roll_rad, Eigen::Vector3d::UnitZ()) *
         Eigen::Translation3d(-target - Eigen::Vector3d(0.0, 0.0, offset.back_mm));
}

std::vector<Offset> grid_of(double target_mm) {
  constexpr std::array<double, 28> kBackMm = {
      0,   5,   -5,   10,  -10,  20,  -20,  30,  -30,  45,   -45,  60,   -60,  80,
      -80, 100, -100, 130, -130, 160, -160, 200, -200, -260, -340, -440, -570, -740};
  constexpr double kNearest = 0.2;  // of target_mm: no nearer than that
  constexpr std::array<double, 13> kRollDeg = {
      0, -15, 15, -30, 30, -60, 60, -90, 90, -120, 120, -150, 180};
  constexpr std::array<double, 7> kTiltDeg = {0, -10, 10, -20, 20, -30, 30};
  std::vector<Offset> offsets;
  for (const double back_mm : kBackMm) {
    if (target_mm + back_mm < kNearest * target_mm) {
      continue;
    }
    for (const double roll_deg : kRollDeg) {
      for (const double x_deg : kTiltDeg) {
        for (const double y_deg : kTiltDeg) {
          const int parts = (back_mm != 0.0 ? 1 : 0) + (roll_deg != 0.0 ? 1 : 0) +
                            (x_deg != 0.0 || y_deg != 0.0 ? 1 : 0);
          if (parts == 1 || parts == 2) {
            offsets.push_back(
                {back_mm, roll_deg * kRadPerDeg, x_deg * kRadPerDeg, y_deg * kRadPerDeg});
          }
        }
      }
    }
  }
  std::ranges::stable_sort(
      offsets, {}, [target_mm](const Offset& offset) { return offset.size_mm(target_mm); });
  return offsets;
}

}  // namespace

std::optional<Eigen::Isometry3d> nearest_view(
    const Eigen::Isometry3d& base_from_camera,
    double target_mm,
    const std::function<bool(const Eigen::Isometry3d&)>& can_be_taken) {
  constexpr int kHalvings = 5;
  for (const Offset& offset : grid_of(target_mm)) {
    Eigen::Isometry3d found = moved(base_from_camera, target_mm, offset);
    if (!can_be_taken(found)) {
      continue;
    }
    double taken = 1.0;
    double refused = 0.0;
    for (int i = 0; i < kHalvings; ++i) {
      const double share = 0.5 * (taken + refused);
      const Eigen::Isometry3d pose = moved(base_from_camera, target_mm, offset.scaled(share));
      (can_be_taken(pose) ? taken : refused) = share;
    }
    return moved(base_from_camera, target_mm, offset.scaled(taken));
  }
  return std::nullopt;
}

}  // namespace glint
