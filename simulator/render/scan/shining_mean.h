// SPDX-License-Identifier: GPL-3.0-or-later
//
// T(w) of clipped_mean.h where the radiance D of dark stripes depends on the place
// (simulator/light/tunnel/dark_radiance.h). D changes little over the reach of the blur, so a pixel
// sees stripes of its own D: T(w, D), from tables T(w) at multiples of 1 / 64 of D and a cubic
// through four of them. docs/theory/clipped_mean.md, "Dark stripes that shine".
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "simulator/render/scan/clipped_mean.h"

namespace glint {

/// Four neighbouring levels of dark radiance, and what each counts at a radiance between them.
struct DarkStencil {
  int first = 0;  ///< level; a level k is the radiance k / ShiningMean::kLevels
  std::array<double, 4> weight = {};
  std::array<double, 4> slope = {};  ///< of the weights, by the dark radiance
};

/// Immutable; safe to share between threads.
class ShiningMean {
 public:
  static constexpr int kLevels = 64;  ///< for a dark radiance of 1, that of bright stripes

  /// A quantity at each level: cubic pieces as ClippedMean::coefficients() has them.
  using Pieces = std::vector<std::vector<float>>;

  struct Value {
    double value = 0.0;
    double by_width = 0.0;  ///< derivatives
    double by_dark = 0.0;
  };

  /// Tables for dark radiances from `lowest` to `highest`, both in [0, 1].
  /// @param stripes  their own dark radiance does not matter
  ShiningMean(const SensorSettings& sensor,
              const StripeSettings& stripes,
              double lowest,
              double highest);

  /// Catmull and Rom's cubic; at the ends, where one of its four levels is missing, with what the
  /// parabola through the three others has there.
  static DarkStencil stencil_of(double dark);

  static double dark_of(int level) { return static_cast<double>(level) / kLevels; }

  int first_level() const { return first_level_; }

  int num_levels() const { return static_cast<int>(levels_.size()); }

  const ClippedMean& table(int level) const {
    return *levels_[static_cast<std::size_t>(level - first_level_)];
  }

  /// @param dark  within the radiances that the tables are for
  double mean(double w, double dark) const { return value_of(means_, w, stencil_of(dark)).value; }

  double deviation(double w, double dark) const;

  /// mean() and deviation() for a row of pixels where the mask is set, those without light
  /// elsewhere.
  void look_up(const unsigned char* mask,
               const float* w,
               const float* dark,
               int count,
               float* mean,
               float* deviation) const;

  /// No frame is ever below full scale.
  bool is_saturated(double w, double dark) const;

  const Pieces& means() const { return means_; }

  /// @param pieces  of first_level() and all others
  Value value_of(const Pieces& pieces, double w, const DarkStencil& stencil) const;

 private:
  double dark_level() const { return levels_.front()->dark_level(); }  ///< where there is no light

  double dark_deviation() const { return levels_.front()->dark_deviation(); }

  /// Of up to kRun pixels between the same levels. @param cell  the lower one of them
  void look_up_alike(int cell,
                     const unsigned char* mask,
                     const float* w,
                     const float* dark,
                     int count,
                     float* mean,
                     float* deviation) const;
  void look_up_each(const unsigned char* mask,
                    const float* w,
                    const float* dark,
                    int count,
                    float* mean,
                    float* deviation) const;

  int first_level_ = 0;
  std::vector<std::shared_ptr<const ClippedMean>> levels_;
  Pieces means_;
  std::vector<double> saturated_from_;  ///< dark radiance, by width at the tables' nodes
};

}  // namespace glint
