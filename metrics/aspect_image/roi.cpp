// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/roi.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

constexpr float kWhole = 1.0f - 1e-6f;  // sums of footprint weights round

/// Clears values that have an outside value within `rim_px` along a line.
void erode_line(const unsigned char* in, unsigned char* out, int count, int stride, int rim_px) {
  int last_outside = -1;
  for (int pass = 0; pass < 2; ++pass) {
    last_outside = pass == 0 ? -1 : count;
    for (int i = 0; i < count; ++i) {
      const int at = pass == 0 ? i : count - 1 - i;
      if (in[at * stride] == 0) {
        last_outside = at;
      }
      if (std::abs(at - last_outside) <= rim_px) {
        out[at * stride] = 0;
      }
    }
  }
}

}  // namespace

Mask whole_pixels(const ImageF& coverage) {
  Mask mask(coverage.width(), coverage.height());
  std::transform(
      coverage.values().begin(), coverage.values().end(), mask.values().begin(), [](float share) {
        return static_cast<unsigned char>(share >= kWhole ? 1 : 0);
      });
  return mask;
}

Mask eroded(const Mask& mask, int rim_px) {
  if (rim_px <= 0 || mask.empty()) {
    return mask;
  }
  Mask along_rows = mask;
  for (int y = 0; y < mask.height(); ++y) {
    erode_line(mask.row(y), along_rows.row(y), mask.width(), 1, rim_px);
  }
  Mask result = along_rows;
  for (int x = 0; x < mask.width(); ++x) {
    erode_line(along_rows.row(0) + x, result.row(0) + x, mask.height(), mask.width(), rim_px);
  }
  return result;
}

void exclude_defects(Mask& mask, std::span<const DefectView> defects, double radii) {
  for (const DefectView& defect : defects) {
    for (int y = 0; y < defect.distance.height(); ++y) {
      for (int x = 0; x < defect.distance.width(); ++x) {
        if (static_cast<double>(defect.distance(x, y)) <= radii) {
          mask(defect.left_px + x, defect.top_px + y) = 0;
        }
      }
    }
  }
}

std::size_t count_inside(const Mask& mask) {
  return static_cast<std::size_t>(
      std::count_if(mask.values().begin(), mask.values().end(), [](auto v) { return v != 0; }));
}

Mask region_of_interest(const ImageF& coverage,
                        std::span<const DefectView> defects,
                        const MetricsSettings& settings) {
  const Mask whole = whole_pixels(coverage);
  const std::size_t on_part = count_inside(whole);
  if (on_part == 0) {
    throw ConfigError("camera.object_pixel_mm",
                      "no pixel lies wholly on the part, the camera must see the part at "
                      "more than "
                      "a pixel");
  }
  Mask region = eroded(whole, settings.erosion_px);
  exclude_defects(region, defects, settings.exclusion_radii);
  if (count_inside(region) == 0) {
    throw ConfigError("metrics.erosion_px",
                      fmt::format("no pixel is left of {} on the part after "
                                  "metrics.erosion_px = {} and {} "
                                  "defects with metrics.exclusion_radii = {}, at least one must be",
                                  on_part,
                                  settings.erosion_px,
                                  defects.size(),
                                  settings.exclusion_radii));
  }
  return region;
}

}  // namespace glint
