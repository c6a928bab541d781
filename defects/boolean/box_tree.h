// SPDX-License-Identifier: GPL-3.0-or-later
//
// A search tree over boxes that is quick to build: boxes in Morton order, eight to a node, eight
// nodes to the next, and so on, all in flat arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// Axis-parallel box in float, never smaller than what it was made of. Empty while min > max.
struct FloatBox {
  std::array<float, 3> min_mm = {3e38F, 3e38F, 3e38F};
  std::array<float, 3> max_mm = {-3e38F, -3e38F, -3e38F};

  void add(const FloatBox& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      min_mm[i] = min_mm[i] < other.min_mm[i] ? min_mm[i] : other.min_mm[i];
      max_mm[i] = max_mm[i] > other.max_mm[i] ? max_mm[i] : other.max_mm[i];
    }
  }

  bool overlaps(const FloatBox& other) const {
    int apart = 0;  // without branches: about half of the answers are no
    for (std::size_t i = 0; i < 3; ++i) {
      apart |= static_cast<int>(min_mm[i] > other.max_mm[i]);
      apart |= static_cast<int>(other.min_mm[i] > max_mm[i]);
    }
    return apart == 0;
  }
};

/// The box of a triangle, rounded outwards.
FloatBox box_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

class BoxTree {
 public:
  BoxTree() = default;
  /// Indices of boxes are their places in the list.
  explicit BoxTree(const std::vector<FloatBox>& boxes);

  std::size_t size() const { return order_.size(); }

  std::size_t memory_bytes() const;

  /// Everything; empty for no boxes.
  const FloatBox& bounds() const { return bounds_; }

  /// visit(index) for every box for which meets(box) holds; meets must hold for a box when it holds
  /// for a part of it. The order is the same every time, but not that of the indices.
  template <class Overlaps, class Visit>
  void visit_if(const Overlaps& overlaps, Visit&& visit) const {
    if (!order_.empty() && overlaps(bounds_)) {
      visit_children(levels_.size(), 0, overlaps, visit);
    }
  }

  /// visit(index) for every box that meets the given one (touching is enough).
  template <class Visit>
  void visit(const FloatBox& query, Visit&& visit) const {
    visit_if([&](const FloatBox& box) { return box.overlaps(query); }, visit);
  }

 private:
  static constexpr std::size_t kFanout = 8;

  /// Level 0 are the boxes themselves, level n + 1 the nodes levels_[n].
  template <class Overlaps, class Visit>
  void visit_children(std::size_t level,
                      std::size_t node,
                      const Overlaps& overlaps,
                      Visit& visit) const {
    const std::vector<FloatBox>& children = level == 0 ? boxes_ : levels_[level - 1];
    const std::size_t first = kFanout * node;
    const std::size_t last = std::min(first + kFanout, children.size());
    for (std::size_t i = first; i < last; ++i) {
      if (!overlaps(children[i])) {
        continue;
      }
      if (level == 0) {
        visit(order_[i]);
      } else {
        visit_children(level - 1, i, overlaps, visit);
      }
    }
  }

  std::vector<std::int32_t> order_;  ///< index of each box of boxes_
  std::vector<FloatBox> boxes_;      ///< in Morton order
  std::vector<std::vector<FloatBox>> levels_;
  FloatBox bounds_;
};

}  // namespace glint
