// SPDX-License-Identifier: GPL-3.0-or-later
//
// Marching squares: each cell between four centres of pixels is crossed by one or two stretches of
// the level line, whose ends lie on the cell's sides; stretches with a common end are put together
// (W. Lorensen, H. Cline 1987, in the plane). In saddles the mean of the corners decides.
#include "metrics/overlap/boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <unordered_map>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr std::ptrdiff_t kNormalReach = 3;  ///< points to both sides that a normal is taken from

/// A side of a cell: the centre where it begins (row-major index), and whether it goes down.
using SideId = std::int64_t;

/// A directed stretch of the line, the higher values on its left when y points down... the cell's
/// corners decide; `to` is where the next stretch begins.
struct Stretch {
  SideId from = 0;
  SideId to = 0;
};

class LevelLines {
 public:
  LevelLines(const ImageF& picture, float level) : picture_(picture), level_(level) {}

  std::vector<Boundary> find(std::size_t min_points) {
    for (int y = 0; y + 1 < picture_.height(); ++y) {
      for (int x = 0; x + 1 < picture_.width(); ++x) {
        add_cell(x, y);
      }
    }
    std::vector<Boundary> lines;
    for (const SideId start : open_starts()) {
      add_line(start, false, min_points, lines);
    }
    for (const Stretch& stretch : in_order_) {
      if (next_.contains(stretch.from)) {
        add_line(stretch.from, true, min_points, lines);
      }
    }
    return lines;
  }

 private:
  bool is_high(int x, int y) const { return picture_(x, y) >= level_; }

  SideId side(int x, int y, bool is_down) const {
    return 2 * (static_cast<SideId>(y) * picture_.width() + x) + (is_down ? 1 : 0);
  }

  Vector2d point_on(SideId id) const {
    const auto pixel = id / 2;
    const int x = static_cast<int>(pixel % picture_.width());
    const int y = static_cast<int>(pixel / picture_.width());
    const bool is_down = id % 2 != 0;
    const auto a = static_cast<double>(picture_(x, y));
    const auto b = static_cast<double>(is_down ? picture_(x, y + 1) : picture_(x + 1, y));
    const double t = (static_cast<double>(level_) - a) / (b - a);
    return {x + 0.5 + (is_down ? 0.0 : t), y + 0.5 + (is_down ? t : 0.0)};
  }

  void add(SideId from, SideId to) {
    next_.emplace(from, to);
    in_order_.push_back({.from = from, .to = to});
  }

  /// Stretches run so that higher values lie to the right of them as seen on the screen.
  void add_cell(int x, int y) {
    // Corners in turn: top left, top right, bottom right, bottom left; sides between them.
    const std::array<bool, 4> high = {
        is_high(x, y), is_high(x + 1, y), is_high(x + 1, y + 1), is_high(x, y + 1)};
    const int count = static_cast<int>(std::ranges::count(high, true));
    if (count == 0 || count == 4) {
      return;
    }
    const std::array<SideId, 4> sides = {
        side(x, y, false), side(x + 1, y, true), side(x, y + 1, false), side(x, y, true)};
    const bool is_saddle = count == 2 && high[0] == high[2];
    const bool joins_high = is_saddle && 0.25F * (picture_(x, y) + picture_(x + 1, y) +
                                                  picture_(x + 1, y + 1) + picture_(x, y + 1)) >=
                                             level_;
    // Walking around the cell, a stretch enters where high turns to low and leaves where low turns
    // to high; in a saddle it may be either neighbour.
    for (std::size_t i = 0; i < 4; ++i) {
      if (high[i] && !high[(i + 1) % 4]) {
        std::size_t j = i;
        do {
          j = joins_high || !is_saddle ? (j + 1) % 4 : (j + 3) % 4;
        } while (high[j] || !high[(j + 1) % 4]);
        add(sides[i], sides[j]);
      }
    }
  }

  /// Beginnings of stretches at which no other one ends: lines that leave the picture.
  std::vector<SideId> open_starts() const {
    std::unordered_map<SideId, bool> is_end;
    for (const Stretch& stretch : in_order_) {
      is_end[stretch.to] = true;
    }
    std::vector<SideId> starts;
    for (const Stretch& stretch : in_order_) {
      if (!is_end.contains(stretch.from)) {
        starts.push_back(stretch.from);
      }
    }
    return starts;
  }

  void add_line(SideId start,
                bool is_closed,
                std::size_t min_points,
                std::vector<Boundary>& lines) {
    Boundary line = {.points = {}, .is_closed = is_closed};
    SideId at = start;
    line.points.push_back({.at_px = point_on(at)});
    for (auto next = next_.find(at); next != next_.end(); next = next_.find(at)) {
      at = next->second;
      next_.erase(next);
      if (at != start) {
        line.points.push_back({.at_px = point_on(at)});
      }
    }
    if (line.points.size() >= min_points) {
      lines.push_back(std::move(line));
    }
  }

  const ImageF& picture_;
  float level_;
  std::unordered_map<SideId, SideId> next_;
  std::vector<Stretch> in_order_;
};

/// Points closer than half a pixel to the one before are dropped, so that a line has about one a
/// pixel.
void thin(Boundary& line) {
  std::vector<BoundaryPoint> kept;
  for (const BoundaryPoint& point : line.points) {
    if (kept.empty() || (point.at_px - kept.back().at_px).norm() >= 0.7) {
      kept.push_back(point);
    }
  }
  line.points = std::move(kept);
}

void set_normals(Boundary& line) {
  const auto count = static_cast<std::ptrdiff_t>(line.points.size());
  const auto at = [&](std::ptrdiff_t i) {
    i = line.is_closed ? (i % count + count) % count : std::clamp<std::ptrdiff_t>(i, 0, count - 1);
    return line.points[static_cast<std::size_t>(i)].at_px;
  };
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const Vector2d along = at(i + kNormalReach) - at(i - kNormalReach);
    if (along.norm() > 0.0) {
      line.points[static_cast<std::size_t>(i)].normal =
          Vector2d(along.y(), -along.x()).normalized();
    }
  }
}

}  // namespace

double sample(const ImageF& picture, const Vector2d& at_px) {
  const double x = std::clamp(at_px.x() - 0.5, 0.0, static_cast<double>(picture.width() - 1));
  const double y = std::clamp(at_px.y() - 0.5, 0.0, static_cast<double>(picture.height() - 1));
  const int left = std::min(static_cast<int>(x), std::max(picture.width() - 2, 0));
  const int top = std::min(static_cast<int>(y), std::max(picture.height() - 2, 0));
  const int right = std::min(left + 1, picture.width() - 1);
  const int bottom = std::min(top + 1, picture.height() - 1);
  const double u = x - left;
  const double v = y - top;
  const auto grey = [&](int i, int j) { return static_cast<double>(picture(i, j)); };
  return (1.0 - v) * ((1.0 - u) * grey(left, top) + u * grey(right, top)) +
         v * ((1.0 - u) * grey(left, bottom) + u * grey(right, bottom));
}

std::vector<Boundary> boundaries_at(const ImageF& picture, float level, std::size_t min_points) {
  std::vector<Boundary> lines = LevelLines(picture, level).find(min_points);
  std::ranges::for_each(lines, thin);
  std::erase_if(lines, [&](const Boundary& line) { return line.points.size() < min_points; });
  std::ranges::for_each(lines, set_normals);
  return lines;
}

std::vector<Boundary> boundaries_of(const Mask& mask, std::size_t min_points) {
  // Two passes of [1 2 1] in each direction: smooth enough for normals, too little to move edges
  // whose radius of curvature is some pixels.
  ImageF smooth(mask.width(), mask.height());
  std::ranges::transform(mask.values(), smooth.values().begin(), [](unsigned char is_in) {
    return is_in != 0 ? 1.0F : 0.0F;
  });
  const auto clamped = [](int i, int count) { return std::clamp(i, 0, count - 1); };
  for (int pass = 0; pass < 4; ++pass) {
    const ImageF before = smooth;
    const int dx = pass % 2 == 0 ? 1 : 0;
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        smooth(x, y) =
            0.5F * before(x, y) +
            0.25F * before(clamped(x - dx, mask.width()), clamped(y - (1 - dx), mask.height())) +
            0.25F * before(clamped(x + dx, mask.width()), clamped(y + (1 - dx), mask.height()));
      }
    }
  }
  return boundaries_at(smooth, 0.5F, min_points);
}

}  // namespace glint
