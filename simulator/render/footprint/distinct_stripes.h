// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace glint {

/// Which stripes the frames of a scan show. Those that have moved by whole periods are the same;
/// and at a duty of one half those half a period apart are bright where the others are dark: the
/// two add up to what a tunnel would show that is bright and dark throughout. So half of the frames
/// follow from the others, under even light and where the tunnel's ends pass nothing.
struct DistinctStripes {
  struct Frame {
    std::size_t source = 0;    ///< index into shift_periods
    bool is_opposite = false;  ///< bright where the source is dark
  };

  std::vector<double> shift_periods;  ///< of the sources, in [0, 1)
  std::vector<Frame> frames;
  /// Where there are opposite frames: the source that is opposite to the first one.
  std::size_t opposite_of_first = 0;

  /// One frame of its own stripes.
  DistinctStripes() : shift_periods(1), frames(1) {}

  /// Each frame of its own stripes.
  explicit DistinctStripes(std::vector<double> shifts);

  /// @param shifts  in periods, frame by frame, in even steps, each in [0, 1); at least one
  DistinctStripes(const std::vector<double>& shifts, double duty);

  /// Appends the radiance of a place in each frame.
  /// @param of_sources  its radiance under the stripes of each source
  void expand(const double* of_sources, std::vector<float>& values) const;
};

}  // namespace glint
