// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/spans.h"

#include <algorithm>
#include <cstring>

namespace glint {

Spans whole_image(int width_px, int height_px) {
  Spans spans;
  for (int y = 0; y < height_px; ++y) {
    spans.push_back({.y = y, .begin = 0, .end = width_px});
  }
  return spans;
}

namespace {

/// The first pixel from x on that is set; `width` if there is none.
int find_set(const unsigned char* row, int x, int width) {
  constexpr int kBlock = 128;
  static constexpr unsigned char kNone[kBlock] = {};
  while (x + kBlock <= width && std::memcmp(row + x, kNone, kBlock) == 0) {
    x += kBlock;
  }
  while (x < width && row[x] == 0) {
    ++x;
  }
  return x;
}

/// The first pixel from x on that is not set; `width` if there is none.
int find_unset(const unsigned char* row, int x, int width) {
  const void* found = std::memchr(row + x, 0, static_cast<std::size_t>(width - x));
  return found != nullptr ? static_cast<int>(static_cast<const unsigned char*>(found) - row)
                          : width;
}

}  // namespace

Spans spans_of(const Mask& mask, int gap_tolerance) {
  Spans spans;
  const int width = mask.width();
  for (int y = 0; y < mask.height(); ++y) {
    const unsigned char* row = mask.row(y);
    const std::size_t first_of_row = spans.size();
    for (int begin = find_set(row, 0, width); begin < width;) {
      const int end = find_unset(row, begin, width);
      if (spans.size() > first_of_row && begin - spans.back().end <= gap_tolerance) {
        spans.back().end = end;
      } else {
        spans.push_back({.y = y, .begin = begin, .end = end});
      }
      begin = find_set(row, end, width);
    }
  }
  return spans;
}

namespace {

/// Appends the union of spans of one row, in any order, bridged.
void append_union(Spans& pieces, int y, int gap_tolerance, Spans& spans) {
  std::ranges::sort(pieces, {}, &RowSpan::begin);
  const std::size_t first_of_row = spans.size();
  for (const RowSpan& piece : pieces) {
    if (spans.size() > first_of_row && piece.begin - spans.back().end <= gap_tolerance) {
      spans.back().end = std::max(spans.back().end, piece.end);
    } else {
      spans.push_back({.y = y, .begin = piece.begin, .end = piece.end});
    }
  }
}

}  // namespace

Spans grown_spans(const Spans& spans, int radius, int gap_tolerance, int width_px, int height_px) {
  Spans grown;
  Spans pieces;
  auto first = spans.begin();
  for (int y = 0; y < height_px; ++y) {
    while (first != spans.end() && first->y < y - radius) {
      ++first;
    }
    pieces.clear();
    for (auto span = first; span != spans.end() && span->y <= y + radius; ++span) {
      pieces.push_back({.y = y,
                        .begin = std::max(0, span->begin - radius),
                        .end = std::min(width_px, span->end + radius)});
    }
    append_union(pieces, y, gap_tolerance, grown);
  }
  return grown;
}

namespace {

/// to[x] |= from[x]
void join_row(const unsigned char* from, int count, unsigned char* to) {
  for (int x = 0; x < count; ++x) {
    to[x] = static_cast<unsigned char>(to[x] | from[x]);
  }
}

/// Makes each pixel of a row the union of `reach` pixels from it on; the row has that many more.
void widen(int reach, int count, std::vector<unsigned char>& row, std::vector<unsigned char>& old) {
  // A union of n pixels and the same n further on is one of 2 n.
  for (int done = 1; done < reach;) {
    const int step = std::min(done, reach - done);
    std::copy(row.begin(), row.end(), old.begin());
    join_row(old.data() + step, count + reach - done - step, row.data());
    done += step;
  }
}

}  // namespace

/// Rows first, then columns, the rows by doubling.
Mask dilated(const Mask& mask, int radius) {
  const int width = mask.width();
  const int height = mask.height();
  const int reach = 2 * radius + 1;
  Mask wide(width, height);
  std::vector<unsigned char> row(static_cast<std::size_t>(width + reach));
  std::vector<unsigned char> old(row.size());
  for (int y = 0; y < height; ++y) {
    const unsigned char* from = mask.row(y);
    std::ranges::fill(row, static_cast<unsigned char>(0));
    for (int x = 0; x < width; ++x) {
      row[static_cast<std::size_t>(x + radius)] = from[x] != 0 ? 1 : 0;
    }
    widen(reach, width, row, old);
    std::copy_n(row.begin(), width, wide.row(y));
  }
  Mask result(width, height);
  for (int y = 0; y < height; ++y) {
    const int last = std::min(height - 1, y + radius);
    for (int from_y = std::max(0, y - radius); from_y <= last; ++from_y) {
      join_row(wide.row(from_y), width, result.row(y));
    }
  }
  return result;
}

ImageF zero_beside(const Spans& spans, int width_px, int height_px) {
  ImageF image = ImageF::uninitialized(width_px, height_px);
  float* next = image.values().data();
  for (const RowSpan& span : spans) {
    std::fill(next, image.row(span.y) + span.begin, 0.0F);
    next = image.row(span.y) + span.end;
  }
  std::fill(next, image.values().data() + image.size(), 0.0F);
  return image;
}

ImageF zero_in(const Spans& spans, int width_px, int height_px) {
  ImageF image = ImageF::uninitialized(width_px, height_px);
  for (const RowSpan& span : spans) {
    std::fill_n(image.row(span.y) + span.begin, span.size(), 0.0F);
  }
  return image;
}

}  // namespace glint
