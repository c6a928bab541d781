// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/better_turn.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/image/image_io.h"
#include "core/units.h"
#include "metrics/appearance/grey_match.h"
#include "metrics/overlap/boundary.h"
#include "metrics/overlap/region_overlap.h"
#include "metrics/shape/equivalent_ellipse.h"
#include "metrics/shape/silhouette.h"

namespace glint {
namespace {

constexpr int kSmallPx = 100;
constexpr double kClearlyBetter = 0.1;
constexpr double kFits = 0.6;
constexpr double kInsideBetter = 0.25;     ///< of correlations within the part
constexpr double kSameOutline = 0.02;      ///< by which its overlap may be less than as it is
constexpr std::ptrdiff_t kInsidePx = 200;  ///< of the small pictures that tell anything
constexpr double kNoMatch = -1.0;          ///< a correlation that every other one beats
constexpr int kLittleTurns = 24;           ///< each way, of so much: up to 12 degrees
constexpr double kLittleTurn_rad = 0.5 * kRadPerDeg;

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

/// @tparam Picture  an Image
template <class Picture>
Picture turned(const Picture& picture, const Turn& turn) {
  Picture result(picture.width(), picture.height());
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

/// A part in a small picture.
struct SmallPart {
  ImageF grey;
  Mask mask;
};

/// Pixels of both parts but for those at a rim.
Mask inside_both(const Mask& first, const Mask& second) {
  Mask inside(first.width(), first.height());
  const auto is_on = [&](int x, int y) { return first(x, y) != 0 && second(x, y) != 0; };
  for (int y = 1; y + 1 < first.height(); ++y) {
    for (int x = 1; x + 1 < first.width(); ++x) {
      const bool is_inside =
          is_on(x, y) && is_on(x - 1, y) && is_on(x + 1, y) && is_on(x, y - 1) && is_on(x, y + 1);
      inside(x, y) = is_inside ? 1 : 0;
    }
  }
  return inside;
}

/// Without the plane through its greys in a region: light from the other side is no turn.
ImageF without_slope(const ImageF& grey, const Mask& region) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-9;
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const auto place = [&](int x, int y) {
    return Eigen::Vector3d(1.0, x - 0.5 * grey.width(), y - 0.5 * grey.height());
  };
  for (int y = 0; y < grey.height(); ++y) {
    for (int x = 0; x < grey.width(); ++x) {
      if (region(x, y) != 0) {
        normal += place(x, y) * place(x, y).transpose();
        right += static_cast<double>(grey(x, y)) * place(x, y);
      }
    }
  }
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  ImageF rest = grey;
  for (int y = 0; y < grey.height(); ++y) {
    for (int x = 0; x < grey.width(); ++x) {
      rest(x, y) -= static_cast<float>(plane.dot(place(x, y)));
    }
  }
  return rest;
}

struct InsideMatch {
  double overlap = 0.0;      ///< IoU of the parts
  double correlation = 0.0;  ///< of their greys, without their slopes
};

InsideMatch inside_match(const SmallPart& first, const SmallPart& second) {
  const Mask region = inside_both(first.mask, second.mask);
  const bool is_enough = std::ranges::count(region.values(), 1) >= kInsidePx;
  return {.overlap = overlap_of(first.mask, second.mask).iou,
          .correlation = is_enough ? correlation_of(without_slope(first.grey, region),
                                                    without_slope(second.grey, region),
                                                    region)
                                   : 0.0};
}

/// Middles of the part in both pictures.
struct PartMiddles {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

std::optional<PartMiddles> middles_of(const Mask& first, const Mask& second) {
  const auto there = moments_of(first);
  const auto here = moments_of(second);
  return there && here ? std::optional<PartMiddles>({.first = {there->x_px, there->y_px},
                                                     .second = {here->x_px, here->y_px}})
                       : std::nullopt;
}

/// The second picture, its part turned (+x to +y) about its middle and laid over that of the first;
/// over the edge what is next to it.
ImageF laid_over(const ImageF& second, const PartMiddles& middles, double turn_rad) {
  const Eigen::Rotation2Dd back(-turn_rad);
  ImageF result(second.width(), second.height());
  for (int y = 0; y < second.height(); ++y) {
    for (int x = 0; x < second.width(); ++x) {
      const Eigen::Vector2d from_middle = Eigen::Vector2d(x + 0.5, y + 0.5) - middles.first;
      result(x, y) = static_cast<float>(sample(second, middles.second + back * from_middle));
    }
  }
  return result;
}

/// The best that the second part gives laid over the first one, turned by little: a symmetric part
/// that lies elsewhere, or is turned a little, is not mirrored.
/// @param match  of the motion that is a turn by some angle
template <class Match>
double best_little_turned(const Match& match) {
  double best = kNoMatch;
  for (int step = -kLittleTurns; step <= kLittleTurns; ++step) {
    best = std::max(best, match(step * kLittleTurn_rad));
  }
  return best;
}

bool fits_shape(const Turn& turn, const ImageF& picture) {
  return !turn.swaps || picture.width() == picture.height();
}

std::optional<SmallPart> part_of(const ImageF& picture) {
  Silhouette found = find_silhouette(picture, PartPieces::kAll);
  return found.mask ? std::optional<SmallPart>({.grey = picture, .mask = *std::move(found.mask)})
                    : std::nullopt;
}

/// As it is where one of the pictures has no part.
double moved_correlation(const ImageF& first, const ImageF& second) {
  const auto part = part_of(first);
  const auto other = part_of(second);
  const auto middles = part && other ? middles_of(part->mask, other->mask) : std::nullopt;
  return middles ? best_little_turned([&](double turn_rad) {
    return correlation_of(first, laid_over(second, *middles, turn_rad));
  })
                 : kNoMatch;
}

/// The same of what is on the parts.
double moved_correlation(const SmallPart& first, const SmallPart& second) {
  const auto middles = middles_of(first.mask, second.mask);
  return middles ? best_little_turned([&](double turn_rad) {
    const ImageF share = laid_over(coverage_of(second.mask), *middles, turn_rad);
    SmallPart moved = {.grey = laid_over(second.grey, *middles, turn_rad),
                       .mask = Mask(share.width(), share.height())};
    std::ranges::transform(share.values(), moved.mask.values().begin(), [](float value) {
      return static_cast<unsigned char>(value >= 0.5F ? 1 : 0);
    });
    return inside_match(first, moved).correlation;
  })
                 : kNoMatch;
}

/// Only where it beats the picture moved a little, too: that is looked at last, as it takes
/// longest.
/// @param moved  gives the correlation of the picture so moved
template <class Moved>
std::optional<BetterTurn> if_better_than(std::optional<BetterTurn> best,
                                         double least,
                                         const Moved& moved) {
  if (best) {
    best->correlation_as_is = std::max(best->correlation_as_is, moved());
  }
  return best && best->correlation > best->correlation_as_is + least ? best : std::nullopt;
}

/// By all of both pictures: outlines that are not symmetric decide.
std::optional<BetterTurn> better_as_a_whole(const ImageF& first, const ImageF& second) {
  const double as_is = correlation_of(first, second);
  std::optional<BetterTurn> best;
  for (const Turn& turn : kTurns) {
    if (!fits_shape(turn, second)) {
      continue;
    }
    const double correlation = correlation_of(first, turned(second, turn));
    const double to_beat = best ? best->correlation : std::max(as_is + kClearlyBetter, kFits);
    if (correlation > to_beat) {
      best = {.name = turn.name, .correlation = correlation, .correlation_as_is = as_is};
    }
  }
  return if_better_than(
      std::move(best), kClearlyBetter, [&] { return moved_correlation(first, second); });
}

/// By what is on the part, where turns leave its outline as it is.
std::optional<BetterTurn> better_inside(const ImageF& first, const ImageF& second) {
  const auto part = part_of(first);
  const auto other = part_of(second);
  if (!part || !other) {
    return std::nullopt;
  }
  const InsideMatch as_is = inside_match(*part, *other);
  std::optional<BetterTurn> best;
  for (const Turn& turn : kTurns) {
    if (!fits_shape(turn, second)) {
      continue;
    }
    const InsideMatch match =
        inside_match(*part, {.grey = turned(other->grey, turn), .mask = turned(other->mask, turn)});
    const double to_beat =
        best ? best->correlation : std::max(as_is.correlation + kInsideBetter, kFits);
    if (match.overlap >= as_is.overlap - kSameOutline && match.correlation > to_beat) {
      best = {.name = turn.name,
              .correlation = match.correlation,
              .correlation_as_is = as_is.correlation,
              .is_inside = true};
    }
  }
  return if_better_than(
      std::move(best), kInsideBetter, [&] { return moved_correlation(*part, *other); });
}

}  // namespace

std::optional<BetterTurn> find_better_turn(const ImageF& simulated, const ImageF& real) {
  const ImageF first = small_of(simulated);
  const ImageF second = small_of(real);
  const auto whole = better_as_a_whole(first, second);
  return whole ? whole : better_inside(first, second);
}

}  // namespace glint
