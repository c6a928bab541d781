// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions are summed row by row: rows at angles phi in the cross-section's plane, each with 32
// directions along the tunnel. Every boundary of the light is an end of a range: slot, rims and
// panels in phi, the tunnel's ends in t, so nothing jumps inside a range and Gauss-Legendre rules
// converge fast. Ranges are stretched by the arc tangent in units of the lobe's width, under which
// GGX with its long tails becomes a smooth bump (squared cosine). Cost: some 30 rows a point.
#include "simulator/render/blurred/stripe_response.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"
#include "simulator/light/area/wall_outline.h"
#include "simulator/material/quadrature.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Rows of a range that fills half a turn after stretching, of stripes across the tunnel; twice as
/// many for those along it, which change from row to row.
constexpr double kRows = 32.0;
constexpr int kMinRows = 6;
constexpr int kMaxRows = 64;
constexpr std::size_t kMaxPlanes = 256;

const Quadrature& row_rule(int count) {
  static const std::vector<Quadrature> rules = [] {
    std::vector<Quadrature> made(1);
    for (int n = 1; n <= kMaxRows; ++n) {
      made.push_back(gauss_legendre(n));
    }
    return made;
  }();
  return rules[static_cast<std::size_t>(count)];
}

ColumnRule column_rule() {
  const Quadrature rule = gauss_legendre(kLobeColumns);
  ColumnRule columns = {};
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    columns.node[i] = static_cast<float>(2.0 * rule.nodes[i] - 1.0);
    columns.weight[i] = static_cast<float>(2.0 * rule.weights[i]);
  }
  return columns;
}

float sum_of(const float* lanes) {
  float sum = 0.0F;
  for (int i = 0; i < kPacketSize; ++i) {
    sum += lanes[i];
  }
  return sum;
}

void copy_to(const Vector3d& from, float* to) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    to[i] = static_cast<float>(from[i]);
  }
}

/// x K1(x): what the lobe's profile leaves of a wave that turns by x over its width.
double kept_by_lobe(double x) {
  return x * std::cyl_bessel_k(1.0, x);
}

}  // namespace

struct StripeResponse::Planes {
  std::size_t count = 0;
  std::array<double, kMaxPlanes> phi_rad, weight_rad;
  // Rays of length 1 in the plane, and what they meet.
  std::array<float, kMaxPlanes> x, y, z, none, sine, cosine;
  std::array<float, kMaxPlanes> distance_mm, gain;
  std::array<float, kMaxPlanes> arc_mm, wall_cosine, dark;
};

StripeResponse::StripeResponse(const Tunnel& tunnel,
                               const ConductorNumbers& metal,
                               double middle_x_mm,
                               const HarmonicList& harmonics)
    : tunnel_(tunnel),
      metal_(metal),
      middle_x_mm_(middle_x_mm),
      harmonics_(harmonics),
      columns_(column_rule()),
      along_x_(std::cos(tunnel.settings().orientation_rad)),
      along_arc_(std::sin(tunnel.settings().orientation_rad)),
      has_details_(tunnel.settings().orientation_rad != 0.0 || tunnel.settings().cosine_law ||
                   !tunnel.dark().is_even()) {
  GLINT_CHECK(harmonics.count <= kMaxHarmonics, "harmonics fit into the sums");
  const std::vector<WallStrip> strips = wall_outline(tunnel);
  for (std::size_t i = 0; i < strips.size(); ++i) {
    if (i == 0 || strips[i].from_mm != strips[i - 1].to_mm) {
      corners_.push_back(strips[i].from_mm);
    }
    if (i + 1 == strips.size() || strips[i].to_mm != strips[i + 1].from_mm) {
      corners_.push_back(strips[i].to_mm);
    }
  }
}

/// Angles from the vertical at which a boundary of the light is seen, sorted.
std::vector<double> StripeResponse::wall_ends(const Vector2d& from) const {
  std::vector<double> ends;
  for (const Vector2d& corner : corners_) {
    const Vector2d to = corner - from;
    ends.push_back(std::atan2(to.x(), to.y()));
  }
  std::ranges::sort(ends);
  return ends;
}

void StripeResponse::add_planes(
    const LobeShape& shape, double from_rad, double to_rad, int count, Planes& planes) const {
  const double width = 1.0 / std::sqrt(shape.across);
  const double from = std::atan((from_rad - shape.phi0_rad) / width);
  const double range = std::atan((to_rad - shape.phi0_rad) / width) - from;
  const Quadrature& rule = row_rule(count);
  for (std::size_t i = 0; i < rule.nodes.size() && planes.count < kMaxPlanes; ++i) {
    const double at = from + range * rule.nodes[i];
    const double cosine = std::cos(at);
    planes.phi_rad[planes.count] = shape.phi0_rad + width * std::tan(at);
    planes.weight_rad[planes.count] = range * rule.weights[i] * width / (cosine * cosine);
    ++planes.count;
  }
}

void StripeResponse::choose_planes(const BlurredPoint& point,
                                   const LobeShape& shape,
                                   Planes& planes) const {
  constexpr double kNarrow_rad = 1e-6;
  const std::vector<double> ends = wall_ends(point.point_mm.tail<2>());
  const double root = std::sqrt(shape.across);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i + 1] - ends[i] < kNarrow_rad) {
      continue;
    }
    Planes middle;
    middle.count = 1;
    middle.phi_rad[0] = 0.5 * (ends[i] + ends[i + 1]);
    intersect_wall(point, middle);
    if (middle.gain[0] == 0.0F) {
      continue;
    }
    const double stretched = std::atan((ends[i + 1] - shape.phi0_rad) * root) -
                             std::atan((ends[i] - shape.phi0_rad) * root);
    const int count =
        static_cast<int>(std::ceil(kRows * (1.0 + std::abs(along_arc_)) * stretched / kPi));
    add_planes(shape, ends[i], ends[i + 1], std::clamp(count, kMinRows, kMaxRows), planes);
  }
}

/// Where rays in the plane meet the wall.
void StripeResponse::intersect_wall(const BlurredPoint& point, Planes& planes) const {
  for (std::size_t i = 0; i < planes.count; ++i) {
    planes.none[i] = 0.0F;
    planes.y[i] = static_cast<float>(point.point_mm.y());
    planes.z[i] = static_cast<float>(point.point_mm.z());
    planes.sine[i] = static_cast<float>(std::sin(planes.phi_rad[i]));
    planes.cosine[i] = static_cast<float>(std::cos(planes.phi_rad[i]));
  }
  const RayBlock rays = {.origin_x = planes.none.data(),
                         .origin_y = planes.y.data(),
                         .origin_z = planes.z.data(),
                         .direction_x = planes.none.data(),
                         .direction_y = planes.sine.data(),
                         .direction_z = planes.cosine.data(),
                         .count = static_cast<int>(planes.count)};
  tunnel_.cross_wall(rays, planes.distance_mm.data(), planes.x.data(), planes.gain.data());
  if (!has_details_) {
    return;
  }
  std::array<float, kMaxPlanes> y, margin;
  tunnel_.intersect_block(rays, planes.x.data(), y.data(), margin.data());
  tunnel_.hit_details(rays,
                      planes.x.data(),
                      y.data(),
                      margin.data(),
                      planes.arc_mm.data(),
                      planes.wall_cosine.data());
  for (std::size_t i = 0; i < planes.count; ++i) {  // arc_mm: times the sine already
    planes.dark[i] = static_cast<float>(
        tunnel_.dark().at(static_cast<double>(y[i]), static_cast<double>(margin[i])));
  }
}

LobeFrame StripeResponse::frame_of(const BlurredPoint& point, const LobeShape& shape) const {
  LobeFrame frame;
  const LocalDirection viewer = shape.frame.to_local(point.to_viewer);
  std::fill_n(frame.viewer.x, kPacketSize, static_cast<float>(viewer.x));
  std::fill_n(frame.viewer.y, kPacketSize, static_cast<float>(viewer.y));
  std::fill_n(frame.viewer.z, kPacketSize, static_cast<float>(viewer.z));
  choose_lobes16(metal_, frame.viewer, frame.lobes);
  copy_to(shape.frame.tangent, frame.tangent);
  copy_to(shape.frame.bitangent, frame.bitangent);
  copy_to(shape.frame.normal, frame.normal);
  return frame;
}

LobeRow StripeResponse::row_of(const BlurredPoint& point,
                               const LobeShape& shape,
                               const Planes& planes,
                               std::size_t index,
                               double phase_mm) const {
  const TunnelSettings& s = tunnel_.settings();
  const double off = planes.phi_rad[index] - shape.phi0_rad;
  const double middle = shape.t0 + shape.tilt * off;
  const double width = std::sqrt((1.0 + shape.across * off * off) / shape.along);
  const auto distance_mm = static_cast<double>(planes.distance_mm[index]);
  const auto psi_at = [&](double x_mm) {
    return std::atan(((x_mm - point.point_mm.x()) / distance_mm - middle) / width);
  };
  const double from = psi_at(middle_x_mm_ - 0.5 * s.length_mm);
  const double to = psi_at(middle_x_mm_ + 0.5 * s.length_mm);
  const double arc_mm = has_details_ ? static_cast<double>(planes.arc_mm[index]) : 0.0;
  const double dark =
      has_details_ ? static_cast<double>(planes.dark[index]) : tunnel_.dark().mean();
  const double turns = (along_x_ * point.point_mm.x() + arc_mm - phase_mm) / s.period_mm;
  return {.sine = planes.sine[index],
          .cosine = planes.cosine[index],
          .middle = static_cast<float>(middle),
          .width = static_cast<float>(width),
          .psi = static_cast<float>(0.5 * (from + to)),
          .half_psi = static_cast<float>(0.5 * (to - from)),
          .weight = static_cast<float>(planes.weight_rad[index]),
          .turns = static_cast<float>(turns),
          .turns_per_t = static_cast<float>(along_x_ * distance_mm / s.period_mm),
          .dark = static_cast<float>(dark),
          .even = s.cosine_law ? 0.0F : 1.0F,
          .law = s.cosine_law ? planes.wall_cosine[index] : 0.0F};
}

void StripeResponse::at(const BlurredPoint& point,
                        double phase_mm,
                        std::span<float> numbers) const {
  std::ranges::fill(numbers, 0.0F);
  const LobeShape shape = lobe_shape(point, static_cast<double>(metal_.alpha_x));
  const LobeFrame frame = frame_of(point, shape);
  Planes planes;
  choose_planes(point, shape, planes);
  intersect_wall(point, planes);
  std::vector<LobeRow> rows;
  for (std::size_t i = 0; i < planes.count; ++i) {
    rows.push_back(row_of(point, shape, planes, i, phase_mm));
  }
  LobeSums sums;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (planes.gain[i] == 0.0F) {
      continue;
    }
    // The phase in the row's middle, from one neighbour to the other.
    const std::size_t before = i > 0 ? i - 1 : 0;
    const std::size_t after = std::min(i + 1, rows.size() - 1);
    const auto turns_of = [&](const LobeRow& row) {
      return row.turns + row.turns_per_t * row.middle;
    };
    const double way_rad = planes.phi_rad[after] - planes.phi_rad[before];
    const double per_rad =
        way_rad > 0.0
            ? static_cast<double>(turns_of(rows[after]) - turns_of(rows[before])) / way_rad
            : 0.0;
    rows[i].row_turns = static_cast<float>(std::abs(per_rad * planes.weight_rad[i]));
    add_lobe_row(metal_, frame, columns_, rows[i], harmonics_, sums);
  }
  numbers[0] = sum_of(sums.dark);
  numbers[1] = sum_of(sums.even);
  for (int j = 0; j < harmonics_.count; ++j) {
    const auto at = 2 + 2 * static_cast<std::size_t>(j);
    numbers[at] = sum_of(sums.real[j]);
    numbers[at + 1] = sum_of(sums.imaginary[j]);
  }
}

HarmonicList harmonics_for(const TunnelSettings& tunnel, double width_mm) {
  constexpr double kLeft = 2e-4;
  HarmonicList list = {.count = 0, .step = tunnel.duty == 0.5 ? 2 : 1};
  if (tunnel.duty <= 0.0 || tunnel.duty >= 1.0) {
    return list;
  }
  while (true) {
    const int number = list.number(list.count);
    const double left = kept_by_lobe(2.0 * kPi * number * width_mm / tunnel.period_mm);
    if (2.0 / (kPi * number) * left < kLeft) {
      return list;
    }
    if (++list.count > kMaxHarmonics) {
      throw ConfigError(
          "render.method",
          fmt::format("is \"blurred\", but the metal is too smooth for it here: its lobe is {:.2g} "
                      "mm wide on the wall and the stripes have a period of {:g} mm; allowed are "
                      "rougher metal, narrower stripes or \"paths\"",
                      width_mm,
                      tunnel.period_mm));
    }
  }
}

std::vector<std::complex<float>> wave_factors(const HarmonicList& harmonics,
                                              const TunnelSettings& tunnel,
                                              double shift_mm) {
  const std::complex<double> i(0.0, 1.0);
  std::vector<std::complex<float>> factors;
  for (int j = 0; j < harmonics.count; ++j) {
    const double turn = 2.0 * kPi * harmonics.number(j);
    const std::complex<double> series = (1.0 - std::exp(-i * turn * tunnel.duty)) / (i * turn);
    const std::complex<double> factor =
        2.0 * series * std::exp(-i * turn * shift_mm / tunnel.period_mm);
    factors.emplace_back(factor);
  }
  return factors;
}

}  // namespace glint
