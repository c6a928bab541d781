// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/surface_lines.h"

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "metrics/overlap/outline.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kBeside_px = 2.0;  ///< from a line, where the other surface is looked for
constexpr std::size_t kMinLine = 8;

/// Columns and rows [x0, x1) x [y0, y1).
struct Window {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

/// Of each label what holds its pixels and some around them, within the picture.
std::vector<Window> windows_of(const NamedSurfaces& surfaces) {
  constexpr int kAround_px = 4;
  const Image<int>& labels = surfaces.labels;
  std::vector<Window> windows(surfaces.names.size() + 1,
                              {.x0 = labels.width(), .y0 = labels.height()});
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      Window& window = windows[static_cast<std::size_t>(std::max(labels(x, y), 0))];
      window = {.x0 = std::min(window.x0, std::max(x - kAround_px, 0)),
                .y0 = std::min(window.y0, std::max(y - kAround_px, 0)),
                .x1 = std::max(window.x1, std::min(x + kAround_px + 1, labels.width())),
                .y1 = std::max(window.y1, std::min(y + kAround_px + 1, labels.height()))};
    }
  }
  return windows;
}

Window joined(const Window& a, const Window& b) {
  return {.x0 = std::min(a.x0, b.x0),
          .y0 = std::min(a.y0, b.y0),
          .x1 = std::max(a.x1, b.x1),
          .y1 = std::max(a.y1, b.y1)};
}

double area_of(const Window& window) {
  return static_cast<double>(window.x1 - window.x0) * (window.y1 - window.y0);
}

/// Outlines of the pixels that are of a set, which the window holds.
template <class IsIn>
std::vector<Boundary> outlines_in(const Image<int>& labels,
                                  const Window& window,
                                  const IsIn& is_in) {
  Mask mask(window.x1 - window.x0, window.y1 - window.y0);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      mask(x, y) = is_in(labels(window.x0 + x, window.y0 + y)) ? 1 : 0;
    }
  }
  std::vector<Boundary> outlines = outlines_of(mask, 1);
  for (Boundary& outline : outlines) {
    for (BoundaryPoint& point : outline.points) {
      point.at_px += Vector2d(window.x0, window.y0);
    }
  }
  return outlines;
}

/// Surfaces of one group are far from each other: at least a block of pixels lies between any two,
/// more than an outline is smoothed over. Groups are few, however many surfaces there are.
class FarGroups {
 public:
  explicit FarGroups(const NamedSurfaces& surfaces)
      : near_(surfaces.names.size() + 1), group_(surfaces.names.size() + 1, -1) {
    find_near(blocks_of(surfaces.labels));
    for (std::size_t label = 1; label < group_.size(); ++label) {
      std::set<int> taken;
      for (const int other : near_[label]) {
        taken.insert(group_[static_cast<std::size_t>(other)]);
      }
      int group = 0;
      while (taken.contains(group)) {
        ++group;
      }
      group_[label] = group;
      count_ = std::max(count_, group + 1);
    }
  }

  int count() const { return count_; }

  /// @returns -1 of what is no surface
  int of(int label) const { return label > 0 ? group_[static_cast<std::size_t>(label)] : -1; }

 private:
  static constexpr int kBlock_px = 8;

  static Image<std::set<int>> blocks_of(const Image<int>& labels) {
    Image<std::set<int>> blocks((labels.width() + kBlock_px - 1) / kBlock_px,
                                (labels.height() + kBlock_px - 1) / kBlock_px);
    for (int y = 0; y < labels.height(); ++y) {
      int last = 0;
      for (int x = 0; x < labels.width(); ++x) {
        const int label = labels(x, y);
        if (label > 0 && (label != last || x % kBlock_px == 0)) {
          blocks(x / kBlock_px, y / kBlock_px).insert(label);
        }
        last = label;
      }
    }
    return blocks;
  }

  /// Those in one block or in neighbouring ones.
  void find_near(const Image<std::set<int>>& blocks) {
    for (int y = 0; y < blocks.height(); ++y) {
      for (int x = 0; x < blocks.width(); ++x) {
        std::set<int> around;
        for (int j = std::max(y - 1, 0); j < std::min(y + 2, blocks.height()); ++j) {
          for (int i = std::max(x - 1, 0); i < std::min(x + 2, blocks.width()); ++i) {
            around.insert(blocks(i, j).begin(), blocks(i, j).end());
          }
        }
        for (const int label : blocks(x, y)) {
          near_[static_cast<std::size_t>(label)].insert(around.begin(), around.end());
          near_[static_cast<std::size_t>(label)].erase(label);
        }
      }
    }
  }

  std::vector<std::set<int>> near_;
  std::vector<int> group_;
  int count_ = 0;
};

/// The surface of a group that an outline goes around.
int label_within(const NamedSurfaces& surfaces,
                 const FarGroups& groups,
                 int group,
                 const Boundary& outline) {
  for (const BoundaryPoint& point : outline.points) {
    const int label = surfaces.at(point.at_px - point.normal);
    if (groups.of(label) == group) {
      return label;
    }
  }
  return NamedSurfaces::kNone;
}

struct SurfaceOutline {
  int label = NamedSurfaces::kNone;
  Boundary outline;
};

/// All outlines of a group, at once or one by one, whichever has fewer pixels to look at: surfaces
/// around each other have large windows.
void add_outlines(const NamedSurfaces& surfaces,
                  const FarGroups& groups,
                  int group,
                  std::span<const Window> windows,
                  std::vector<SurfaceOutline>& outlines) {
  std::vector<int> members;
  Window whole = {.x0 = surfaces.labels.width(), .y0 = surfaces.labels.height()};
  double single = 0.0;
  for (int label = 1; label < static_cast<int>(windows.size()); ++label) {
    if (groups.of(label) == group) {
      members.push_back(label);
      whole = joined(whole, windows[static_cast<std::size_t>(label)]);
      single += area_of(windows[static_cast<std::size_t>(label)]);
    }
  }
  if (single > area_of(whole)) {
    for (Boundary& outline : outlines_in(
             surfaces.labels, whole, [&](int label) { return groups.of(label) == group; })) {
      const int label = label_within(surfaces, groups, group, outline);
      outlines.push_back({.label = label, .outline = std::move(outline)});
    }
    return;
  }
  for (const int member : members) {
    for (Boundary& outline : outlines_in(surfaces.labels,
                                         windows[static_cast<std::size_t>(member)],
                                         [=](int label) { return label == member; })) {
      outlines.push_back({.label = member, .outline = std::move(outline)});
    }
  }
}

/// Pieces of a surface's outline beyond which another one of a higher number begins.
void add_lines(const NamedSurfaces& surfaces,
               int from,
               const Boundary& outline,
               std::vector<SurfaceLine>& lines) {
  SurfaceLine line = {.from = from};
  const auto finish = [&] {
    if (line.line.points.size() >= kMinLine) {
      lines.push_back(line);
    }
    line.line.points.clear();
  };
  for (const BoundaryPoint& point : outline.points) {
    const int to = surfaces.at(point.at_px + kBeside_px * point.normal);
    if (to != line.to) {
      finish();
      line.to = to;
    }
    if (to > from) {
      line.line.points.push_back(point);
    }
  }
  finish();
}

}  // namespace

std::vector<SurfaceLine> lines_between(const NamedSurfaces& surfaces) {
  const std::vector<Window> windows = windows_of(surfaces);
  const FarGroups groups(surfaces);
  std::vector<SurfaceOutline> outlines;
  for (int group = 0; group < groups.count(); ++group) {
    add_outlines(surfaces, groups, group, windows, outlines);
  }
  std::ranges::stable_sort(outlines, {}, &SurfaceOutline::label);
  std::vector<SurfaceLine> lines;
  for (const SurfaceOutline& outline : outlines) {
    if (outline.label > 0) {
      add_lines(surfaces, outline.label, outline.outline, lines);
    }
  }
  return lines;
}

}  // namespace glint
