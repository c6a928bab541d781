// SPDX-License-Identifier: GPL-3.0-or-later
//
// How sure a comparison of two methods on the same seeds is: a paired bootstrap.
#pragma once

#include <vector>

namespace glint::quality {

/// Scores of two methods on one task; entry i of both is of the same seed.
struct Pairs {
  std::vector<double> own;
  std::vector<double> peer;
};

/// Mean over tasks of the means over seeds.
struct Means {
  double own = 0.0;
  double peer = 0.0;
};

Means means_of(const std::vector<Pairs>& tasks);

/// Upper ends of the 95 % intervals (percentiles of 2,000 resamples, always the same ones) of own /
/// peer and own - peer. Seeds are drawn anew within each task, for both methods alike.
struct UpperEnds {
  double ratio = 0.0;
  double difference = 0.0;
};

/// @param tasks  none of them empty
UpperEnds upper_ends(const std::vector<Pairs>& tasks);

}  // namespace glint::quality
