// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the few frames of a scan leave of the stripes in their mean, which the table T(w) of
// clipped_mean.h does not have. Stripes whose phase is linear, gx and gy periods a pixel, reach a
// pixel as
//
//     duty + sum over j of 2 / (pi j) sin(pi j duty) B(j gx) B(j gy) cos(2 pi j (phase - duty / 2))
//
// where B(f) = sinc(f) (w_0 + 2 sum of w_k cos(2 pi k f)) for a box pixel and the weights w_k of
// the blur. The weights' part has period 1 in f: harmonics of whole periods a pixel pass the blur
// (aliasing). Clipped, the wave has all harmonics, and the mean over N frames keeps those of N, 2
// N, ...: a ripple of N times the phase. docs/theory/clipped_mean.md, "Few frames". Own derivation.
#pragma once

#include <array>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/cache.h"
#include "simulator/render/scan/clipped_mean.h"
#include "simulator/render/scan/kept_tables.h"

namespace glint {

/// Keeps what it has computed; not to be shared between threads. What another one of the same
/// sensor and stripes has computed and kept is not computed again.
class ScanRipple {
 public:
  /// As shares of the mean over all phases, noise left out.
  struct Size {
    double deviation = 0.0;  ///< of the mean over the frames, root mean square over the phase
    double bias = 0.0;       ///< T(w) - mean over all phases
  };

  ScanRipple(const Sensor& sensor, const StripeSettings& stripes);

  /// Leaves what was computed to those of the same sensor and stripes that are made later on.
  void keep() const;

  /// Between the nearest cells: 20 for each step of one by which N |g| times the blur's deviation
  /// grows, up to the gradient that moves the ripple by a period a pixel, then as far apart in log
  /// |g|; in directions 10 degrees apart.
  /// @param gx, gy  differences of the phase [periods / px]
  Size at(double gx, double gy);

  /// Whether the ripple stays nearly the same from pixel to pixel, or from every second one to the
  /// next: it does not average out over a picture then.
  bool is_coherent(double gx, double gy) const;

 private:
  static constexpr int kMaxScans = 16;

  /// Of a scan's mean as a function of the phase at which it begins, as shares of their mean.
  struct Wave {
    std::array<double, kMaxScans - 1> amplitudes = {};  ///< of its cosines
    double bias = 0.0;
  };

  /// Scans that begin at phases (scan + 1/2) / (2 count) of a step from one frame to the next.
  struct Scans {
    int count = 0;
    std::vector<double> cosines;    ///< at the phases from the stripe's middle, scan after scan
    std::vector<int> order;         ///< of these phases, by their distance from the middle
    std::vector<double> overtones;  ///< weights of the scans in the j-th, count for each scan

    Scans() = default;
    Scans(int number, int phases);
  };

  using Waves = std::unordered_map<int, Wave>;

  static Cache<TableKey, Waves>& kept_waves();

  /// Of everything that waves depend on.
  TableKey key() const;

  /// Whether harmonics near the ripple may be of whole periods a pixel.
  bool is_aliased(double gx, double gy) const;
  const Wave& of_cell(int cell, int direction);
  Wave wave_at(double gx, double gy, const Scans& scans);
  Wave sharp_wave() const;
  double missed_at_kinks() const;
  void start(int count, std::vector<double>& terms);
  void transfer(double g, std::vector<double>& terms);

  StripeSettings stripes_;
  double slope_;   ///< of the grey value by the share of bright stripes
  double offset_;  ///< grey value of dark stripes
  double floor_;   ///< grey value where the blur is cut off; none is lower
  double variance_px2_;
  double cells_per_turn_;
  std::vector<double> weights_;  ///< of the blur: its centre, then both sides
  Scans smooth_, sharp_;
  std::vector<double> shares_, values_, harmonics_, terms_, cosines_of_g_, blur_;
  std::shared_ptr<const Waves> known_;  ///< by cell; empty: none
  Waves waves_;                         ///< others
};

}  // namespace glint
