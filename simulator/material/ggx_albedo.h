// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "simulator/material/compensation_sampler.h"
#include "simulator/material/direction_table.h"
#include "simulator/material/quadrature.h"

namespace glint {

/// The share of light that a white GGX surface returns after one reflection. The rest is reflected
/// again between microfacets; a material adds it back (conductor.h).
///
/// Holds one table for each of a row of widths, `scale` times the lowest one, for surfaces whose
/// roughness varies from point to point while its anisotropy stays. Building one takes 5 to 15 ms.
class GgxAlbedo {
 public:
  /// @param lowest     widths at scale 1
  /// @param max_scale  >= 1; 1: no variation
  explicit GgxAlbedo(const GgxAlpha<double>& lowest, double max_scale = 1.0);

  /// @param scale  clamped to [1, max_scale]
  double at(const LocalDirection& direction, double scale) const;

  /// Over all directions, weighted with the cosine; of the same interpolation as at().
  double average(double scale) const;

  /// For the light that one reflection does not return, of the nearest width kept.
  const CompensationSampler& losses(double scale) const;

  const GgxAlpha<double>& lowest() const { return lowest_; }

  /// Where the roughness does not vary; else null.
  const DirectionTable* only_table() const { return tables_.size() == 1 ? &tables_[0] : nullptr; }

 private:
  CubicStencil stencil_at(double scale) const;

  GgxAlpha<double> lowest_;
  double step_ = 0.0;  ///< of log(scale) between tables
  std::vector<DirectionTable> tables_;
  std::vector<CompensationSampler> losses_;  ///< one for each table
};

/// One direction of it, by integration over the visible normals: `rule` squared points, exact to
/// about 1 / points.
double ggx_single_albedo(const GgxAlpha<double>& alpha,
                         const LocalDirection& to_viewer,
                         const Quadrature& rule);

}  // namespace glint
