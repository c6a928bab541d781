// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a point of rough metal shows of a fringe tunnel at every position of its stripes, without
// noise: the integral over all directions of reflectance times the wall's radiance. The stripes are
// a Fourier series in their phase q, so what has to be known of a point are a few numbers,
//
//   radiance at shift s = dark + duty even
//                         + sum over harmonics m of  2 Re( c_m e^(2 pi i m (q0 - s) / period) Z_m )
//   Z_m = integral of  reflectance (1 - dark radiance) e^(2 pi i m (q - q0) / period)
//
// with q0 the phase where the mirrored ray meets the wall and c_m the series of the stripes. Z_m
// changes slowly from point to point, the phase q0 quickly: so one is interpolated and the other
// belongs to each ray (blurred_pixels.h). docs/theory/blurred.md
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/blurred/lobe_kernels.h"
#include "simulator/render/blurred/lobe_shape.h"

namespace glint {

/// The same for all points. Immutable.
class StripeResponse {
 public:
  /// @param middle_x_mm  where the wall's middle stands along x; its ends do not move
  /// @param harmonics    from harmonics_for()
  StripeResponse(const Tunnel& tunnel,
                 const ConductorNumbers& metal,
                 double middle_x_mm,
                 const HarmonicList& harmonics);

  const HarmonicList& harmonics() const { return harmonics_; }

  /// Numbers of a point: dark, even, then real and imaginary parts of all Z_m.
  std::size_t size() const { return 2 + 2 * static_cast<std::size_t>(harmonics_.count); }

  /// @param phase_mm  q0: pattern coordinate that Z_m count from
  /// @param numbers   size() of them; 0 where the viewer sees the surface's back
  void at(const BlurredPoint& point, double phase_mm, std::span<float> numbers) const;

 private:
  /// Directions in the cross-section's plane, which rows of directions stand on.
  struct Planes;

  std::vector<double> wall_ends(const Eigen::Vector2d& from) const;
  void choose_planes(const BlurredPoint& point, const LobeShape& shape, Planes& planes) const;
  void add_planes(
      const LobeShape& shape, double from_rad, double to_rad, int count, Planes& planes) const;
  void intersect_wall(const BlurredPoint& point, Planes& planes) const;
  LobeRow row_of(const BlurredPoint& point,
                 const LobeShape& shape,
                 const Planes& planes,
                 std::size_t index,
                 double phase_mm) const;
  LobeFrame frame_of(const BlurredPoint& point, const LobeShape& shape) const;

  const Tunnel& tunnel_;
  const ConductorNumbers& metal_;
  double middle_x_mm_;
  HarmonicList harmonics_;
  ColumnRule columns_;
  std::vector<Eigen::Vector2d> corners_;  ///< (y, z) where lit pieces of the cross-section end
  double along_x_;                        ///< cosine of the stripes' orientation
  double along_arc_;                      ///< sine
  bool has_details_;                      ///< the place across the tunnel matters
};

/// How many harmonics the narrowest of some lobes leaves of the stripes: beyond them less than
/// 2e-4 of full scale.
/// @param width_mm  of the lobe on the wall, along the stripes' normal; > 0
/// @throws ConfigError "render.method" for more than kMaxHarmonics
HarmonicList harmonics_for(const TunnelSettings& tunnel, double width_mm);

/// 2 c_m e^(-2 pi i m shift / period) for each harmonic: what a frame multiplies waves by.
std::vector<std::complex<float>> wave_factors(const HarmonicList& harmonics,
                                              const TunnelSettings& tunnel,
                                              double shift_mm);

}  // namespace glint
