// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/pixel_dark.h"

#include <algorithm>

namespace glint {

double mean_dark(const DarkRadiance& dark,
                 const WallHits& hits,
                 const float* weight,
                 std::span<const std::size_t> rays) {
  double sum = 0.0;
  int count = 0;
  for (const std::size_t ray : rays) {
    if (has_place(hits, weight, ray)) {
      sum += dark.at(static_cast<double>(hits.y_mm[ray]), static_cast<double>(hits.margin_mm[ray]));
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

void add_mean_dark_gradient(const DarkRadiance& dark,
                            const WallHits& hits,
                            const float* weight,
                            std::span<const std::size_t> rays,
                            double factor,
                            std::span<double> by_nodes,
                            const HitDerivatives& by_hits) {
  const auto count =
      std::ranges::count_if(rays, [&](std::size_t ray) { return has_place(hits, weight, ray); });
  if (count == 0) {
    return;
  }
  const double share = factor / static_cast<double>(count);
  for (const std::size_t ray : rays) {
    if (!has_place(hits, weight, ray)) {
      continue;
    }
    const auto y_mm = static_cast<double>(hits.y_mm[ray]);
    const auto place = dark.place_of(y_mm, static_cast<double>(hits.margin_mm[ray]));
    dark.add_gradient(place, share, by_nodes);
    const double slope = share * dark.slope_at(place);
    by_hits.y[ray] += static_cast<float>((y_mm < 0.0 ? -slope : slope) * place.by_y);
    by_hits.margin[ray] += static_cast<float>(slope * place.by_margin);
  }
}

}  // namespace glint
