// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/lit_pixels.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace glint::footprint_kernels {
namespace {

constexpr LitLimits kLimits = {
    .half_slot_mm = 8.0F, .x_low_mm = -100.0F, .x_high_mm = 100.0F, .widest_mm = 4.0F};

/// Pixels between corners at these places, the same in both rows; x is what the stripes follow.
struct Row {
  std::vector<float> x_mm, y_mm, margin_mm;
  std::vector<unsigned char> kind, occluded;

  std::vector<unsigned char> states() const {
    std::vector<unsigned char> codes(x_mm.size()), state(kind.size());
    corner_codes(x_mm.data(),
                 y_mm.data(),
                 margin_mm.data(),
                 static_cast<int>(x_mm.size()),
                 kLimits,
                 codes.data());
    classify(codes.data(),
             codes.data(),
             {.top = x_mm.data(), .bottom = x_mm.data()},
             kind.data(),
             occluded.data(),
             static_cast<int>(kind.size()),
             kLimits,
             state.data());
    return state;
  }
};

using States = std::vector<unsigned char>;

// Plain; wider than 4 mm; on the slot's edge; in the slot.
TEST(Classify, TellsWhatIsAlwaysLitFromWhatNeverIs) {
  const Row row = {.x_mm = {0.0F, 3.0F, 9.0F, 12.0F, 15.0F},
                   .y_mm = {20.0F, 20.0F, 20.0F, 7.0F, 0.0F},
                   .margin_mm = {50.0F, 50.0F, 50.0F, 50.0F, 50.0F},
                   .kind = {1, 1, 1, 1},
                   .occluded = {0, 0, 0, 0}};
  EXPECT_EQ(row.states(), (States{1, 2, 2, 0}));
}

// Across the slot from edge to edge; over the rim; beside the wall; at an end of the tunnel.
TEST(Classify, LooksAtBothEdgesOfTheSlotTheRimAndTheEnds) {
  const Row slot = {.x_mm = {0.0F, 1.0F},
                    .y_mm = {-8.0F, 8.0F},
                    .margin_mm = {50.0F, 50.0F},
                    .kind = {1},
                    .occluded = {0}};
  EXPECT_EQ(slot.states(), (States{2}));
  const Row others = {.x_mm = {95.0F, 96.0F, 97.0F, 99.0F},
                      .y_mm = {20.0F, 20.0F, 20.0F, 20.0F},
                      .margin_mm = {0.0F, -1.0F, -1.0F, 0.0F},
                      .kind = {1, 1, 1},
                      .occluded = {0, 0, 0}};
  EXPECT_EQ(others.states(), (States{2, 0, 2}));
  const Row end = {.x_mm = {98.0F, 99.0F, 100.0F},
                   .y_mm = {20.0F, 20.0F, 20.0F},
                   .margin_mm = {50.0F, 50.0F, 50.0F},
                   .kind = {1, 1},
                   .occluded = {0, 0}};
  EXPECT_EQ(end.states(), (States{1, 2}));
}

// Of four plain pixels: as it is, without the part, refined, refined but hidden by the wall.
TEST(Classify, PutsWhatSeesNothingFirstAndThenWhatIsRefined) {
  const Row row = {.x_mm = {0.0F, 3.0F, 6.0F, 9.0F, 12.0F},
                   .y_mm = {20.0F, 20.0F, 20.0F, 20.0F, 20.0F},
                   .margin_mm = {50.0F, 50.0F, 50.0F, 50.0F, 50.0F},
                   .kind = {1, 0, 2, 2},
                   .occluded = {0, 0, 0, 1}};
  EXPECT_EQ(row.states(), (States{1, 0, 2, 0}));
}

// Plain all over; reaching into the slot; stripes that may differ by 5 mm; without rays; unknown.
TEST(EvenTiles, AreThoseWhosePixelsAreAllPlain) {
  constexpr int kTiles = 5;
  const std::array<float, kTiles> x_low = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const std::array<float, kTiles> x_high = {3.0F, 3.0F, 5.0F, 3.0F, 3.0F};
  const std::array<float, kTiles> y_low = {8.0F, 7.0F, 8.0F, 0.0F, 8.0F};
  const std::array<float, kTiles> y_high = {20.0F, 20.0F, 20.0F, 0.0F, 20.0F};
  const std::array<float, kTiles> margin_low = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const std::array<unsigned char, kTiles> kind = {1, 1, 1, 2, 0};
  std::array<unsigned char, kTiles> is_even = {};
  even_tiles({.x_low = x_low.data(),
              .x_high = x_high.data(),
              .y_low = y_low.data(),
              .y_high = y_high.data(),
              .margin_low = margin_low.data(),
              .stripes_low = x_low.data(),
              .stripes_high = x_high.data(),
              .kind = kind.data()},
             kTiles,
             kLimits,
             is_even.data());
  EXPECT_EQ(is_even, (std::array<unsigned char, kTiles>{1, 0, 0, 1, 0}));
}

}  // namespace
}  // namespace glint::footprint_kernels
