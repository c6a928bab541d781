// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/hidden_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "simulator/render/mask_kernels.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Wide and low: the slot, along which most of the work is, runs along the picture's rows.
constexpr int kTileWidth_px = 32;
constexpr int kTileHeight_px = 8;
/// Crossings this near a boundary of the wall are looked at one by one.
constexpr float kClose_mm = 0.1F;

/// Tests pixels [begin, end) of a row.
void test_row(const SeenPart& seen,
              const Tunnel& tunnel,
              const Vector3d& camera_mm,
              int y,
              int begin,
              int end,
              std::vector<float>& scratch,
              Mask& hidden) {
  const auto count = static_cast<std::size_t>(end - begin);
  scratch.resize(count);
  const std::int64_t first = static_cast<std::int64_t>(y) * seen.width_px + begin;
  tunnel.hidden_block(seen.seen_block(first, static_cast<int>(count)), camera_mm, scratch.data());
  mask_kernels::mark_both(
      scratch.data(), seen.coverage.row(y) + begin, end - begin, hidden.row(y) + begin);
}

/// Pixels 0, step, 2 step, ... and the last one.
std::vector<int> grid_places(int size, int step) {
  std::vector<int> places;
  for (int at = 0; at < size; at += step) {
    places.push_back(at);
  }
  if (places.back() != size - 1) {
    places.push_back(size - 1);
  }
  return places;
}

/// Sight lines of the tiles' corners.
class SightGrid {
 public:
  SightGrid(const SeenPart& seen, const Tunnel& tunnel, const Vector3d& camera_mm)
      : columns_(grid_places(seen.width_px, kTileWidth_px)),
        rows_(grid_places(seen.height_px, kTileHeight_px)) {
    std::vector<float> x_mm, y_mm, z_mm;
    for (const int y : rows_) {
      for (const int x : columns_) {
        x_mm.push_back(seen.seen_x(x, y));
        y_mm.push_back(seen.seen_y(x, y));
        z_mm.push_back(seen.seen_z(x, y));
        is_on_part_.push_back(seen.coverage(x, y) > 0.0F ? 1 : 0);
      }
    }
    lines_ = tunnel.sight_lines({.origin_x = x_mm.data(),
                                 .origin_y = y_mm.data(),
                                 .origin_z = z_mm.data(),
                                 .count = static_cast<int>(x_mm.size())},
                                camera_mm);
  }

  const std::vector<int>& columns() const { return columns_; }

  const std::vector<int>& rows() const { return rows_; }

  enum class Answer { kSeen, kHidden, kMixed, kPartlyOffPart };

  /// Of the tile between grid places (i, j) and (i + 1, j + 1).
  Answer tile(std::size_t i, std::size_t j) const {
    const std::size_t at = j * columns_.size() + i;
    const std::array<std::size_t, 4> corners = {
        at, at + 1, at + columns_.size(), at + columns_.size() + 1};
    const auto is_off = [&](std::size_t c) { return is_on_part_[c] == 0; };
    if (std::ranges::any_of(corners, is_off)) {
      return Answer::kPartlyOffPart;
    }
    const bool is_hidden = lines_.hidden[at] > 0.0F;
    const bool is_crossing = lines_.x_mm[at] != kNowhere_mm;
    const auto differs = [&](std::size_t c) {
      return (lines_.hidden[c] > 0.0F) != is_hidden ||
             (lines_.x_mm[c] != kNowhere_mm) != is_crossing;
    };
    if (std::ranges::any_of(corners, differs)) {
      return Answer::kMixed;
    }
    if (is_crossing) {
      const float along_mm = spread(lines_.x_mm, corners);
      const float across_mm = std::max(spread(lines_.y_mm, corners), spread(lines_.z_mm, corners));
      if (smallest(lines_.to_end_mm, corners) <= along_mm + kClose_mm ||
          smallest(lines_.to_edge_mm, corners) <= across_mm + kClose_mm) {
        return Answer::kMixed;
      }
    }
    return is_hidden ? Answer::kHidden : Answer::kSeen;
  }

 private:
  using Corners = std::array<std::size_t, 4>;

  static float smallest(const std::vector<float>& values, const Corners& c) {
    return std::min(std::min(values[c[0]], values[c[1]]), std::min(values[c[2]], values[c[3]]));
  }

  static float spread(const std::vector<float>& values, const Corners& c) {
    const float largest =
        std::max(std::max(values[c[0]], values[c[1]]), std::max(values[c[2]], values[c[3]]));
    return largest - smallest(values, c);
  }

  std::vector<int> columns_, rows_;
  std::vector<unsigned char> is_on_part_;
  Tunnel::SightLines lines_;
};

/// Pixels of a tile, its first row and column included, the last ones only at the picture's end.
struct TileArea {
  int left = 0, right = 0, top = 0, bottom = 0;
};

bool has_part(const SeenPart& seen, const TileArea& area) {
  for (int y = area.top; y < area.bottom; ++y) {
    if (mask_kernels::is_any_positive(seen.coverage.row(y) + area.left, area.right - area.left)) {
      return true;
    }
  }
  return false;
}

}  // namespace

Mask hidden_pixels_one_by_one(const SeenPart& seen,
                              const Tunnel& tunnel,
                              const Vector3d& camera_in_world_mm) {
  Mask hidden(seen.width_px, seen.height_px);
  std::vector<float> scratch;
  for (int y = 0; y < seen.height_px && tunnel.settings().blocks_view; ++y) {
    test_row(seen, tunnel, camera_in_world_mm, y, 0, seen.width_px, scratch, hidden);
  }
  return hidden;
}

Mask hidden_pixels(const SeenPart& seen, const Tunnel& tunnel, const Vector3d& camera_in_world_mm) {
  const bool is_tiled = seen.width_px > 1 && seen.height_px > 1;
  if (!tunnel.settings().blocks_view || !is_tiled) {
    return hidden_pixels_one_by_one(seen, tunnel, camera_in_world_mm);
  }
  Mask hidden(seen.width_px, seen.height_px);
  const SightGrid grid(seen, tunnel, camera_in_world_mm);
  const auto end_of = [](const std::vector<int>& places, std::size_t i) {
    return places[i + 1] + (i + 2 == places.size() ? 1 : 0);
  };
  std::vector<float> scratch;
  for (std::size_t j = 0; j + 1 < grid.rows().size(); ++j) {
    const int top = grid.rows()[j];
    const int bottom = end_of(grid.rows(), j);
    int begin = -1;  // of the tiles in a row that are tested one by one
    const auto test_until = [&](int end) {
      for (int y = top; y < bottom && begin >= 0; ++y) {
        test_row(seen, tunnel, camera_in_world_mm, y, begin, end, scratch, hidden);
      }
      begin = -1;
    };
    for (std::size_t i = 0; i + 1 < grid.columns().size(); ++i) {
      const TileArea area = {.left = grid.columns()[i],
                             .right = end_of(grid.columns(), i),
                             .top = top,
                             .bottom = bottom};
      const SightGrid::Answer answer = grid.tile(i, j);
      const bool is_open = answer == SightGrid::Answer::kMixed ||
                           (answer == SightGrid::Answer::kPartlyOffPart && has_part(seen, area));
      if (is_open) {
        begin = begin < 0 ? area.left : begin;
        continue;
      }
      test_until(area.left);
      for (int y = top; y < bottom && answer == SightGrid::Answer::kHidden; ++y) {
        const float* coverage = seen.coverage.row(y);
        for (int x = area.left; x < area.right; ++x) {
          hidden(x, y) = coverage[x] > 0.0F ? 1 : 0;
        }
      }
    }
    test_until(seen.width_px);
  }
  return hidden;
}

}  // namespace glint
