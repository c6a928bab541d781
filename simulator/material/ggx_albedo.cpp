// SPDX-License-Identifier: GPL-3.0-or-later
//
// The albedo of one reflection is the mean of G2 / G1 over visible normals, so that the integrand
// is bounded by 1 at every width: Gauss-Legendre in one number, midpoints in the other, 80 x 80 for
// each of the table's directions, or 40 x 40 where unequal widths need more directions. Where the
// roughness of a surface varies, tables stand in even steps of log(width), two an octave, and four
// of them are blended. docs/theory/materials.md
#include "simulator/material/ggx_albedo.h"

#include "simulator/material/quadrature.h"

namespace glint {
namespace {

/// Tables in each doubling of the width.
constexpr double kTablesPerOctave = 2.0;

/// Points along either axis of the integral over visible normals, whose integrand has a kink at the
/// horizon. Equal widths need one column of directions only and are asked for more.
constexpr int kNodesOfEqualWidths = 80;
constexpr int kNodes = 40;

}  // namespace

double ggx_single_albedo(const GgxAlpha<double>& alpha,
                         const LocalDirection& to_viewer,
                         const Quadrature& rule) {
  const std::size_t angles = rule.nodes.size();
  // Seen along a principal axis, one half of the normals is like the other.
  const bool is_symmetric = to_viewer.y == 0.0;
  const double turn = is_symmetric ? 0.5 : 1.0;
  const double step = turn / static_cast<double>(angles);
  double sum = 0.0;
  for (std::size_t i = 0; i < angles; ++i) {
    for (std::size_t a = 0; a < angles; ++a) {
      const double u = step * (static_cast<double>(a) + 0.5);
      const LocalDirection normal = ggx_sample_normal(alpha, to_viewer, u, rule.nodes[i]);
      const LocalDirection to_light = reflect(to_viewer, normal);
      if (to_light.z > 0.0) {
        sum += rule.weights[i] * ggx_weight(alpha, to_viewer, to_light);
      }
    }
  }
  return std::min(1.0, sum / static_cast<double>(angles));
}

GgxAlbedo::GgxAlbedo(const GgxAlpha<double>& lowest, double max_scale) : lowest_(lowest) {
  int count = 1;
  if (max_scale > 1.0) {
    count = std::max(4, 1 + static_cast<int>(std::ceil(kTablesPerOctave * std::log2(max_scale))));
    step_ = std::log(max_scale) / (count - 1);
  }
  const Quadrature rule = gauss_legendre(lowest.x == lowest.y ? kNodesOfEqualWidths : kNodes);
  for (int i = 0; i < count; ++i) {
    const double scale = std::exp(step_ * i);
    const GgxAlpha<double> alpha = {lowest.x * scale, lowest.y * scale};
    tables_.emplace_back(alpha, [&](const LocalDirection& to_viewer) {
      return ggx_single_albedo(alpha, to_viewer, rule);
    });
    losses_.emplace_back(tables_.back(), std::sqrt(alpha.x * alpha.y));
  }
}

CubicStencil GgxAlbedo::stencil_at(double scale) const {
  return cubic_stencil(std::log(std::max(1.0, scale)) / step_, static_cast<int>(tables_.size()));
}

double GgxAlbedo::at(const LocalDirection& direction, double scale) const {
  if (tables_.size() == 1) {
    return tables_.front().at(direction);
  }
  const CubicStencil stencil = stencil_at(scale);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto table = static_cast<std::size_t>(stencil.first) + i;
    sum += stencil.weights[i] * tables_[table].at(direction);
  }
  return sum;
}

const CompensationSampler& GgxAlbedo::losses(double scale) const {
  if (losses_.size() == 1) {
    return losses_.front();
  }
  const double place = std::round(std::log(std::max(1.0, scale)) / step_);
  return losses_[std::min(static_cast<std::size_t>(place), losses_.size() - 1)];
}

double GgxAlbedo::average(double scale) const {
  if (tables_.size() == 1) {
    return tables_.front().average();
  }
  const CubicStencil stencil = stencil_at(scale);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += stencil.weights[i] * tables_[static_cast<std::size_t>(stencil.first) + i].average();
  }
  return sum;
}

}  // namespace glint
