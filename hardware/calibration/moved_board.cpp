// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/moved_board.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hardware/calibration/rotation.h"

namespace glint {
namespace {

using Eigen::Isometry3d;

constexpr std::size_t kMinPart = 5;
constexpr double kBetter = 4.0;
constexpr std::size_t kPlaces = 12;  // tried first; then those between the best one's neighbours

/// Deviation that four fifths of the pictures keep below.
double most_of(std::vector<double> deviations) {
  std::ranges::sort(deviations);
  return deviations[(4 * deviations.size()) / 5];
}

struct Split {
  std::size_t at = 0;
  double deviation_mm = std::numeric_limits<double>::infinity();
  std::optional<RobustHandEye> before;
  std::optional<RobustHandEye> after;
};

struct SplitSearch {
  Mounting mounting;
  std::span<const PosePair> pairs;
  const BoardSymmetry& symmetry;
  std::uint64_t seed;
  Split best;

  /// The best place; with an infinite deviation when there is none.
  Split run() {
    const std::size_t last = pairs.size() - kMinPart;
    const std::size_t step = std::max<std::size_t>(1, (last - kMinPart) / kPlaces);
    for (std::size_t at = kMinPart; at <= last; at += step) {
      try_split(at);
    }
    const std::size_t middle = best.at;
    for (std::size_t at = std::max(kMinPart + step, middle) - step;
         at <= last && at < middle + step;
         ++at) {
      try_split(at);
    }
    return best;
  }

  void try_split(std::size_t at) {
    Split split{.at = at,
                .before = robust_hand_eye(mounting, pairs.first(at), symmetry, seed),
                .after = robust_hand_eye(mounting, pairs.subspan(at), symmetry, seed)};
    if (!split.before.has_value() || !split.after.has_value()) {
      return;
    }
    split.deviation_mm =
        std::max(most_of(split.before->deviation_mm), most_of(split.after->deviation_mm));
    if (split.deviation_mm < best.deviation_mm) {
      best = std::move(split);
    }
  }
};

/// The two places of the board, both seen with the hand-eye of the larger part.
class TwoPlaces {
 public:
  TwoPlaces(Mounting mounting,
            std::span<const PosePair> pairs,
            const BoardSymmetry& symmetry,
            const Split& split)
      : mounting_(mounting), pairs_(pairs), symmetry_(symmetry) {
    const bool is_before_larger = 2 * split.at >= pairs.size();
    hand_eye_ = (is_before_larger ? split.before : split.after)->poses.hand_eye;
    before_ = place_of(*split.before, 0);
    after_ = place_of(*split.after, split.at);
    // Of a board without a mark the nearest turn.
    const Isometry3d seen = after_;
    for (int turn = 1; turn < symmetry.turns; ++turn) {
      const Isometry3d turned = seen * board_turn(symmetry, turn);
      after_ = turn_to(before_, turned) < turn_to(before_, after_) ? turned : after_;
    }
  }

  /// With the border where the fewest pictures lie on the wrong side of it.
  MovedBoard result() const {
    std::vector<int> votes;  // 1: as after the move
    for (const PosePair& pair : pairs_) {
      votes.push_back(distance_mm(pair, after_) < distance_mm(pair, before_) ? 1 : 0);
    }
    std::size_t best = 0;
    auto least = static_cast<std::ptrdiff_t>(votes.size());
    for (std::size_t at = 1; at < votes.size(); ++at) {
      const auto border = votes.begin() + static_cast<std::ptrdiff_t>(at);
      const auto wrong = std::count(votes.begin(), border, 1) + std::count(border, votes.end(), 0);
      if (wrong < least) {
        least = wrong;
        best = at;
      }
    }
    return {.first_after = best,
            .moved_mm = (before_ * symmetry_.center_mm - after_ * symmetry_.center_mm).norm(),
            .turned_rad = turn_to(before_, after_)};
  }

 private:
  static double turn_to(const Isometry3d& a, const Isometry3d& b) {
    return angle_rad(a.linear().transpose() * b.linear());
  }

  Isometry3d seen_by(const PosePair& pair) const {
    const Isometry3d robot =
        mounting_ == Mounting::kEyeInHand ? pair.base_from_flange : pair.base_from_flange.inverse();
    return robot * hand_eye_ * pair.camera_from_board;
  }

  Isometry3d place_of(const RobustHandEye& part, std::size_t first) const {
    std::vector<Isometry3d> boards;
    for (std::size_t i = 0; i < part.is_inlier.size(); ++i) {
      if (part.is_inlier[i]) {
        boards.push_back(seen_by(pairs_[first + i]) * board_turn(symmetry_, part.turns[i]));
      }
    }
    return mean_pose(boards);
  }

  double distance_mm(const PosePair& pair, const Isometry3d& place) const {
    double least = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < symmetry_.turns; ++turn) {
      const Isometry3d seen = seen_by(pair) * board_turn(symmetry_, turn);
      const double shift = (seen * symmetry_.center_mm - place * symmetry_.center_mm).norm();
      least = std::min(least, std::hypot(shift, turn_to(seen, place) * symmetry_.radius_mm));
    }
    return least;
  }

  Mounting mounting_;
  std::span<const PosePair> pairs_;
  const BoardSymmetry& symmetry_;
  Isometry3d hand_eye_;
  Isometry3d before_;
  Isometry3d after_;
};

}  // namespace

std::optional<MovedBoard> find_moved_board(Mounting mounting,
                                           std::span<const PosePair> pairs,
                                           const BoardSymmetry& symmetry,
                                           std::uint64_t seed) {
  if (pairs.size() < 2 * kMinPart) {
    return std::nullopt;
  }
  const auto whole = robust_hand_eye(mounting, pairs, symmetry, seed);
  const Split split =
      SplitSearch{.mounting = mounting, .pairs = pairs, .symmetry = symmetry, .seed = seed}.run();
  if (!whole.has_value() || !(kBetter * split.deviation_mm < most_of(whole->deviation_mm))) {
    return std::nullopt;
  }
  return TwoPlaces(mounting, pairs, symmetry, split).result();
}

}  // namespace glint
