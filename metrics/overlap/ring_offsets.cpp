// SPDX-License-Identifier: GPL-3.0-or-later
//
// An edge tells only the part of its motion along its normal n. Least squares of
//   offset = n . (shift + radial(r) e_r + tangential(r) e_t)
// give both: in each ring as constants, over all rings as straight lines of the radius.
#include "metrics/overlap/ring_offsets.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kBlocks = 24;  ///< of neighbours that are left out together
/// Standard deviation of the edges' radii, in so far as shift, size and turn do not tell it, from
/// which on there is a slope. The edges' noise sigma biases it by -(sigma / 5 px)^2: by -0.1 px
/// over 1000 px for 0.05 px.
constexpr double kMinSpread_px = 5.0;

struct Polar {
  double radius_px = 0.0;
  double radial = 0.0;  ///< of the normal
  double tangential = 0.0;
};

Polar polar_of(const EdgeOffset& edge, const Vector2d& centre_px) {
  const Vector2d from = edge.at_px - centre_px;
  const double radius = from.norm();
  const Vector2d out = radius > 0.0 ? Vector2d(from / radius) : Vector2d::UnitX();
  return {.radius_px = radius,
          .radial = edge.normal.dot(out),
          .tangential = edge.normal.dot(Vector2d(-out.y(), out.x()))};
}

void fill_ring(std::span<const EdgeOffset> offsets, const Vector2d& centre_px, OffsetRing& ring) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Vector2d right = Vector2d::Zero();
  for (const EdgeOffset& edge : offsets) {
    const Polar polar = polar_of(edge, centre_px);
    if (polar.radius_px >= ring.inner_px && polar.radius_px < ring.outer_px) {
      const Vector2d row(polar.radial, polar.tangential);
      normal += row * row.transpose();
      right += row * edge.offset_px;
      ++ring.points;
    }
  }
  // A direction that less than some edges' worth of normals tells of is not known.
  constexpr double kMin = 5.0;
  ring.has_radial = normal(0, 0) >= kMin;
  ring.has_tangential = normal(1, 1) >= kMin;
  if (ring.has_radial && ring.has_tangential &&
      normal.determinant() > 0.01 * normal(0, 0) * normal(1, 1)) {
    const Vector2d both = normal.inverse() * right;
    ring.radial_px = both[0];
    ring.tangential_px = both[1];
  } else {
    ring.radial_px = ring.has_radial ? right[0] / normal(0, 0) : 0.0;
    ring.has_tangential = ring.has_tangential && !ring.has_radial;
    ring.tangential_px = ring.has_tangential ? right[1] / normal(1, 1) : 0.0;
  }
}

/// Shift, slope of the radial and slope of the tangential offset per 1000 px. The constant part of
/// the radial offset along straight lines of the radius is no lens: a disc that is too large has it
/// at every radius alike, as `radial` below.
using Lines = Eigen::Matrix<double, 6, 1>;
using LinesNormal = Eigen::Matrix<double, 6, 6>;

struct LinesSums {
  LinesNormal normal = LinesNormal::Zero();
  Lines right = Lines::Zero();
};

LinesSums sums_of(std::span<const EdgeOffset> offsets, const Vector2d& centre_px) {
  LinesSums sums;
  for (const EdgeOffset& edge : offsets) {
    const Polar polar = polar_of(edge, centre_px);
    Lines row;
    row << edge.normal.x(), edge.normal.y(), polar.radial, polar.radial * polar.radius_px / 1000.0,
        polar.tangential, polar.tangential * polar.radius_px / 1000.0;
    sums.normal += row * row.transpose();
    sums.right += row * edge.offset_px;
  }
  return sums;
}

constexpr Eigen::Index kRadialSlope = 3;
constexpr Eigen::Index kTangentialSlope = 5;

/// A faint pull to zero keeps directions that no edge tells of from running away.
Eigen::LDLT<LinesNormal> factored(LinesNormal normal) {
  normal.diagonal().array() += 1e-9 * std::max(normal.diagonal().maxCoeff(), 1e-300);
  return normal.ldlt();
}

Lines solved(const LinesSums& sums) {
  return factored(sums.normal).solve(sums.right);
}

/// Whether edges tell a slope: the mean square over all of them of what the five other columns
/// leave of its column (the Schur complement of its element of the normal matrix).
bool tells_slope(const LinesSums& all, std::size_t edges, Eigen::Index slope) {
  const double inverse = factored(all.normal).solve(Lines::Unit(slope))[slope];
  const double least = kMinSpread_px * kMinSpread_px * 1e-6;  // columns are per 1000 px
  return inverse > 0.0 && 1.0 / inverse >= least * static_cast<double>(edges);
}

Estimate with_interval(double value, std::span<const double> without_one) {
  const double reach = 1.96 * jackknife_error(without_one);
  return {.value = value, .low = value - reach, .high = value + reach};
}

/// How offsets grow with the radius, with jackknife intervals over blocks of neighbours.
void set_slopes(std::span<const EdgeOffset> offsets,
                const Vector2d& centre_px,
                RingOffsets& result) {
  std::vector<LinesSums> blocks;
  LinesSums all;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const std::size_t begin = offsets.size() * i / kBlocks;
    const std::size_t end = offsets.size() * (i + 1) / kBlocks;
    blocks.push_back(sums_of(offsets.subspan(begin, end - begin), centre_px));
    all.normal += blocks.back().normal;
    all.right += blocks.back().right;
  }
  const Lines line = solved(all);
  const auto slope = [&](Eigen::Index column) -> std::optional<Estimate> {
    if (!tells_slope(all, offsets.size(), column)) {
      return std::nullopt;
    }
    std::vector<double> without_one;
    for (const LinesSums& block : blocks) {
      without_one.push_back(
          solved({.normal = all.normal - block.normal, .right = all.right - block.right})[column]);
    }
    return with_interval(line[column], without_one);
  };
  result.radial_slope = slope(kRadialSlope);
  result.tangential_slope = slope(kTangentialSlope);
}

}  // namespace

RingOffsets ring_offsets(std::span<const EdgeOffset> offsets,
                         const Vector2d& centre_px,
                         int num_rings) {
  RingOffsets result;
  double reach = 0.0;
  for (const EdgeOffset& edge : offsets) {
    reach = std::max(reach, (edge.at_px - centre_px).norm());
  }
  const double width = (reach + 1e-6) / num_rings;
  for (int i = 0; i < num_rings && reach > 0.0; ++i) {
    OffsetRing ring = {.inner_px = i * width, .outer_px = (i + 1) * width};
    fill_ring(offsets, centre_px, ring);
    result.rings.push_back(ring);
  }
  if (offsets.size() < 4 * kBlocks) {
    return result;
  }
  set_slopes(offsets, centre_px, result);
  return result;
}

}  // namespace glint
