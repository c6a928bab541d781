// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each tile of 32 x 8 pixels is given by the one in the middle of those that the table has: what
// few frames leave there, and how wrong T(w) is (scan_ripple.h). What that may do to h follows from
// the spread of the whole picture, dark pixels included: a ripple that scatters is added to it in
// squares, so beside a large spread it hardly counts. docs/theory/clipped_mean.md, "Few frames".
// Cost: a pass over the mask and a look-up per tile. Memory: some 100 bytes per tile.
#include "simulator/render/scan/ripple_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "core/image/mask_kernels.h"
#include "simulator/render/scan/scan_ripple.h"

namespace glint {
namespace {

/// Largest error of h that few frames may cause in all pixels of the table together: half of the
/// promised 0.1 point, and a tenth more, since the errors of tiles partly cancel.
constexpr double kLargestEffect = 5.5e-4;

/// All of the table's pixels go to the frames where more than this share of them would go, and
/// frames would then cover more than this share of the region.
constexpr double kLargestPart = 0.5;

/// Share by which a ripple's size is uncertain, and what it adds to h_abs by not being normal.
constexpr double kUnknownShare = 0.1;

/// Share of the correction of T(w) that may be wrong.
constexpr double kUnknownCorrection = 0.3;

struct Tile {
  int column = 0;
  int row = 0;
  int pixels = 0;  ///< taken from the table
  bool is_coherent = false;
  double mean = 0.0;  ///< over the frames
  double bias = 0.0;  ///< of T(w), as a share of it
  double deviation = 0.0;
  double effect = 0.0;  ///< on h, at most
};

/// Mean and standard deviation of the region's grey values.
struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
};

class RippleTiles {
 public:
  RippleTiles(const Footprints& footprints, const Sensor& sensor, ScanPlan& plan)
      : footprints_(footprints),
        sensor_(sensor),
        plan_(plan),
        stripes_(stripes_of(footprints.positions(), plan.reflectance)) {}

  void sort(int region_pixels) {
    find_tiles();
    for (const auto& [level, ripple] : ripples_) {
      ripple.keep();
    }
    find_effects(find_spread(region_pixels), region_pixels);
    std::ranges::sort(
        tiles_, std::ranges::greater(), [](const Tile& tile) { return tile.effect / tile.pixels; });
    const std::size_t taken = count_disturbing(region_pixels);
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      const Tile& tile = tiles_[i];
      if (i < taken) {
        take_by_frames(tile);
      } else {
        plan_.ripple(tile.column, tile.row) = static_cast<float>(tile.deviation);
        plan_.correction(tile.column, tile.row) = static_cast<float>(1.0 / (1.0 + tile.bias));
      }
    }
  }

 private:
  int left(int column) const { return column * kRippleTileWidth_px; }

  int width_of(int column) const {
    return std::min(kRippleTileWidth_px, static_cast<int>(plan_.by_table.width()) - left(column));
  }

  int top(int row) const { return row * kRippleTileHeight_px; }

  int height_of(int row) const {
    return std::min(kRippleTileHeight_px, static_cast<int>(plan_.by_table.height()) - top(row));
  }

  const unsigned char* row_of(int column, int row, int y) const {
    return plan_.by_table.row(top(row) + y) + left(column);
  }

  void find_tiles() {
    for (int row = 0; row < plan_.ripple.height(); ++row) {
      for (int column = 0; column < plan_.ripple.width(); ++column) {
        std::array<int, kRippleTileHeight_px> counts = {};
        int pixels = 0;
        for (int y = 0; y < height_of(row); ++y) {
          counts[static_cast<std::size_t>(y)] =
              mask_kernels::count_ones(row_of(column, row, y), width_of(column));
          pixels += counts[static_cast<std::size_t>(y)];
        }
        if (pixels > 0) {
          add_tile(column, row, pixels, counts);
        }
      }
    }
  }

  /// By the pixel in the middle of its middle row.
  void add_tile(int column,
                int row,
                int pixels,
                const std::array<int, kRippleTileHeight_px>& counts) {
    int y = 0;
    for (int before = pixels / 2; before >= counts[static_cast<std::size_t>(y)]; ++y) {
      before -= counts[static_cast<std::size_t>(y)];
    }
    const unsigned char* by_table = row_of(column, row, y);
    int x = 0;
    for (int before = counts[static_cast<std::size_t>(y)] / 2; before >= by_table[x]; ++x) {
      before -= by_table[x];
    }
    x += left(column);
    y += top(row);
    const auto [gx, gy] = phase_gradient(x, y);
    const ScanRipple::Size size = ripple_at(x, y, gx, gy);
    const double mean = table_at(x, y) / (1.0 + size.bias);
    tiles_.push_back({.column = column,
                      .row = row,
                      .pixels = pixels,
                      .is_coherent = ripples_.begin()->second.is_coherent(gx, gy),
                      .mean = mean,
                      .bias = size.bias,
                      .deviation = size.deviation * mean});
  }

  double table_at(int x, int y) const {
    const auto w = static_cast<double>(plan_.width(x, y));
    return plan_.table ? plan_.table->mean(w)
                       : plan_.shining->mean(w, static_cast<double>(plan_.dark(x, y)));
  }

  /// Of dark stripes that shine as at a pixel: between the levels on both sides of its radiance.
  ScanRipple::Size ripple_at(int x, int y, double gx, double gy) {
    if (!plan_.shining) {
      return ripples_.try_emplace(0, sensor_, stripes_).first->second.at(gx, gy);
    }
    const double place = static_cast<double>(plan_.dark(x, y)) * ShiningMean::kLevels;
    const int level = std::clamp(static_cast<int>(place), 0, ShiningMean::kLevels - 1);
    const double t = place - level;
    const ScanRipple::Size low = ripple_of(level).at(gx, gy);
    const ScanRipple::Size high = ripple_of(level + 1).at(gx, gy);
    return {.deviation = (1.0 - t) * low.deviation + t * high.deviation,
            .bias = (1.0 - t) * low.bias + t * high.bias};
  }

  ScanRipple& ripple_of(int level) {
    StripeSettings stripes = stripes_;
    stripes.dark = ShiningMean::dark_of(level);
    return ripples_.try_emplace(level, sensor_, stripes).first->second;
  }

  /// [periods / px]
  std::pair<double, double> phase_gradient(int x, int y) const {
    const std::size_t corner_width = static_cast<std::size_t>(footprints_.rays().width_px) + 1;
    const float* top = footprints_.hits().stripes_mm().data() +
                       static_cast<std::size_t>(y) * corner_width + static_cast<std::size_t>(x);
    const float* bottom = top + corner_width;
    const double per_mm = 0.5 / footprints_.positions().period_mm;
    const auto of = [&](float difference) { return per_mm * static_cast<double>(difference); };
    return {of(top[1] - top[0] + (bottom[1] - bottom[0])),
            of(bottom[0] - top[0] + (bottom[1] - top[1]))};
  }

  int count_by_frames() const {
    return mask_kernels::count_ones(plan_.by_frames.values().data(),
                                    static_cast<int>(plan_.by_frames.size()));
  }

  /// Pixels by frames are taken to be like the others; those that neither form gives are dark.
  Spread find_spread(int region_pixels) const {
    double count = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (const Tile& tile : tiles_) {
      count += tile.pixels;
      sum += tile.pixels * tile.mean;
      squares += tile.pixels * (tile.mean * tile.mean + tile.deviation * tile.deviation);
    }
    if (sum <= 0.0) {
      return {};
    }
    count += std::max(0.0, region_pixels - count - count_by_frames());
    const double mean = sum / count;
    return {.mean = mean, .deviation = std::sqrt(std::max(0.0, squares / count - mean * mean))};
  }

  /// A ripple that scatters is added in squares to the picture's own spread, and a share of that is
  /// unknown. A coherent one may go with it, as may an error of the table.
  void find_effects(const Spread& spread, int region_pixels) {
    for (Tile& tile : tiles_) {
      if (tile.mean <= 0.0) {
        continue;
      }
      const double r = tile.deviation;
      const double from_mean = tile.mean - spread.mean;
      const double to_rms = r * r / std::max(spread.deviation, r);
      const double to_abs = r > 0.0 ? r * std::exp(-0.5 * from_mean * from_mean / (r * r)) : 0.0;
      const double scattered = kUnknownShare * std::max(to_rms, to_abs);
      const double error = kUnknownCorrection * std::abs(tile.bias) * tile.mean;
      tile.effect = ((tile.is_coherent ? tile.deviation : scattered) + error) * tile.pixels /
                    (region_pixels * spread.mean);
    }
  }

  /// How many of the first tiles must go.
  std::size_t count_disturbing(int region_pixels) const {
    double effect = 0.0;
    double pixels = 0.0;
    for (const Tile& tile : tiles_) {
      effect += tile.effect;
      pixels += tile.pixels;
    }
    std::size_t count = 0;
    double taken = 0.0;
    for (; count < tiles_.size() && effect > kLargestEffect; ++count) {
      effect -= tiles_[count].effect;
      taken += tiles_[count].pixels;
    }
    const bool is_most =
        taken > kLargestPart * pixels && taken + count_by_frames() > kLargestPart * region_pixels;
    return is_most ? tiles_.size() : count;
  }

  void take_by_frames(const Tile& tile) {
    for (int y = 0; y < height_of(tile.row); ++y) {
      unsigned char* by_table = plan_.by_table.row(top(tile.row) + y) + left(tile.column);
      unsigned char* by_frames = plan_.by_frames.row(top(tile.row) + y) + left(tile.column);
      for (int x = 0; x < width_of(tile.column); ++x) {
        by_frames[x] = by_frames[x] | by_table[x];
        by_table[x] = 0;
      }
    }
  }

  const Footprints& footprints_;
  const Sensor& sensor_;
  ScanPlan& plan_;
  StripeSettings stripes_;
  std::map<int, ScanRipple> ripples_;  ///< by level of dark radiance
  std::vector<Tile> tiles_;
};

}  // namespace

void sort_tiles(const Footprints& footprints,
                const Sensor& sensor,
                int region_pixels,
                ScanPlan& plan) {
  const auto tiles = [](std::ptrdiff_t pixels, int size) {
    return (static_cast<int>(pixels) + size - 1) / size;
  };
  const int columns = tiles(plan.by_table.width(), kRippleTileWidth_px);
  const int rows = tiles(plan.by_table.height(), kRippleTileHeight_px);
  plan.ripple = ImageF(columns, rows);
  plan.correction = ImageF(columns, rows, 1.0F);
  RippleTiles(footprints, sensor, plan).sort(region_pixels);
}

}  // namespace glint
