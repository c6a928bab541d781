// SPDX-License-Identifier: GPL-3.0-or-later
//
// The wall as few straight strips: a dense outline of the whole cross-section, cut at the slot, of
// which Douglas and Peucker's method keeps the corners that a tolerance needs; arc lengths are
// those of the dense line, so that stripes stand where the closed forms have them
// (tunnel_profile.h). Cost: n log n for n points as a rule; once a tunnel. docs/theory/lights.md,
// "The fringe tunnel".
#include "simulator/light/area/wall_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector2d;

struct Outline {
  std::vector<std::vector<Vector2d>> lines;  ///< from y < 0 to y > 0
  std::vector<std::vector<double>> arcs_mm;
};

/// As level 0 measures the cross-section: the gap between two panels counts.
Outline whole_outline(const TunnelSettings& settings) {
  TunnelSettings without_slot = settings;
  without_slot.slot_mm = 0.0;
  Outline outline = {.lines = Tunnel(without_slot).outline(0.0)};
  double length = 0.0;
  const Vector2d* last = nullptr;
  for (const auto& line : outline.lines) {
    std::vector<double>& arcs = outline.arcs_mm.emplace_back();
    for (const Vector2d& point : line) {
      length += last != nullptr ? (point - *last).norm() : 0.0;
      arcs.push_back(length);
      last = &point;
    }
  }
  for (auto& arcs : outline.arcs_mm) {
    for (double& arc : arcs) {
      arc -= 0.5 * length;
    }
  }
  return outline;
}

/// The camera's slot as the tunnel cuts it: along the top, above half the height.
struct Slot {
  double half_mm = 0.0;
  double floor_mm = 0.0;

  bool has(const Vector2d& point) const {
    return std::abs(point.x()) < half_mm && point.y() > floor_mm;
  }

  /// Whether a whole line surely lies beside or below it; most do.
  bool is_clear_of(const Vector2d& a, const Vector2d& b) const {
    constexpr double kRounding_mm = 1e-6;
    const double beside_mm = half_mm + kRounding_mm;
    return std::min(a.x(), b.x()) > beside_mm || std::max(a.x(), b.x()) < -beside_mm ||
           std::max(a.y(), b.y()) < floor_mm - kRounding_mm;
  }
};

/// The pieces of a line from a to b that lie outside the slot, as parts of its length.
std::vector<std::array<double, 2>> beside_slot(const Vector2d& a,
                                               const Vector2d& b,
                                               const Slot& slot) {
  if (a != b && slot.is_clear_of(a, b)) {
    return {{0.0, 1.0}};
  }
  std::vector<double> cuts = {0.0, 1.0};
  const Vector2d way = b - a;
  for (const double y : {-slot.half_mm, slot.half_mm}) {
    cuts.push_back((y - a.x()) / way.x());
  }
  cuts.push_back((slot.floor_mm - a.y()) / way.y());
  std::erase_if(cuts, [](double t) { return !(t >= 0.0 && t <= 1.0); });
  std::ranges::sort(cuts);
  std::vector<std::array<double, 2>> pieces;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const Vector2d middle = a + 0.5 * (cuts[i - 1] + cuts[i]) * way;
    if (!(cuts[i] > cuts[i - 1]) || slot.has(middle)) {
      continue;
    }
    if (!pieces.empty() && pieces.back()[1] == cuts[i - 1]) {
      pieces.back()[1] = cuts[i];
    } else {
      pieces.push_back({cuts[i - 1], cuts[i]});
    }
  }
  return pieces;
}

Outline without_slot(const Outline& whole, const Slot& slot) {
  Outline cut;
  for (std::size_t l = 0; l < whole.lines.size(); ++l) {
    const auto& line = whole.lines[l];
    const auto& arcs = whole.arcs_mm[l];
    bool is_open = false;  // the last piece goes on
    for (std::size_t i = 1; i < line.size(); ++i) {
      const auto at = [&](double t) { return Vector2d(line[i - 1] + t * (line[i] - line[i - 1])); };
      const auto arc_at = [&](double t) { return arcs[i - 1] + t * (arcs[i] - arcs[i - 1]); };
      const auto pieces = beside_slot(line[i - 1], line[i], slot);
      if (pieces.empty() || pieces.front()[0] > 0.0) {
        is_open = false;
      }
      for (const auto& [from, to] : pieces) {
        if (!is_open || from > 0.0) {
          cut.lines.push_back({at(from)});
          cut.arcs_mm.push_back({arc_at(from)});
        }
        cut.lines.back().push_back(at(to));
        cut.arcs_mm.back().push_back(arc_at(to));
        is_open = to == 1.0;
      }
    }
  }
  return cut;
}

/// Points of a line such that its other points lie within the tolerance of the chords between
/// them. Source: D. Douglas, T. Peucker, "Algorithms for the reduction of the number of points
/// required to represent a digitized line or its caricature", Cartographica 10(2), 1973.
void keep_corners(const std::vector<Vector2d>& line,
                  std::size_t first,
                  std::size_t last,
                  double tolerance_mm,
                  std::vector<std::size_t>& kept) {
  const Vector2d chord = (line[last] - line[first]).normalized();
  double furthest_mm = 0.0;
  std::size_t at = first;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Vector2d to = line[i] - line[first];
    const double away_mm = std::abs(chord.x() * to.y() - chord.y() * to.x());
    if (away_mm > furthest_mm) {
      furthest_mm = away_mm;
      at = i;
    }
  }
  if (furthest_mm > tolerance_mm) {
    keep_corners(line, first, at, tolerance_mm, kept);
    keep_corners(line, at, last, tolerance_mm, kept);
  } else {
    kept.push_back(last);
  }
}

double tolerance_mm(const Tunnel& tunnel) {
  const TunnelSettings& s = tunnel.settings();
  const double size_mm = std::max(tunnel.half_width_mm(), tunnel.top_mm() - s.base_mm);
  return std::clamp(s.period_mm / 320.0, 2e-5 * size_mm, 5e-4 * size_mm);
}

Outline luminous_outline(const Tunnel& tunnel) {
  const TunnelSettings& s = tunnel.settings();
  // As Tunnel has it, a little below half the height.
  const Slot slot = {.half_mm = 0.5 * s.slot_mm,
                     .floor_mm = 0.5 * (s.base_mm + tunnel.top_mm()) - 1e-3};
  return without_slot(whole_outline(s), slot);
}

}  // namespace

WallSize wall_size(const Tunnel& tunnel) {
  WallSize size;
  for (const auto& line : luminous_outline(tunnel).lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      size.box_yz_mm.extend(line[i]);
      size.length_mm += i > 0 ? (line[i] - line[i - 1]).norm() : 0.0;
    }
  }
  return size;
}

std::vector<WallStrip> wall_outline(const Tunnel& tunnel) {
  const Outline outline = luminous_outline(tunnel);
  std::vector<WallStrip> strips;
  for (std::size_t l = 0; l < outline.lines.size(); ++l) {
    const auto& line = outline.lines[l];
    const auto& arcs = outline.arcs_mm[l];
    std::vector<std::size_t> corners = {0};
    keep_corners(line, 0, line.size() - 1, tolerance_mm(tunnel), corners);
    for (std::size_t c = 1; c < corners.size(); ++c) {
      const std::size_t from = corners[c - 1];
      const std::size_t to = corners[c];
      strips.push_back({.from_mm = line[from],
                        .to_mm = line[to],
                        .middle_arc_mm = 0.5 * (arcs[from] + arcs[to])});
    }
  }
  return strips;
}

}  // namespace glint
