// SPDX-License-Identifier: GPL-3.0-or-later
//
// A set of pixels as stretches of rows: what is worked on where a whole picture is not needed.
#pragma once

#include <utility>
#include <vector>

#include "core/image/image.h"

namespace glint {

/// Part of a row of pixels, [begin, end).
struct RowSpan {
  int y = 0;
  int begin = 0;
  int end = 0;

  int size() const { return end - begin; }
};

/// Sorted by row, then by begin; not overlapping.
using Spans = std::vector<RowSpan>;

Spans whole_image(int width_px, int height_px);

/// Whether pixels are in spans, asked row by row and in each row from left to right.
class SpanWalk {
 public:
  explicit SpanWalk(const Spans& spans) : next_(spans.begin()), end_(spans.end()) {}

  explicit SpanWalk(Spans&&) = delete;

  bool has(int x, int y) {
    while (next_ != end_ && (next_->y < y || (next_->y == y && next_->end <= x))) {
      ++next_;
    }
    return next_ != end_ && next_->y == y && next_->begin <= x;
  }

 private:
  Spans::const_iterator next_, end_;
};

/// The stretches of non-zero pixels. Gaps of up to `gap_tolerance` pixels are included.
Spans spans_of(const Mask& mask, int gap_tolerance = 0);

/// Pixels that are asked for again and again: their stretches are found once.
struct Region {
  Mask mask;
  Spans spans;

  Region() = default;

  Region(Mask pixels)  // NOLINT(google-explicit-constructor): the same pixels
      : mask(std::move(pixels)), spans(spans_of(mask)) {}
};

/// spans_of() of a mask of these spans after dilated(): quick for few spans.
Spans grown_spans(const Spans& spans, int radius, int gap_tolerance, int width_px, int height_px);

/// 0 but for these pixels, which are yet to be set. To clear all of a picture takes longer than to
/// work on a few of its pixels.
ImageF zero_beside(const Spans& spans, int width_px, int height_px);

/// 0 in these pixels; all others are yet to be set.
ImageF zero_in(const Spans& spans, int width_px, int height_px);

/// Non-zero where a pixel of the square of +-radius around is.
Mask dilated(const Mask& mask, int radius);

}  // namespace glint
