// SPDX-License-Identifier: GPL-3.0-or-later
//
// The exposure that all designs share, and whose lights have another power, as far as noise and
// rounding to the camera's steps let it be told. Rules: docs/validate.md, "Dark designs". Private
// to the room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "studies/validate/validate_verdict.h"

namespace glint::validate_detail {

inline constexpr double kSigmas = 4.0;        ///< below that a change of grey values is noise
inline constexpr double kMinExposure = 0.01;  ///< smaller changes are nobody's concern
inline constexpr double kMinPower = 0.03;
inline constexpr double kMinLightMm = 0.5;
inline constexpr double kMinRoughness = 0.03;
inline constexpr double kMinBlurPx = 0.3;
inline constexpr std::size_t kMinVoices = 3;  ///< of which one that is wrong is outvoted

/// Whether rounding leaves too little of a design to tell a wrong power by.
inline bool is_rounded_away(const GreyFit& fit) {
  return fit.is_known && fit.rounding > kMaxRounding;
}

/// Exposures of the whole cell at which a design's own would be rounding alone.
struct ExposureRange {
  double low = 0.0;
  double high = 0.0;
};

/// @param common  exposure of the cell, about; a dark cell is rounded by larger shares
inline ExposureRange range_of(const GreyFit& fit, double common) {
  const double share = fit.rounding > 0.0 ? fit.rounding / std::min(1.0, common) : 0.0;
  const double exposure = fit.change.exposure;
  return {.low = exposure / (1.0 + share),
          .high = share < 1.0 ? exposure / (1.0 - share) : std::numeric_limits<double>::infinity()};
}

/// Fits whose exposures are compared, by rising exposure: those that rounding changes by 1 % at
/// most while these are three, else the three that it changes least.
inline std::vector<const GreyFit*> voices_of(std::span<const DesignGrey> designs) {
  std::vector<const GreyFit*> fits;
  for (const DesignGrey& grey : designs) {
    if (grey.fit.is_known) {
      fits.push_back(&grey.fit);
    }
  }
  std::ranges::stable_sort(fits, {}, [](const GreyFit* fit) { return fit->rounding; });
  const auto sharp = static_cast<std::size_t>(std::ranges::count_if(
      fits, [](const GreyFit* fit) { return fit->rounding <= kMinExposure; }));
  fits.resize(std::min(fits.size(), std::max(sharp, kMinVoices)));
  std::ranges::stable_sort(fits, {}, [](const GreyFit* fit) { return fit->change.exposure; });
  return fits;
}

/// The design whose exposure is taken for that of the cell: the middle one, of two middle ones that
/// nearer to 1; or one that differs from it by no more than rounding and is rounded less.
/// @return null: no design is known
inline const GreyFit* common_fit(std::span<const DesignGrey> designs) {
  const std::vector<const GreyFit*> fits = voices_of(designs);
  if (fits.empty()) {
    return nullptr;
  }
  const auto distance = [](const GreyFit* fit) { return std::abs(fit->change.exposure - 1.0); };
  const GreyFit* middle = std::min(
      fits[fits.size() / 2], fits[(fits.size() - 1) / 2], [&](const auto* a, const auto* b) {
        return distance(a) < distance(b);
      });
  const ExposureRange around = range_of(*middle, 1.0);
  const GreyFit* sharpest = middle;
  for (const GreyFit* fit : fits) {
    const ExposureRange own = range_of(*fit, 1.0);
    if (own.low <= around.high && own.high >= around.low &&
        std::max(fit->rounding, kMinExposure) < sharpest->rounding) {
      sharpest = fit;
    }
  }
  return sharpest;
}

/// Standard deviation of a design's exposure over that of the cell. Of one fit both have the same
/// exposure, so that only their powers differ.
inline double sigma_of_power(const GreyFit& fit, const GreyFit& common) {
  if (fit.is_joint && common.is_joint) {
    return std::hypot(fit.power_sigma, fit.power / common.power * common.power_sigma) /
           common.power;
  }
  const double ratio = fit.change.exposure / common.change.exposure;
  return std::hypot(sigma_of_exposure(fit), ratio * sigma_of_exposure(common)) /
         common.change.exposure;
}

/// Whether a design's exposure differs from the cell's beyond noise, and by more than 3 % and what
/// rounding may do to both.
inline bool has_other_power(const GreyFit& fit, const GreyFit& common) {
  const double change = std::abs(fit.change.exposure / common.change.exposure - 1.0);
  if (change < kSigmas * sigma_of_power(fit, common)) {
    return false;
  }
  const ExposureRange own = range_of(fit, common.change.exposure);
  const ExposureRange cell = range_of(common, common.change.exposure);
  return own.low > (1.0 + kMinPower) * cell.high || own.high < (1.0 - kMinPower) * cell.low;
}

}  // namespace glint::validate_detail
