// SPDX-License-Identifier: GPL-3.0-or-later
//
// A search tree over boxes that is quick to build: boxes are sorted by the Morton code of their
// centres (ten bits per axis, radix sort), every eight neighbours form a node, every eight nodes
// the next one. No splitting heuristic: in an imprint building takes more time than searching. The
// usual idea of a linear bounding volume hierarchy (Lauterbach et al., "Fast BVH construction on
// GPUs", CGF 28, 2009) with a wider node. Cost: linear in the number of boxes. Memory: 32 bytes per
// box.
#include "defects/boolean/box_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint {
namespace {

constexpr int kBitsPerAxis = 10;
constexpr unsigned kRadixBits = 10;
constexpr std::size_t kNumBuckets = std::size_t{1} << kRadixBits;

struct Key {
  std::uint32_t code = 0;
  std::int32_t index = 0;
};

/// Conversion to float loses at most half a unit in the last place (2^-24 of the value).
float rounded_down(double value) {
  const auto nearest = static_cast<float>(value);
  return nearest - (std::abs(nearest) * 1.2e-7F + 1e-37F);
}

float rounded_up(double value) {
  const auto nearest = static_cast<float>(value);
  return nearest + (std::abs(nearest) * 1.2e-7F + 1e-37F);
}

/// Puts two zeros between neighbouring bits of a number of ten bits.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | (bits << 16)) & 0x030000FFU;
  bits = (bits | (bits << 8)) & 0x0300F00FU;
  bits = (bits | (bits << 4)) & 0x030C30C3U;
  return (bits | (bits << 2)) & 0x09249249U;
}

std::vector<Key> morton_keys(const std::vector<FloatBox>& boxes, const FloatBox& bounds) {
  constexpr float kCells = 1 << kBitsPerAxis;
  std::array<float, 3> scale = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const float size = bounds.max_mm[i] - bounds.min_mm[i];
    scale[i] = size > 0.0F ? 0.999F * kCells / size : 0.0F;
  }
  std::vector<Key> keys(boxes.size());
  for (std::size_t box = 0; box < boxes.size(); ++box) {
    std::uint32_t code = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const float centre = 0.5F * (boxes[box].min_mm[i] + boxes[box].max_mm[i]);
      const float cell = std::clamp((centre - bounds.min_mm[i]) * scale[i], 0.0F, kCells - 1.0F);
      code |= spread(static_cast<std::uint32_t>(cell)) << i;
    }
    keys[box] = {code, static_cast<std::int32_t>(box)};
  }
  return keys;
}

/// Stable, by counting: equal codes keep their order.
void sort_by_digit(const std::vector<Key>& from, std::vector<Key>& to, unsigned shift) {
  std::array<std::uint32_t, kNumBuckets> next = {};
  for (const Key& key : from) {
    ++next[(key.code >> shift) & (kNumBuckets - 1)];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& count : next) {
    sum += std::exchange(count, sum);
  }
  for (const Key& key : from) {
    to[next[(key.code >> shift) & (kNumBuckets - 1)]++] = key;
  }
}

void sort_keys(std::vector<Key>& keys) {
  constexpr std::size_t kFew = 1000;  // below, clearing and summing the buckets costs more
  if (keys.size() < kFew) {
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
      return a.code != b.code ? a.code < b.code : a.index < b.index;
    });
    return;
  }
  std::vector<Key> other(keys.size());
  for (unsigned shift = 0; shift < 3 * kBitsPerAxis; shift += kRadixBits) {
    sort_by_digit(keys, other, shift);
    keys.swap(other);
  }
}

std::vector<FloatBox> parents_of(const std::vector<FloatBox>& children, std::size_t fanout) {
  std::vector<FloatBox> parents((children.size() + fanout - 1) / fanout);
  for (std::size_t i = 0; i < children.size(); ++i) {
    parents[i / fanout].add(children[i]);
  }
  return parents;
}

}  // namespace

FloatBox box_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  FloatBox box;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    box.min_mm[axis] = rounded_down(std::min({a[i], b[i], c[i]}));
    box.max_mm[axis] = rounded_up(std::max({a[i], b[i], c[i]}));
  }
  return box;
}

BoxTree::BoxTree(const std::vector<FloatBox>& boxes) : order_(boxes.size()), boxes_(boxes.size()) {
  for (const FloatBox& box : boxes) {
    bounds_.add(box);
  }
  std::vector<Key> keys = morton_keys(boxes, bounds_);
  sort_keys(keys);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    order_[i] = keys[i].index;
    boxes_[i] = boxes[static_cast<std::size_t>(keys[i].index)];
  }
  const std::vector<FloatBox>* below = &boxes_;
  while (below->size() > kFanout) {
    std::vector<FloatBox> parents = parents_of(*below, kFanout);
    levels_.push_back(std::move(parents));
    below = &levels_.back();
  }
}

std::size_t BoxTree::memory_bytes() const {
  std::size_t bytes = order_.capacity() * sizeof(std::int32_t);
  bytes += boxes_.capacity() * sizeof(FloatBox);
  for (const std::vector<FloatBox>& level : levels_) {
    bytes += level.capacity() * sizeof(FloatBox);
  }
  return bytes;
}

}  // namespace glint
