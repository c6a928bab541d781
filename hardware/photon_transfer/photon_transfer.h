// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a sensor is, from its mean and its noise at several levels of light (photon transfer).
//
//   variance = K mean + K^2 read_noise^2 - K offset + 1/12      all in DN and electrons
//
// A weighted affine fit of variance against mean: the slope is K. Dark levels lie on the same line,
// since electrons of dark current have shot noise as all others; but not where rounding or code 0
// cut their noise off, as without a black level.
// Source: EMVA Standard 1288, release 4.0 Linear; docs/theory/sensor_calibration.md.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hardware/photon_transfer/level_statistics.h"

namespace glint {

/// y = offset + slope x.
struct LineFit {
  double offset = 0.0;
  double slope = 0.0;
  double slope_sigma =
      0.0;  ///< from the scatter about the line where that is larger than the weights say
  int points = 0;
};

/// Weighted least squares. At least 2 points with different x.
/// @param weight  of each point, > 0
/// @param sigma   of each y, > 0
LineFit fitted_line(std::span<const double> x,
                    std::span<const double> y,
                    std::span<const double> weight,
                    std::span<const double> sigma);

struct PhotonTransfer {
  LineFit fit;  ///< of temporal variance against mean; its slope is K, DN per electron
  std::vector<bool> is_fitted;     ///< of each level
  double full_scale_dn = 0.0;      ///< largest code
  double saturation_dn = 0.0;      ///< mean at which the variance is largest
  bool has_saturated = false;      ///< else saturation_dn is the full scale
  double dark_mean_dn = 0.0;       ///< mean over the dark levels
  double dark_variance_dn2 = 0.0;  ///< likewise
  double dark_rate_dn = 0.0;       ///< growth of the dark mean with exposure, per its unit
  double full_scale_e = 0.0;       ///< electrons at the largest code
  double saturation_e = 0.0;       ///< electrons of light at saturation
  double dark_e = 0.0;             ///< electrons that make the dark mean
  /// So that the dark variance comes out with dark_e. Of one below 0.24 DN^2 an upper bound: as of
  /// 0.24 DN^2, EMVA 1288.
  double read_noise_e = 0.0;
  double dark_noise_e = 0.0;  ///< square root of the dark variance without rounding; likewise
  LineFit response;           ///< mean without dark mean against exposure, 5 to 95 % of saturation
  /// Mean of light over exposure, 5 to 70 % of saturation; 0: the levels do not differ in exposure.
  double rate_dn = 0.0;
  std::optional<double> linearity_error;  ///< mean deviation from response, share of the value
  double responsivity_dn = 0.0;           ///< DN per photon; 0: photons not known
  double quantum_efficiency = 0.0;        ///< 0: photons not known
  double photo_response_nonuniformity =
      0.0;                            ///< PRNU at the level nearest to half saturation, share
  double dark_nonuniformity_e = 0.0;  ///< DSNU
  double largest_snr = 0.0;           ///< at saturation
  double dynamic_range = 0.0;         ///< saturation over the least signal that equals its noise
  std::vector<std::string> warnings;
};

/// Levels above 70 % of saturation do not count, nor dark ones with a variance below 0.24 DN^2 or
/// more than 0.5 % of the pixels at code 0.
/// @param levels  in any order
/// @throws ConfigError: no dark level, fewer than 3 bright levels below 70 % of saturation, noise
///         that does not grow with the mean, a bright level whose pictures are all alike
PhotonTransfer photon_transfer(std::span<const LevelStatistics> levels, double full_scale_dn);

}  // namespace glint
