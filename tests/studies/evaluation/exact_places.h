// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "simulator/light/tunnel/dark_radiance.h"
#include "tests/studies/imaging/exact_wall.h"

namespace glint {

/// The program's hits, in float and partly interpolated, less exact ones: x, y and margin.
struct HitErrors {
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::vector<Eigen::Vector3d>> refined;
};

/// Hits at the corners of a cell.
using Corners = std::array<ExactPlace, 4>;

/// Margins below this are no places on the wall.
inline constexpr double kLowestMargin_mm = -1e20;

inline double lowest_of(const Corners& c) {
  return std::min({c[0].margin_mm, c[1].margin_mm, c[2].margin_mm, c[3].margin_mm});
}

/// Without a corner that meets light.
inline bool is_dark(const Corners& corners, double half_slot_mm) {
  return std::ranges::all_of(corners, [](const ExactPlace& p) { return p.margin_mm < 0.0; }) ||
         std::ranges::all_of(corners,
                             [&](const ExactPlace& p) { return std::abs(p.y_mm) < half_slot_mm; });
}

/// The light of dark stripes over the pixel whose rays these are: the mean over those that meet the
/// wall.
inline double exact_mean_dark(const DarkRadiance& dark,
                              std::span<const ExactPlace> places,
                              std::span<const float> weights) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (weights[i] > 0.0F && places[i].margin_mm > kLowestMargin_mm) {
      sum += dark.at(places[i].y_mm, places[i].margin_mm);
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace glint
