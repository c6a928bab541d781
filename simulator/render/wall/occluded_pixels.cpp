// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels of the part the tunnel's wall occludes. Where a sight line crosses the wall varies
// smoothly over the picture whatever the part looks like. So the four corners of a tile of 128 x 32
// pixels decide for all of it when they agree and cross the wall further from its edges than they
// are apart; other tiles are split once, into 32 x 8, and what is then undecided is tested pixel by
// pixel (corner_sights.h). Own method; docs/theory/tunnel.md, "The slot". Cost: a few hundred sight
// lines for a picture in which nothing is occluded, one per pixel along the slot's edge. Memory:
// one byte per pixel, none where nothing is occluded, and 150 bytes per pixel hidden in part.
#include "simulator/render/wall/occluded_pixels.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "core/image/mask_kernels.h"
#include "simulator/light/tunnel/sight_lines.h"
#include "simulator/light/tunnel/tunnel_profile.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Tiles are wide and low: the slot, along which most of the work is, runs along the picture's
/// rows. Those that are not decided are cut into the next smaller ones.
struct TileSize {
  int width_px = 0;
  int height_px = 0;
};

constexpr std::array<TileSize, 2> kTiles = {{{128, 32}, {32, 8}}};

/// Crossings this near a boundary of the wall are looked at one by one.
constexpr float kClose_mm = 0.1F;

/// begin, begin + step, ... and end.
std::vector<int> grid_places(int begin, int end, int step) {
  std::vector<int> places;
  for (int at = begin; at < end; at += step) {
    places.push_back(at);
  }
  places.push_back(end);
  return places;
}

bool has_part(const VisibilityBuffer& seen, const PixelArea& area) {
  for (int y = area.top; y < area.bottom; ++y) {
    if (mask_kernels::is_any_positive(seen.coverage.row(y) + area.left, area.right - area.left)) {
      return true;
    }
  }
  return false;
}

/// Ends of a flat tunnel's panels in the y-z plane: where sight lines begin to pass beside them.
std::vector<Eigen::Vector2d> panel_ends(const TunnelSettings& s) {
  std::vector<Eigen::Vector2d> ends;
  if (s.shape != TunnelSettings::Shape::kFlat) {
    return ends;
  }
  for (const FlatWall& wall :
       flat_walls(s.distance_mm, s.opening_rad, s.panel_height_mm, s.base_mm)) {
    const Eigen::Vector2d foot(wall.start_y_mm, wall.start_z_mm);
    ends.push_back(foot);
    ends.emplace_back(foot + wall.length_mm * Eigen::Vector2d(wall.along_y, wall.along_z));
  }
  return ends;
}

/// What all grids of a picture share.
struct View {
  const VisibilityBuffer& seen;
  const Tunnel& tunnel;
  Vector3d camera_mm;
  std::vector<Eigen::Vector2d> ends_mm;  ///< of a flat tunnel's panels
  CornerSights& sights;
  double distance_mm = 0.0;  ///< from the camera to about where the part is
};

/// Sight lines of the corners of an area's tiles. These corners are pixels: a tile's first ones,
/// and those behind its last ones or, where the picture ends, the last ones.
class SightGrid {
 public:
  SightGrid(const View& view, const PixelArea& area, const TileSize& tile)
      : view_(view),
        columns_(
            grid_places(area.left, std::min(area.right, view.seen.width_px - 1), tile.width_px)),
        rows_(
            grid_places(area.top, std::min(area.bottom, view.seen.height_px - 1), tile.height_px)),
        is_finest_(tile.width_px == kTiles.back().width_px) {
    for (const int y : rows_) {
      for (const int x : columns_) {
        add_point(x, y);
      }
    }
    lines_ = sight_lines(view.tunnel,
                         {.origin_x = x_mm_.data(),
                          .origin_y = y_mm_.data(),
                          .origin_z = z_mm_.data(),
                          .count = static_cast<int>(x_mm_.size())},
                         view.camera_mm);
  }

  std::size_t tiles_along() const { return columns_.size() - 1; }

  std::size_t tiles_down() const { return rows_.size() - 1; }

  PixelArea area(std::size_t i, std::size_t j) const {
    const auto end = [](int place, int size) { return place == size - 1 ? size : place; };
    return {.left = columns_[i],
            .right = end(columns_[i + 1], view_.seen.width_px),
            .top = rows_[j],
            .bottom = end(rows_[j + 1], view_.seen.height_px)};
  }

  enum class Answer { kSeen, kOccluded, kOpen };

  /// Of the tile between grid places (i, j) and (i + 1, j + 1).
  Answer tile(std::size_t i, std::size_t j) const {
    const std::size_t at = j * columns_.size() + i;
    const Corners corners = {at, at + 1, at + columns_.size(), at + columns_.size() + 1};
    const bool is_occluded = lines_.occluded[at] > 0.0F;
    const bool is_crossing = lines_.x_mm[at] != kNoHitMargin_mm;
    const auto differs = [&](std::size_t c) {
      return (lines_.occluded[c] > 0.0F) != is_occluded ||
             (lines_.x_mm[c] != kNoHitMargin_mm) != is_crossing;
    };
    if (std::ranges::any_of(corners, differs) ||
        !(is_crossing ? is_far_from_edges(corners) : is_clear_of_panels(corners))) {
      return Answer::kOpen;
    }
    return is_occluded ? Answer::kOccluded : Answer::kSeen;
  }

 private:
  using Corners = std::array<std::size_t, 4>;

  void add_point(int x, int y) {
    const VisibilityBuffer& seen = view_.seen;
    const Vector3d point =
        seen.coverage(x, y) > 0.0F
            ? vector_of(seen.seen_x(x, y), seen.seen_y(x, y), seen.seen_z(x, y))
            : Vector3d(view_.camera_mm +
                       view_.distance_mm * view_.sights.direction(x + 0.5, y + 0.5));
    x_mm_.push_back(static_cast<float>(point.x()));
    y_mm_.push_back(static_cast<float>(point.y()));
    z_mm_.push_back(static_cast<float>(point.z()));
  }

  bool is_far_from_edges(const Corners& c) const {
    const float along_mm = spread(lines_.x_mm, c);
    const float across_mm = std::max(spread(lines_.y_mm, c), spread(lines_.z_mm, c));
    // Of a flat tunnel, both panels: what is between them is not the wall.
    const bool is_on_both =
        !view_.ends_mm.empty() && smallest(lines_.y_mm, c) < 0.0F && largest(lines_.y_mm, c) > 0.0F;
    return !is_on_both && smallest(lines_.to_end_mm, c) > along_mm + kClose_mm &&
           smallest(lines_.to_edge_mm, c) > across_mm + kClose_mm;
  }

  /// Sight lines that pass a flat tunnel's panels, seen along x: no panel begins or ends among
  /// them.
  bool is_clear_of_panels(const Corners& corners) const {
    if (view_.ends_mm.empty()) {
      return is_finest_;  // other walls have rims, near which tiles must be small
    }
    constexpr double kPad = 1.0;  // half a pixel at least, also of the narrow tiles at the border
    const Vector3d& camera_mm = view_.camera_mm;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const std::size_t c : corners) {
      const double drop_mm = camera_mm.z() - static_cast<double>(z_mm_[c]);
      if (drop_mm <= 0.0) {
        return false;
      }
      const double slope = (static_cast<double>(y_mm_[c]) - camera_mm.y()) / drop_mm;
      low = std::min(low, slope);
      high = std::max(high, slope);
    }
    const double pad = kPad * (high - low) + 1e-6;
    return std::ranges::none_of(view_.ends_mm, [&](const Eigen::Vector2d& end_mm) {
      const double drop_mm = camera_mm.z() - end_mm.y();
      const double slope = (end_mm.x() - camera_mm.y()) / drop_mm;
      return drop_mm > 0.0 && slope >= low - pad && slope <= high + pad;
    });
  }

  static float smallest(const std::vector<float>& values, const Corners& c) {
    return std::min(std::min(values[c[0]], values[c[1]]), std::min(values[c[2]], values[c[3]]));
  }

  static float largest(const std::vector<float>& values, const Corners& c) {
    return std::max(std::max(values[c[0]], values[c[1]]), std::max(values[c[2]], values[c[3]]));
  }

  static float spread(const std::vector<float>& values, const Corners& c) {
    return largest(values, c) - smallest(values, c);
  }

  const View& view_;
  std::vector<int> columns_, rows_;
  bool is_finest_;
  std::vector<float> x_mm_, y_mm_, z_mm_;  ///< of what the corners see
  SightLines lines_;
};

/// Finds the hidden pixels, tile by tile.
class OcclusionFinder {
 public:
  explicit OcclusionFinder(const View& view) : view_(view) {}

  OccludedPixels take() {
    std::ranges::sort(found_.edges, {}, &OccludedEdge::pixel);
    return std::move(found_);
  }

  /// @param level  of kTiles
  void split(const PixelArea& area, std::size_t level) {
    const SightGrid grid(view_, area, kTiles[level]);
    for (std::size_t j = 0; j < grid.tiles_down(); ++j) {
      PixelArea open;  // neighbouring tiles that are tested pixel by pixel; none at first
      for (std::size_t i = 0; i < grid.tiles_along(); ++i) {
        const PixelArea tile = grid.area(i, j);
        const SightGrid::Answer answer = grid.tile(i, j);
        if (answer == SightGrid::Answer::kSeen || !has_part(view_.seen, tile)) {
          continue;
        }
        if (answer == SightGrid::Answer::kOccluded) {
          mark_occluded(tile);
          continue;
        }
        if (level + 1 < kTiles.size()) {
          split(tile, level + 1);
        } else if (open.right > open.left && open.right == tile.left) {
          open.right = tile.right;
        } else {
          view_.sights.add_hidden(open, found_);
          open = tile;
        }
      }
      view_.sights.add_hidden(open, found_);
    }
  }

 private:
  void mark_occluded(const PixelArea& area) {
    if (found_.whole.empty()) {
      found_.whole = Mask(view_.seen.width_px, view_.seen.height_px);
    }
    for (int y = area.top; y < area.bottom; ++y) {
      const float* coverage = view_.seen.coverage.row(y);
      for (int x = area.left; x < area.right; ++x) {
        found_.whole(x, y) = coverage[x] > 0.0F ? 1 : 0;
      }
    }
  }

  const View& view_;
  OccludedPixels found_;
};

/// From the camera to the first pixel that sees the part; 0 where none does.
double distance_to_part_mm(const VisibilityBuffer& seen, const Vector3d& camera_mm) {
  const auto& coverage = seen.coverage.values();
  const auto found = std::ranges::find_if(coverage, [](float share) { return share > 0.0F; });
  if (found == coverage.end()) {
    return 0.0;
  }
  const auto i = static_cast<std::size_t>(found - coverage.begin());
  const Vector3d point =
      vector_of(seen.seen_x.values()[i], seen.seen_y.values()[i], seen.seen_z.values()[i]);
  return (point - camera_mm).norm();
}

}  // namespace

OccludedPixels occluded_pixels_one_by_one(const VisibilityBuffer& seen,
                                          const Tunnel& tunnel,
                                          const Vector3d& camera_in_world_mm) {
  OccludedPixels found;
  if (tunnel.settings().blocks_view) {
    CornerSights(seen, tunnel, camera_in_world_mm)
        .add_hidden({.right = seen.width_px, .bottom = seen.height_px}, found);
  }
  return found;
}

OccludedPixels occluded_pixels(const VisibilityBuffer& seen,
                               const Tunnel& tunnel,
                               const Vector3d& camera_in_world_mm) {
  if (!tunnel.settings().blocks_view) {
    return {};
  }
  const bool is_tiled = seen.width_px > 1 && seen.height_px > 1;
  if (!is_tiled) {
    return occluded_pixels_one_by_one(seen, tunnel, camera_in_world_mm);
  }
  CornerSights sights(seen, tunnel, camera_in_world_mm);
  const View view = {.seen = seen,
                     .tunnel = tunnel,
                     .camera_mm = camera_in_world_mm,
                     .ends_mm = panel_ends(tunnel.settings()),
                     .sights = sights,
                     .distance_mm = distance_to_part_mm(seen, camera_in_world_mm)};
  OcclusionFinder finder(view);
  finder.split({.right = seen.width_px, .bottom = seen.height_px}, 0);
  return finder.take();
}

}  // namespace glint
