// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/boundary_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kCellPx = 4.0;
constexpr double kLongestStepPx = 6.0;  ///< of neighbours on a line

struct Segment {
  Vector2d from;
  Vector2d to;
  bool begins_line = false;
  bool ends_line = false;
};

struct Nearest {
  Vector2d at;
  double distance_px = 0.0;
  bool is_loose_end = false;
};

/// Stretches between neighbours, found by the cells of a grid that they touch.
class Stretches {
 public:
  explicit Stretches(std::span<const Boundary> boundaries) {
    for (const Boundary& line : boundaries) {
      const std::size_t count = line.points.size();
      for (std::size_t i = 0; i + (line.is_closed ? 0U : 1U) < count; ++i) {
        add({.from = line.points[i].at_px,
             .to = line.points[(i + 1) % count].at_px,
             .begins_line = !line.is_closed && i == 0,
             .ends_line = !line.is_closed && i + 2 == count});
      }
    }
  }

  /// The nearest point on all of them, at most that far.
  std::optional<Nearest> nearest(const Vector2d& point, double max_px) const {
    std::optional<Nearest> best;
    const int rings = static_cast<int>(std::ceil(max_px / kCellPx)) + 1;
    for (int ring = 0; ring <= rings; ++ring) {
      if (best && best->distance_px <= (ring - 1) * kCellPx) {
        break;
      }
      search_ring(point, ring, best);
    }
    return best && best->distance_px <= max_px ? best : std::nullopt;
  }

 private:
  static std::int64_t cell_of(const Vector2d& point, int dx, int dy) {
    const auto x = static_cast<std::int64_t>(std::floor(point.x() / kCellPx)) + dx;
    const auto y = static_cast<std::int64_t>(std::floor(point.y() / kCellPx)) + dy;
    return y * (std::int64_t{1} << 31) + x;
  }

  void add(const Segment& segment) {
    if ((segment.to - segment.from).norm() > kLongestStepPx) {
      return;
    }
    segments_.push_back(segment);
    const auto id = segments_.size() - 1;
    const int steps = 1 + static_cast<int>((segment.to - segment.from).norm() / (0.5 * kCellPx));
    std::int64_t last = 0;
    for (int i = 0; i <= steps; ++i) {
      const Vector2d at = segment.from + (segment.to - segment.from) * i / steps;
      const std::int64_t cell = cell_of(at, 0, 0);
      if (i == 0 || cell != last) {
        cells_[cell].push_back(id);
      }
      last = cell;
    }
  }

  void search_ring(const Vector2d& point, int ring, std::optional<Nearest>& best) const {
    for (int dy = -ring; dy <= ring; ++dy) {
      const int step = std::abs(dy) == ring ? 1 : std::max(2 * ring, 1);
      for (int dx = -ring; dx <= ring; dx += step) {
        const auto cell = cells_.find(cell_of(point, dx, dy));
        if (cell == cells_.end()) {
          continue;
        }
        for (const std::size_t id : cell->second) {
          consider(point, segments_[id], best);
        }
      }
    }
  }

  static void consider(const Vector2d& point,
                       const Segment& segment,
                       std::optional<Nearest>& best) {
    const Vector2d along = segment.to - segment.from;
    const double t =
        along.squaredNorm() > 0.0 ? (point - segment.from).dot(along) / along.squaredNorm() : 0.0;
    const Vector2d at = segment.from + std::clamp(t, 0.0, 1.0) * along;
    const double distance = (point - at).norm();
    if (!best || distance < best->distance_px) {
      best = {.at = at,
              .distance_px = distance,
              .is_loose_end = (segment.begins_line && t < 0.0) || (segment.ends_line && t > 1.0)};
    }
  }

  std::vector<Segment> segments_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> cells_;
};

std::size_t point_count(std::span<const Boundary> boundaries) {
  std::size_t count = 0;
  for (const Boundary& line : boundaries) {
    count += line.points.size();
  }
  return count;
}

/// Linear between the values. @param sorted  one or more, ascending
double quantile_of(std::span<const double> sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double above = sorted[std::min(below + 1, sorted.size() - 1)];
  return sorted[below] + (at - static_cast<double>(below)) * (above - sorted[below]);
}

}  // namespace

std::vector<BoundaryGap> gaps_between(std::span<const Boundary> from,
                                      std::span<const Boundary> to,
                                      double max_distance_px) {
  const Stretches stretches(to);
  std::vector<BoundaryGap> gaps;
  for (std::size_t b = 0; b < from.size(); ++b) {
    for (std::size_t i = 0; i < from[b].points.size(); ++i) {
      const BoundaryPoint& point = from[b].points[i];
      const std::optional<Nearest> nearest = stretches.nearest(point.at_px, max_distance_px);
      if (nearest && !nearest->is_loose_end) {
        gaps.push_back({.from = point,
                        .distance_px = nearest->distance_px,
                        .offset_px = (nearest->at - point.at_px).dot(point.normal),
                        .boundary = b,
                        .point = i});
      }
    }
  }
  return gaps;
}

BoundaryDistance boundary_distance(std::span<const Boundary> first,
                                   std::span<const Boundary> second,
                                   double max_distance_px) {
  const std::vector<BoundaryGap> there = gaps_between(first, second, max_distance_px);
  const std::vector<BoundaryGap> back = gaps_between(second, first, max_distance_px);
  BoundaryDistance result;
  std::vector<double> distances;
  for (const BoundaryGap& gap : there) {
    distances.push_back(gap.distance_px);
    result.offset_px += gap.offset_px;
  }
  for (const BoundaryGap& gap : back) {
    distances.push_back(gap.distance_px);
    result.offset_px -= gap.offset_px;
  }
  result.points = distances.size();
  const std::size_t all = point_count(first) + point_count(second);
  result.share = all > 0 ? static_cast<double>(distances.size()) / static_cast<double>(all) : 0.0;
  if (distances.empty()) {
    return result;
  }
  std::ranges::sort(distances);
  for (const double distance : distances) {
    result.mean_px += distance / static_cast<double>(distances.size());
  }
  result.offset_px /= static_cast<double>(distances.size());
  result.max_px = distances.back();
  result.p95_px = quantile_of(distances, 0.95);
  return result;
}

}  // namespace glint
