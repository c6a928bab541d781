// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which views inspect which points of a surface: a bit for each pair, and a weight for each point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace glint {

/// views x points bits, all 0 at first.
class Visibility {
 public:
  Visibility() = default;
  Visibility(std::size_t num_views, std::size_t num_points);

  std::size_t num_views() const { return num_views_; }

  std::size_t num_points() const { return num_points_; }

  bool sees(std::size_t view, std::size_t point) const {
    return (words_[view * words_per_view_ + point / 64] >> (point % 64) & 1U) != 0;
  }

  /// Two threads may not set points of one view whose numbers / 64 are equal.
  void set(std::size_t view, std::size_t point) {
    words_[view * words_per_view_ + point / 64] |= std::uint64_t{1} << (point % 64);
  }

  /// 64 points a word, point 0 the lowest bit of the first; bits beyond the last point are 0.
  std::span<const std::uint64_t> row(std::size_t view) const {
    return std::span(words_).subspan(view * words_per_view_, words_per_view_);
  }

  std::span<std::uint64_t> row(std::size_t view) {
    return std::span(words_).subspan(view * words_per_view_, words_per_view_);
  }

 private:
  std::size_t num_views_ = 0;
  std::size_t num_points_ = 0;
  std::size_t words_per_view_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace glint
