// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reverse mode of cell_sum.h: from the derivatives by a pixel's radiance in each frame to those
// by the hits at the corners of its cells. Cells inside the light use the derivative of the
// trapezoid, with their frames side by side; cells on a boundary that of the polygon
// (stripe_gradient.h), which includes that the boundary moves. docs/theory/derivatives.md,
// "Boundaries of the light". Cost: proportional to cells times frames. Memory: a few numbers per
// frame.
#include "simulator/render/derivative/cell_gradient.h"

#include <algorithm>

namespace glint {
namespace {

/// Labels of what cuts a cell.
constexpr int kRim = 0;
constexpr int kLeftOfSlot = 3;
constexpr int kRightOfSlot = 4;
constexpr int kLightLabels = 5;  ///< the edges of what is hidden come after them

void add(std::array<double, 4>& to, const LinearGradient& gradient, double factor) {
  const std::array<double, 4> by_corners = gradient.by_corners();
  for (std::size_t i = 0; i < 4; ++i) {
    to[i] += factor * by_corners[i];
  }
}

}  // namespace

CellGradient::CellGradient(const ScanPositions& positions) : p_(positions) {
  constexpr std::size_t kVector = 16;
  for (const double shift : p_.shift_periods) {
    shifts_.push_back(gradient_kernels::fixed_phase_of(shift));
  }
  shifts_.resize((shifts_.size() + kVector - 1) / kVector * kVector);
  v_.resize(shifts_.size());
  for (auto* array : {&gx_, &gy_, &weight_, &by_v_, &by_gx_, &by_gy_, &by_duty_, &by_dark_}) {
    array->resize(shifts_.size());
  }
}

LinearFunction CellGradient::phase_of(const CellCorners& corners) const {
  const LinearFunction x = linear_through(corners.stripes_mm);
  return {.value = (x.value - p_.offset_mm) / p_.period_mm,
          .dx = x.dx / p_.period_mm,
          .dy = x.dy / p_.period_mm};
}

bool CellGradient::waits(const CellCorners& corners,
                         const std::array<std::size_t, 4>& at,
                         double share) {
  const auto [x_low, x_high] = std::ranges::minmax(corners.x_mm);
  const auto [y_low, y_high] = std::ranges::minmax(corners.y_mm);
  const auto [v_low, v_high] = std::ranges::minmax(corners.stripes_mm);
  const bool is_plain = std::ranges::min(corners.margin_mm) >= 0.0 &&
                        (y_low >= p_.half_slot_mm || y_high <= -p_.half_slot_mm) &&
                        p_.is_inside_ends(x_low, x_high) &&
                        v_high - v_low <= 2.0 * std::min(p_.duty, 1.0 - p_.duty) * p_.period_mm;
  if (is_plain) {
    waiting_.push_back({.at = at, .phase = phase_of(corners), .gain = share * corners.mean_gain()});
  }
  return is_plain;
}

void CellGradient::add_stripes(const LinearFunction& phase,
                               const LinearGradient& by_phase,
                               CornerGradient& gradient) {
  add(gradient.x, by_phase, 1.0 / p_.period_mm);
  period_mm -= (by_phase.value * phase.value + by_phase.dx * phase.dx + by_phase.dy * phase.dy) /
               p_.period_mm;
  offset_mm -= by_phase.value / p_.period_mm;
}

CornerGradient CellGradient::gradient_of_waiting(const Waiting& cell,
                                                 const std::vector<double>& by_radiance) {
  const gradient_kernels::FixedPhase turn = gradient_kernels::fixed_phase_of(cell.phase.value);
  for (std::size_t k = 0; k < shifts_.size(); ++k) {
    v_[k] = turn - shifts_[k];
  }
  for (std::size_t k = 0; k < by_radiance.size(); ++k) {
    weight_[k] = static_cast<float>(cell.gain * by_radiance[k]);
  }
  std::ranges::fill(gx_, static_cast<float>(cell.phase.dx));
  std::ranges::fill(gy_, static_cast<float>(cell.phase.dy));
  for (auto* array : {&by_v_, &by_gx_, &by_gy_, &by_duty_, &by_dark_}) {
    std::ranges::fill(*array, 0.0F);
  }
  const gradient_kernels::BoxGradients by_frame = {.v = by_v_.data(),
                                                   .gx = by_gx_.data(),
                                                   .gy = by_gy_.data(),
                                                   .duty = by_duty_.data(),
                                                   .dark = by_dark_.data()};
  const auto frames = static_cast<int>(v_.size());
  gradient_kernels::add_box_gradients(
      v_.data(), gx_.data(), gy_.data(), weight_.data(), frames, 0.0, p_.duty, by_frame);
  const gradient_kernels::BoxSums sums = gradient_kernels::totals_of(by_frame, frames);
  const double bright = 1.0 - p_.dark;
  const LinearGradient by_phase = {
      .value = bright * sums.v, .dx = bright * sums.gx, .dy = bright * sums.gy};
  duty += bright * sums.duty;
  dark += sums.dark;
  CornerGradient gradient;
  add_stripes(cell.phase, by_phase, gradient);
  return gradient;
}

/// A cell is treated as constant at the tunnel's end, and where a corner meets no wall.
bool CellGradient::is_detached(const CellCorners& corners) {
  const auto [x_low, x_high] = std::ranges::minmax(corners.x_mm);
  const bool is_constant =
      !p_.is_inside_ends(x_low, x_high) || std::ranges::min(corners.margin_mm) < kNoHitBelow_mm;
  has_detached = has_detached || is_constant;
  return is_constant;
}

/// @param parts       polygons of the cell
/// @param boundaries  by label; those of the light are set
StripeGradient CellGradient::gradient_of_polygons(const CellCorners& corners,
                                                  std::span<const PixelPolygon> parts,
                                                  std::span<LinearFunction> boundaries,
                                                  double share,
                                                  const std::vector<double>& by_radiance) {
  weights_ = by_radiance;
  for (double& weight : weights_) {
    weight *= share * corners.mean_gain();
  }
  const LinearFunction phase = phase_of(corners);
  const LinearFunction y = linear_through(corners.y_mm);
  boundaries[kRim] = linear_through(corners.margin_mm);
  boundaries[kLeftOfSlot] = {.value = -p_.half_slot_mm - y.value, .dx = -y.dx, .dy = -y.dy};
  boundaries[kRightOfSlot] = {.value = y.value - p_.half_slot_mm, .dx = y.dx, .dy = y.dy};
  StripeGradient sums;
  const auto integrate = [&](const PixelPolygon& polygon) {
    sums.add(
        polygon, phase, boundaries, p_.shift_periods, weights_, {p_.duty, p_.dark, 1.0 - p_.dark});
  };
  const auto [low, high] = std::ranges::minmax(corners.y_mm);
  const bool is_beside_slot = low >= p_.half_slot_mm || high <= -p_.half_slot_mm;
  for (PixelPolygon wall : parts) {
    wall.clip(boundaries[kRim], kRim);
    if (is_beside_slot) {
      integrate(wall);
      continue;
    }
    PixelPolygon left = wall;
    left.clip(boundaries[kLeftOfSlot], kLeftOfSlot);
    wall.clip(boundaries[kRightOfSlot], kRightOfSlot);
    integrate(left);
    integrate(wall);
  }
  return sums;
}

void CellGradient::add_polygons(const CellCorners& corners,
                                const StripeGradient& sums,
                                CornerGradient& gradient) {
  add_stripes(phase_of(corners), sums.phase, gradient);
  add(gradient.margin, sums.boundary[kRim], 1.0);
  add(gradient.y, sums.boundary[kLeftOfSlot], -1.0);
  add(gradient.y, sums.boundary[kRightOfSlot], 1.0);
  slot_mm -= 0.5 * (sums.boundary[kLeftOfSlot].value + sums.boundary[kRightOfSlot].value);
  duty += sums.duty;
  dark += sums.area - sums.share;
}

/// False where the cell is treated as constant.
bool CellGradient::is_boundary(const CellCorners& corners,
                               double share,
                               const std::vector<double>& by_radiance,
                               CornerGradient& gradient) {
  if (is_detached(corners)) {
    return false;
  }
  std::array<LinearFunction, kLightLabels> boundaries;
  const PixelPolygon whole;
  add_polygons(corners,
               gradient_of_polygons(corners, {&whole, 1}, boundaries, share, by_radiance),
               gradient);
  return true;
}

/// The same for a cell that is hidden in part.
bool CellGradient::is_visible(const CellCorners& corners,
                              const VisiblePart& visible,
                              const SquareOfPixel& square,
                              const std::vector<double>& by_radiance,
                              CornerGradient& gradient) {
  if (is_detached(corners)) {
    return false;
  }
  static_assert(StripeGradient::kLabels == kLightLabels + 2 * VisiblePart::kEdges);
  std::array<LinearFunction, StripeGradient::kLabels> boundaries;
  for (int i = 0; i < VisiblePart::kEdges; ++i) {
    const LinearFunction f = visible.edge(i, square);
    const auto label = static_cast<std::size_t>(kLightLabels + 2 * i);
    boundaries[label] = f;
    boundaries[label + 1] = {.value = -f.value, .dx = -f.dx, .dy = -f.dy};
  }
  const StripeGradient sums = gradient_of_polygons(corners,
                                                   visible.polygons(square, kLightLabels),
                                                   boundaries,
                                                   square.side * square.side,
                                                   by_radiance);
  add_polygons(corners, sums, gradient);
  for (std::size_t i = 0; i < by_edges.size(); ++i) {
    const LinearGradient& inside = sums.boundary[kLightLabels + 2 * i];
    const LinearGradient& beside = sums.boundary[kLightLabels + 2 * i + 1];
    const double value = inside.value - beside.value;
    by_edges[i].value += value;
    by_edges[i].dx += square.x * value + square.side * (inside.dx - beside.dx);
    by_edges[i].dy += square.y * value + square.side * (inside.dy - beside.dy);
  }
  return true;
}

}  // namespace glint
