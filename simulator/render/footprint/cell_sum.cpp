// SPDX-License-Identifier: GPL-3.0-or-later
//
// The radiance of one boundary or refined pixel at all positions of a scan, summed from cells.
// Cells entirely inside the light are collected and summed sixteen at a time by the trapezoid
// kernels; cells on a boundary are clipped to a polygon (Sutherland and Hodgman 1974) and
// integrated by the divergence theorem (stripe_integral.h); corners that do not belong together
// count as points. Where an end of the tunnel passes through a cell, its polygon is cut anew for
// each frame. docs/theory/footprints.md. Cost: proportional to cells times frames. Memory: buffers
// that keep their size from pixel to pixel.
#include "simulator/render/footprint/cell_sum.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/units.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

/// Over a pixel; rounding errors allowed for.
double largest_of(const LinearFunction& f) {
  constexpr double kRounding = 1e-12;
  const double reach = 0.5 * (std::abs(f.dx) + std::abs(f.dy));
  return f.value + reach + kRounding * (std::abs(f.value) + reach);
}

double smallest_of(const LinearFunction& f) {
  return -largest_of({.value = -f.value, .dx = f.dx, .dy = f.dy});
}

}  // namespace

CellCorners::CellCorners(const WallHits& hits,
                         const float* weight,
                         const std::array<std::size_t, 4>& at) {
  for (std::size_t i = 0; i < 4; ++i) {
    x_mm[i] = static_cast<double>(hits.x_mm[at[i]]);
    stripes_mm[i] = static_cast<double>(hits.stripes_mm()[at[i]]);
    y_mm[i] = static_cast<double>(hits.y_mm[at[i]]);
    margin_mm[i] = static_cast<double>(hits.margin_mm[at[i]]);
    gain[i] = static_cast<double>(weight[at[i]]) *
              (hits.cosine.empty() ? 1.0 : static_cast<double>(hits.cosine[at[i]]));
  }
}

double unevenness(const ScanPositions& p, double x_mm) {
  if (p.is_even) {
    return 1.0;
  }
  const kernels::Unevenness& u = p.unevenness;
  const auto ripple = static_cast<double>(u.ripple);
  const double end = x_mm / p.half_length_mm;
  const double led =
      (1.0 + ripple * std::cos(2.0 * kPi * x_mm * static_cast<double>(u.per_mm))) / (1.0 + ripple);
  return std::max(0.0, led * (1.0 - static_cast<double>(u.falloff) * end * end));
}

CellSum::CellSum(const ScanPositions& positions)
    : p_(positions),
      shares_(positions.shift_periods.size()),
      sum_(positions.shift_periods.size()) {}

void CellSum::clear() {
  std::ranges::fill(sum_, 0.0);
  size_ = 0;
}

bool CellSum::is_lit_throughout(const std::array<double, 2>& x_mm,
                                const std::array<double, 2>& y_mm,
                                double lowest_margin_mm) const {
  return p_.is_even && lowest_margin_mm >= 0.0 &&
         (y_mm[0] >= p_.half_slot_mm || y_mm[1] <= -p_.half_slot_mm) &&
         p_.is_inside_ends(x_mm[0], x_mm[1]);
}

/// Without a part of a period that is bright at some positions only, any width will do.
bool CellSum::is_narrow(double width_mm) const {
  return p_.duty <= 0.0 || width_mm <= 2.0 * std::min(p_.duty, 1.0 - p_.duty) * p_.period_mm;
}

bool CellSum::add_lit(const std::array<float, 4>& stripes_mm, float gain) {
  const std::array<float, 4>& c = stripes_mm;
  const auto [low, high] = std::ranges::minmax(c);
  if (!is_narrow(static_cast<double>(high) - static_cast<double>(low))) {
    return false;
  }
  add_sample(0.25F * (c[0] + c[1] + c[2] + c[3]),
             0.5F * (c[1] + c[3] - c[0] - c[2]),
             0.5F * (c[2] + c[3] - c[0] - c[1]),
             gain);
  return true;
}

bool CellSum::add_lit_cells(const cut_kernels::CellGrid& cells) {
  const auto count = static_cast<std::size_t>(cells.cells_per_axis * cells.cells_per_axis);
  make_room(count);
  const float widest_mm = cut_kernels::sample_cells(cells,
                                                    static_cast<float>(p_.offset_mm),
                                                    static_cast<float>(1.0 / p_.period_mm),
                                                    {.v = v_.data() + size_,
                                                     .gx = gx_.data() + size_,
                                                     .gy = gy_.data() + size_,
                                                     .gain = gain_.data() + size_});
  const bool is_added = is_narrow(static_cast<double>(widest_mm));
  size_ += is_added ? count : 0;
  return is_added;
}

void CellSum::make_room(std::size_t more) {
  if (size_ + more > v_.size()) {
    const std::size_t room = std::max<std::size_t>(512, 2 * (size_ + more));
    for (auto* array : {&v_, &gx_, &gy_, &gain_, &outer_, &inner_, &per_major_, &per_both_}) {
      array->resize(room);
    }
  }
}

void CellSum::add_sample(float stripes_mm, float gx_mm, float gy_mm, float gain) {
  make_room(1);
  const auto per_mm = static_cast<float>(1.0 / p_.period_mm);
  v_[size_] = (stripes_mm - static_cast<float>(p_.offset_mm)) * per_mm;
  gx_[size_] = gx_mm * per_mm;
  gy_[size_] = gy_mm * per_mm;
  gain_[size_] = gain;
  ++size_;
}

namespace {

std::array<float, 4> to_float(const std::array<double, 4>& values) {
  std::array<float, 4> floats = {};
  std::ranges::transform(
      values, floats.begin(), [](double value) { return static_cast<float>(value); });
  return floats;
}

}  // namespace

void CellSum::add_smooth(const CellCorners& corners, double share) {
  const auto [x_low, x_high] = std::ranges::minmax(corners.x_mm);
  const auto [y_low, y_high] = std::ranges::minmax(corners.y_mm);
  if (is_lit_throughout({x_low, x_high}, {y_low, y_high}, std::ranges::min(corners.margin_mm))) {
    if (add_lit(to_float(corners.stripes_mm), static_cast<float>(share * corners.mean_gain()))) {
      return;
    }
  }
  const PixelPolygon whole;
  add_visible(corners, share, {&whole, 1});
}

void CellSum::add_visible(const CellCorners& corners,
                          double share,
                          std::span<const PixelPolygon> visible) {
  if (std::ranges::min(corners.margin_mm) < kNoHitBelow_mm) {
    double area = 0.0;
    for (const PixelPolygon& part : visible) {
      area += part.area();
    }
    add_points(corners, share * area);
    return;
  }
  const auto [x_low, x_high] = std::ranges::minmax(corners.x_mm);
  if (p_.is_inside_ends(x_low, x_high)) {
    integrate(corners, visible, p_.shift_periods, nullptr);
    accumulate(corners, share, 0, p_.shift_periods);
    return;
  }
  std::vector<double> one_shift(1);
  for (std::size_t k = 0; k < sum_.size(); ++k) {
    one_shift[0] = p_.shift_periods[k];
    integrate(corners, visible, one_shift, &p_.shift_mm[k]);
    accumulate(corners, share, k, one_shift);
  }
}

/// Corners that have nothing to do with each other: each stands for a quarter of the cell.
void CellSum::add_points(const CellCorners& corners, double share) {
  for (std::size_t i = 0; i < 4; ++i) {
    add_place(corners.x_mm[i],
              corners.stripes_mm[i],
              corners.y_mm[i],
              corners.margin_mm[i],
              0.25 * share * corners.gain[i]);
  }
}

void CellSum::add_place(
    double x_mm, double stripes_mm, double y_mm, double margin_mm, double gain) {
  const bool is_on_wall = margin_mm >= 0.0 && std::abs(y_mm) >= p_.half_slot_mm;
  if (!is_on_wall || gain <= 0.0) {
    return;
  }
  if (p_.is_even && p_.is_inside_ends(x_mm, x_mm)) {
    add_sample(static_cast<float>(stripes_mm), 0.0F, 0.0F, static_cast<float>(gain));
    return;
  }
  const double phase = (stripes_mm - p_.offset_mm) / p_.period_mm;
  for (std::size_t k = 0; k < sum_.size(); ++k) {
    const double in_tunnel_mm = x_mm - p_.shift_mm[k];
    if (std::abs(in_tunnel_mm) < p_.half_length_mm) {
      const double moved = phase - p_.shift_periods[k];
      const double stripe = p_.dark + (moved - std::floor(moved) < p_.duty ? p_.bright : 0.0);
      sum_[k] += gain * unevenness(p_, in_tunnel_mm) * stripe;
    }
  }
}

LinearFunction CellSum::phase_of(const CellCorners& corners) const {
  const LinearFunction stripes = linear_through(corners.stripes_mm);
  return {.value = (stripes.value - p_.offset_mm) / p_.period_mm,
          .dx = stripes.dx / p_.period_mm,
          .dy = stripes.dy / p_.period_mm};
}

/// Lit area and bright area at the given shifts; the ends count when the tunnel's place is given.
void CellSum::integrate(const CellCorners& corners,
                        std::span<const PixelPolygon> visible,
                        const std::vector<double>& shifts,
                        const double* tunnel_mm) {
  stripes_.clear();
  const LinearFunction margin = linear_through(corners.margin_mm);
  for (PixelPolygon wall : visible) {
    if (smallest_of(margin) < 0.0) {
      wall.clip(margin, 0);
    }
    if (tunnel_mm != nullptr) {
      LinearFunction x = linear_through(corners.x_mm);
      x.value += p_.half_length_mm - *tunnel_mm;
      wall.clip(x, 1);
      wall.clip({.value = 2.0 * p_.half_length_mm - x.value, .dx = -x.dx, .dy = -x.dy}, 2);
    }
    integrate_on_wall(corners, wall);
  }
  shares_.resize(shifts.size());
  stripes_.evaluate(shifts, p_.duty, shares_.data());
}

/// A part of the cell that lies on the wall or its slot.
void CellSum::integrate_on_wall(const CellCorners& corners, const PixelPolygon& wall) {
  const LinearFunction phase = phase_of(corners);
  const LinearFunction y = linear_through(corners.y_mm);
  const auto [low, high] = std::ranges::minmax(corners.y_mm);
  if (low >= p_.half_slot_mm || high <= -p_.half_slot_mm) {
    stripes_.add(wall, phase);
    return;
  }
  const LinearFunction to_left = {.value = -p_.half_slot_mm - y.value, .dx = -y.dx, .dy = -y.dy};
  const LinearFunction to_right = {.value = y.value - p_.half_slot_mm, .dx = y.dx, .dy = y.dy};
  for (const auto& [beside, label] : {std::pair(to_left, 3), std::pair(to_right, 4)}) {
    if (largest_of(beside) >= 0.0) {
      PixelPolygon part = wall;
      part.clip(beside, label);
      stripes_.add(part, phase);
    }
  }
}

void CellSum::accumulate(const CellCorners& corners,
                         double share,
                         std::size_t first,
                         const std::vector<double>& shifts) {
  const double x_mm = linear_through(corners.x_mm).value;
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const std::size_t k = first + i;
    const double lit = p_.dark * stripes_.area + p_.bright * shares_[i];
    sum_[k] += share * corners.mean_gain() * unevenness(p_, x_mm - p_.shift_mm[k]) * lit;
  }
}

const std::vector<double>& CellSum::radiance() {
  while (size_ % kernels::kLanes != 0) {
    add_sample(0.0F, 0.0F, 0.0F, 0.0F);
  }
  const int count = static_cast<int>(size_);
  const kernels::Trapezoids shape = {.outer = outer_.data(),
                                     .inner = inner_.data(),
                                     .per_major = per_major_.data(),
                                     .per_both = per_both_.data()};
  const auto duty = static_cast<float>(p_.duty);
  kernels::trapezoids(gx_.data(), gy_.data(), count, shape);
  kernels::sum_box_frames(v_.data(),
                          shape,
                          gain_.data(),
                          count,
                          p_.shift_periods.data(),
                          static_cast<int>(sum_.size()),
                          p_.duty,
                          p_.dark,
                          p_.bright,
                          kernels::largest(outer_.data(), count) <= kernels::narrow_limit(duty),
                          sum_.data());
  return sum_;
}

}  // namespace glint
