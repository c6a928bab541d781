// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/spans.h"

#include <algorithm>
#include <cstdint>
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

/// The first pixel from x on that is set (or not); `width` if there is none.
int find_pixel(const unsigned char* row, int x, int width, bool is_set) {
  constexpr std::uint64_t kOnes = 0x0101010101010101;
  constexpr int kStep = sizeof(kOnes);
  const std::uint64_t skipped = is_set ? 0 : kOnes;
  std::uint64_t eight = 0;
  while (x + kStep <= width) {
    std::memcpy(&eight, row + x, sizeof(eight));
    if (eight != skipped) {
      break;
    }
    x += kStep;
  }
  while (x < width && (row[x] != 0) != is_set) {
    ++x;
  }
  return x;
}

}  // namespace

Spans spans_of(const Mask& mask, int bridge) {
  Spans spans;
  const int width = mask.width();
  for (int y = 0; y < mask.height(); ++y) {
    const unsigned char* row = mask.row(y);
    const std::size_t first_of_row = spans.size();
    for (int begin = find_pixel(row, 0, width, true); begin < width;) {
      const int end = find_pixel(row, begin, width, false);
      if (spans.size() > first_of_row && begin - spans.back().end <= bridge) {
        spans.back().end = end;
      } else {
        spans.push_back({.y = y, .begin = begin, .end = end});
      }
      begin = find_pixel(row, end, width, true);
    }
  }
  return spans;
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

}  // namespace glint
