// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/image/spans.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

Mask random_mask(std::uint64_t index) {
  Rng rng(41, Stream::kTest, index);
  const int width = 1 + static_cast<int>(rng.uniform(0.0, 30.0));
  const int height = 1 + static_cast<int>(rng.uniform(0.0, 12.0));
  const double share = rng.uniform();
  Mask mask(width, height);
  for (auto& value : mask.values()) {
    value = rng.uniform() < share ? static_cast<unsigned char>(1 + rng.next_u32() % 255) : 0;
  }
  return mask;
}

Mask mask_of(const Spans& spans, int width, int height) {
  Mask mask(width, height);
  for (const RowSpan& span : spans) {
    std::fill(
        mask.row(span.y) + span.begin, mask.row(span.y) + span.end, static_cast<unsigned char>(1));
  }
  return mask;
}

// 1 1 0 1 0 0 1 in row 1: three stretches; a bridge of 1 joins the first two, of 2 all.
TEST(SpansOf, JoinsGapsUpToTheToleranceByHand) {
  Mask mask(7, 2);
  for (const int x : {0, 1, 3, 6}) {
    mask(x, 1) = 9;
  }
  const auto ends = [&](int gap_tolerance) {
    std::vector<std::pair<int, int>> all;
    for (const RowSpan& span : spans_of(mask, gap_tolerance)) {
      EXPECT_EQ(span.y, 1);
      EXPECT_EQ(span.size(), span.end - span.begin);
      all.emplace_back(span.begin, span.end);
    }
    return all;
  };
  using Ends = std::vector<std::pair<int, int>>;
  EXPECT_EQ(ends(0), (Ends{{0, 2}, {3, 4}, {6, 7}}));
  EXPECT_EQ(ends(1), (Ends{{0, 4}, {6, 7}}));
  EXPECT_EQ(ends(2), (Ends{{0, 7}}));
}

TEST(SpansOf, HoldsExactlyTheMaskWithoutATolerance) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Mask mask = random_mask(i);
    const Mask again = mask_of(spans_of(mask), mask.width(), mask.height());
    for (std::size_t k = 0; k < mask.size(); ++k) {
      ASSERT_EQ(again.values()[k] != 0, mask.values()[k] != 0) << i;
    }
  }
}

TEST(SpansOf, AreSortedApartAndJoinNoMoreThanAsked) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Mask mask = random_mask(i);
    const int gap_tolerance = static_cast<int>(i % 5);
    const Spans spans = spans_of(mask, gap_tolerance);
    for (std::size_t k = 0; k < spans.size(); ++k) {
      ASSERT_NE(mask(spans[k].begin, spans[k].y), 0);
      ASSERT_NE(mask(spans[k].end - 1, spans[k].y), 0);
      if (k > 0 && spans[k].y == spans[k - 1].y) {
        ASSERT_GT(spans[k].begin - spans[k - 1].end, gap_tolerance);
      }
      ASSERT_TRUE(k == 0 || spans[k].y >= spans[k - 1].y);
    }
    const Mask covered = mask_of(spans, mask.width(), mask.height());
    for (std::size_t k = 0; k < mask.size(); ++k) {
      ASSERT_TRUE(covered.values()[k] != 0 || mask.values()[k] == 0);
    }
  }
}

TEST(SpanWalk, FindsThePixelsOfTheMask) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Mask mask = random_mask(i);
    const Spans spans = spans_of(mask);
    SpanWalk all(spans), some(spans);
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        ASSERT_EQ(all.has(x, y), mask(x, y) != 0) << i;
        if ((x + 3 * y) % 7 == 0) {
          ASSERT_EQ(some.has(x, y), mask(x, y) != 0) << i;
        }
      }
    }
  }
}

TEST(WholeImage, IsOneSpanARow) {
  const Spans spans = whole_image(5, 3);
  ASSERT_EQ(spans.size(), 3U);
  for (int y = 0; y < 3; ++y) {
    const RowSpan& span = spans[static_cast<std::size_t>(y)];
    EXPECT_TRUE(span.y == y && span.begin == 0 && span.end == 5);
  }
}

TEST(Dilated, IsTheSquareAroundEachPixel) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Mask mask = random_mask(i);
    const int radius = static_cast<int>(i % 4);
    const Mask wide = dilated(mask, radius);
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        bool is_near = false;
        for (int v = std::max(0, y - radius); v <= std::min(mask.height() - 1, y + radius); ++v) {
          for (int u = std::max(0, x - radius); u <= std::min(mask.width() - 1, x + radius); ++u) {
            is_near = is_near || mask(u, v) != 0;
          }
        }
        ASSERT_EQ(wide(x, y) != 0, is_near) << i << ": " << x << ", " << y;
      }
    }
  }
}

TEST(GrownSpans, AreTheSpansOfTheDilatedMask) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Mask mask = random_mask(i);
    const int radius = static_cast<int>(i % 4);
    const int gap_tolerance = static_cast<int>(i % 3);
    const Spans spans =
        grown_spans(spans_of(mask), radius, gap_tolerance, mask.width(), mask.height());
    const Spans expected = spans_of(dilated(mask, radius), gap_tolerance);
    ASSERT_EQ(spans.size(), expected.size()) << i;
    for (std::size_t k = 0; k < spans.size(); ++k) {
      ASSERT_EQ(spans[k].y, expected[k].y) << i;
      ASSERT_EQ(spans[k].begin, expected[k].begin) << i;
      ASSERT_EQ(spans[k].end, expected[k].end) << i;
    }
  }
}

TEST(Pictures, AreZeroBesideSpansOrInThem) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Mask mask = random_mask(i);
    const Spans spans = spans_of(mask);
    const ImageF beside = zero_beside(spans, mask.width(), mask.height());
    const ImageF in = zero_in(spans, mask.width(), mask.height());
    for (std::size_t k = 0; k < mask.size(); ++k) {
      ASSERT_EQ((mask.values()[k] != 0 ? in : beside).values()[k], 0.0F) << i;
    }
  }
}

}  // namespace
}  // namespace glint
