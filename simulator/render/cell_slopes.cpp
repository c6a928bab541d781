// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/cell_slopes.h"

#include <algorithm>

#include "simulator/render/slope_kernels.h"

namespace glint {
namespace {

/// Labels of what cuts a cell.
constexpr int kRim = 0;
constexpr int kLeftOfSlot = 3;
constexpr int kRightOfSlot = 4;

void add(std::array<double, 4>& to, const LinearSlopes& slopes, double factor) {
  const std::array<double, 4> by_corners = slopes.by_corners();
  for (std::size_t i = 0; i < 4; ++i) {
    to[i] += factor * by_corners[i];
  }
}

}  // namespace

CellSlopes::CellSlopes(const ScanPositions& positions) : p_(positions) {}

CornerSlopes CellSlopes::of_smooth(const CellCorners& corners,
                                   double share,
                                   const std::vector<double>& by_radiance) {
  const auto [x_low, x_high] = std::ranges::minmax(corners.x_mm);
  const bool is_inside = x_low - p_.shift_mm.back() > -p_.half_length_mm &&
                         x_high - p_.shift_mm.front() < p_.half_length_mm;
  if (!is_inside || std::ranges::min(corners.margin_mm) < -1e20) {
    has_held = true;
    return {};
  }
  weights_ = by_radiance;
  for (double& weight : weights_) {
    weight *= share * corners.mean_gain();
  }
  const LinearFunction x = linear_through(corners.stripes_mm);
  const LinearFunction phase = {.value = (x.value - p_.offset_mm) / p_.period_mm,
                                .dx = x.dx / p_.period_mm,
                                .dy = x.dy / p_.period_mm};
  const auto [y_low, y_high] = std::ranges::minmax(corners.y_mm);
  const auto [v_low, v_high] = std::ranges::minmax(corners.stripes_mm);
  const bool is_plain = std::ranges::min(corners.margin_mm) >= 0.0 &&
                        (y_low >= p_.half_slot_mm || y_high <= -p_.half_slot_mm) &&
                        v_high - v_low <= 2.0 * std::min(p_.duty, 1.0 - p_.duty) * p_.period_mm;
  return is_plain ? of_plain(phase) : of_boundary(corners, phase);
}

void CellSlopes::add_stripes(const LinearFunction& phase,
                             const LinearSlopes& by_phase,
                             CornerSlopes& slopes) {
  add(slopes.x, by_phase, 1.0 / p_.period_mm);
  period_mm -= (by_phase.value * phase.value + by_phase.dx * phase.dx + by_phase.dy * phase.dy) /
               p_.period_mm;
}

CornerSlopes CellSlopes::of_plain(const LinearFunction& phase) {
  const auto v = static_cast<float>(phase.value);
  const auto gx = static_cast<float>(phase.dx);
  const auto gy = static_cast<float>(phase.dy);
  float by_v = 0.0F, by_gx = 0.0F, by_gy = 0.0F, by_duty = 0.0F, share = 0.0F, weight = 0.0F;
  const slope_kernels::BoxSlopes sums = {
      .v = &by_v, .gx = &by_gx, .gy = &by_gy, .duty = &by_duty, .share = &share, .weight = &weight};
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    const auto w = static_cast<float>(weights_[k]);
    slope_kernels::add_box_slopes(&v,
                                  &gx,
                                  &gy,
                                  &w,
                                  1,
                                  static_cast<float>(p_.shift_periods[k]),
                                  static_cast<float>(p_.duty),
                                  sums);
  }
  const double bright = 1.0 - p_.dark;
  CornerSlopes slopes;
  add_stripes(phase,
              {.value = bright * static_cast<double>(by_v),
               .dx = bright * static_cast<double>(by_gx),
               .dy = bright * static_cast<double>(by_gy)},
              slopes);
  duty += bright * static_cast<double>(by_duty);
  dark += static_cast<double>(weight) - static_cast<double>(share);
  return slopes;
}

CornerSlopes CellSlopes::of_boundary(const CellCorners& corners, const LinearFunction& phase) {
  std::array<LinearFunction, 5> boundaries;
  const LinearFunction y = linear_through(corners.y_mm);
  boundaries[kRim] = linear_through(corners.margin_mm);
  boundaries[kLeftOfSlot] = {.value = -p_.half_slot_mm - y.value, .dx = -y.dx, .dy = -y.dy};
  boundaries[kRightOfSlot] = {.value = y.value - p_.half_slot_mm, .dx = y.dx, .dy = y.dy};
  StripeSlopes sums;
  const auto integrate = [&](const PixelPolygon& polygon) {
    sums.add(
        polygon, phase, boundaries, p_.shift_periods, weights_, p_.duty, p_.dark, 1.0 - p_.dark);
  };
  PixelPolygon wall;
  wall.clip(boundaries[kRim], kRim);
  const auto [low, high] = std::ranges::minmax(corners.y_mm);
  if (low >= p_.half_slot_mm || high <= -p_.half_slot_mm) {
    integrate(wall);
  } else {
    PixelPolygon left = wall;
    left.clip(boundaries[kLeftOfSlot], kLeftOfSlot);
    wall.clip(boundaries[kRightOfSlot], kRightOfSlot);
    integrate(left);
    integrate(wall);
  }
  CornerSlopes slopes;
  add_stripes(phase, sums.phase, slopes);
  add(slopes.margin, sums.boundary[kRim], 1.0);
  add(slopes.y, sums.boundary[kLeftOfSlot], -1.0);
  add(slopes.y, sums.boundary[kRightOfSlot], 1.0);
  slot_mm -= 0.5 * (sums.boundary[kLeftOfSlot].value + sums.boundary[kRightOfSlot].value);
  duty += sums.duty;
  dark += sums.area - sums.share;
  return slopes;
}

}  // namespace glint
