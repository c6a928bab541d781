// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/better_turn.h"

#include <algorithm>
#include <array>

#include "core/image/image_io.h"
#include "metrics/appearance/grey_match.h"

namespace glint {
namespace {

constexpr int kSmallPx = 100;
constexpr double kClearlyBetter = 0.1;
constexpr double kFits = 0.6;

struct Turn {
  const char* name;
  bool flips_x;
  bool flips_y;
  bool swaps;  ///< x and y, before the flips; only of square pictures
};

constexpr std::array<Turn, 7> kTurns = {{{"mirrored from left to right", true, false, false},
                                         {"mirrored from top to bottom", false, true, false},
                                         {"turned by 180 degrees", true, true, false},
                                         {"turned by 90 degrees", true, false, true},
                                         {"turned by 270 degrees", false, true, true},
                                         {"mirrored about a diagonal", false, false, true},
                                         {"mirrored about the other diagonal", true, true, true}}};

ImageF turned(const ImageF& picture, const Turn& turn) {
  ImageF result(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const int u = turn.flips_x ? picture.width() - 1 - x : x;
      const int v = turn.flips_y ? picture.height() - 1 - y : y;
      result(x, y) = turn.swaps ? picture(v, u) : picture(u, v);
    }
  }
  return result;
}

ImageF small_of(const ImageF& picture) {
  return reduce(picture, std::max(1, std::max(picture.width(), picture.height()) / kSmallPx));
}

}  // namespace

std::optional<BetterTurn> find_better_turn(const ImageF& simulated, const ImageF& real) {
  const ImageF first = small_of(simulated);
  const ImageF second = small_of(real);
  const double as_is = correlation_of(first, second);
  std::optional<BetterTurn> best;
  for (const Turn& turn : kTurns) {
    if (turn.swaps && second.width() != second.height()) {
      continue;
    }
    const double correlation = correlation_of(first, turned(second, turn));
    const double to_beat = best ? best->correlation : std::max(as_is + kClearlyBetter, kFits);
    if (correlation > to_beat) {
      best = {.name = turn.name, .correlation = correlation, .correlation_as_is = as_is};
    }
  }
  return best;
}

}  // namespace glint
