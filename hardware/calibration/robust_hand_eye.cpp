// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/robust_hand_eye.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kSubsets = 200;
constexpr std::size_t kSubsetSize = 5;
constexpr std::size_t kReferences = 8;
constexpr double kInlierRatio = 3.0;
constexpr double kHalfTurnMargin = 0.1;  // rad; beyond, the sign of a rotation vector is chance

/// The robot's side of G X C = Y: base_from_flange, or its inverse for a camera beside the robot.
Isometry3d robot_side(Mounting mounting, const PosePair& pair) {
  return mounting == Mounting::kEyeInHand ? pair.base_from_flange : pair.base_from_flange.inverse();
}

/// Two motions with P X = X Q.
struct MotionPair {
  Isometry3d robot;
  Isometry3d camera;
};

std::vector<MotionPair> motions_of(Mounting mounting, std::span<const PosePair> pairs) {
  std::vector<MotionPair> motions;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Isometry3d from = robot_side(mounting, pairs[i]);
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      motions.push_back(
          {.robot = robot_side(mounting, pairs[j]).inverse() * from,
           .camera = pairs[j].camera_from_board * pairs[i].camera_from_board.inverse()});
    }
  }
  return motions;
}

std::optional<Matrix3d> park_rotation(std::span<const MotionPair> motions) {
  Matrix3d sum = Matrix3d::Zero();
  for (const MotionPair& motion : motions) {
    const Vector3d p = rotation_vector_rad(motion.robot.linear());
    const Vector3d q = rotation_vector_rad(motion.camera.linear());
    if (std::max(p.norm(), q.norm()) < std::numbers::pi - kHalfTurnMargin) {
      sum += p * q.transpose();
    }
  }
  const Eigen::JacobiSVD<Matrix3d> svd(sum);
  if (!(svd.singularValues()[1] > 1e-9 * svd.singularValues()[0])) {
    return std::nullopt;
  }
  return nearest_rotation(sum);
}

/// (R_P - I) t = R t_Q - t_P, by least squares.
Vector3d park_translation(std::span<const MotionPair> motions, const Matrix3d& rotation) {
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const MotionPair& motion : motions) {
    const Matrix3d rows = motion.robot.linear() - Matrix3d::Identity();
    normal += rows.transpose() * rows;
    right +=
        rows.transpose() * (rotation * motion.camera.translation() - motion.robot.translation());
  }
  return normal.ldlt().solve(right);
}

Isometry3d board_by(Mounting mounting, const Isometry3d& hand_eye, const PosePair& pair) {
  return robot_side(mounting, pair) * hand_eye * pair.camera_from_board;
}

/// What a hypothesis makes of all pictures.
struct Score {
  double median_mm = std::numeric_limits<double>::infinity();
  std::vector<double> deviation_mm;
  std::vector<int> turns;
};

class Search {
 public:
  Search(Mounting mounting,
         std::span<const PosePair> pairs,
         const BoardSymmetry& symmetry,
         std::uint64_t seed)
      : mounting_(mounting), pairs_(pairs), symmetry_(symmetry), seed_(seed) {
    for (int turn = 0; turn < symmetry.turns; ++turn) {
      turns_.push_back(board_turn(symmetry, turn));
    }
  }

  std::optional<RobustHandEye> run() {
    for (int i = 0; i < kSubsets; ++i) {
      try_subset(i);
    }
    if (!std::isfinite(best_.median_mm)) {
      return std::nullopt;
    }
    for (int i = 0; i < 5 && refine(); ++i) {
    }
    return result();
  }

 private:
  /// Different pictures at random.
  std::vector<std::size_t> draw(std::size_t count, int index, std::uint64_t purpose) const {
    std::vector<std::size_t> all(pairs_.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = i;
    }
    Rng rng(seed_, Stream::kResampling, 2 * static_cast<std::uint64_t>(index) + purpose);
    count = std::min(count, all.size());
    for (std::size_t i = 0; i < count; ++i) {
      const auto left = static_cast<double>(all.size() - i);
      std::swap(all[i], all[i + static_cast<std::size_t>(rng.uniform() * left)]);
    }
    all.resize(count);
    return all;
  }

  PosePair turned(std::size_t i, int turn) const {
    return {
        .base_from_flange = pairs_[i].base_from_flange,
        .camera_from_board = pairs_[i].camera_from_board * turns_[static_cast<std::size_t>(turn)]};
  }

  /// The turn of a picture that makes its angle to the first one the robot's.
  int turn_against(const PosePair& first, std::size_t i) const {
    const Matrix3d robot =
        first.base_from_flange.linear().transpose() * pairs_[i].base_from_flange.linear();
    const double wanted = angle_rad(robot);
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < symmetry_.turns; ++turn) {
      const Matrix3d camera =
          turned(i, turn).camera_from_board.linear() * first.camera_from_board.linear().transpose();
      const double off = std::abs(angle_rad(camera) - wanted);
      if (off < least) {
        least = off;
        best = turn;
      }
    }
    return best;
  }

  void try_subset(int index) {
    const std::vector<std::size_t> drawn = draw(kSubsetSize, index, 0);
    std::vector<PosePair> subset;
    for (const std::size_t i : drawn) {
      // Every second time as detected: angles can agree by chance.
      const bool by_angle = !subset.empty() && index % 2 == 0;
      subset.push_back(turned(i, by_angle ? turn_against(subset[0], i) : 0));
    }
    const auto poses = park(mounting_, subset);
    if (poses.has_value()) {
      keep_if_better(*poses, index);
    }
  }

  double deviation_mm(const Isometry3d& a, const Isometry3d& b) const {
    const double turn = angle_rad(a.linear().transpose() * b.linear());
    const double shift = (a * symmetry_.center_mm - b * symmetry_.center_mm).norm();
    return std::hypot(shift, turn * symmetry_.radius_mm);
  }

  Score score_against(const Isometry3d& hand_eye, const Isometry3d& board) const {
    Score score;
    for (const PosePair& pair : pairs_) {
      const Isometry3d seen = board_by(mounting_, hand_eye, pair);
      double least = std::numeric_limits<double>::infinity();
      int best = 0;
      for (int turn = 0; turn < symmetry_.turns; ++turn) {
        const double off = deviation_mm(seen * turns_[static_cast<std::size_t>(turn)], board);
        if (off < least) {
          least = off;
          best = turn;
        }
      }
      score.deviation_mm.push_back(least);
      score.turns.push_back(best);
    }
    std::vector<double> sorted = score.deviation_mm;
    std::ranges::sort(sorted);
    score.median_mm = sorted[sorted.size() / 2];
    return score;
  }

  bool keep_if_better(const HandEye& poses, int index) {
    bool is_better = false;
    std::vector<Isometry3d> boards = {poses.board};
    for (const std::size_t i : draw(kReferences, index, 1)) {
      boards.push_back(board_by(mounting_, poses.hand_eye, pairs_[i]));
    }
    for (const Isometry3d& board : boards) {
      Score score = score_against(poses.hand_eye, board);
      if (score.median_mm < best_.median_mm) {
        best_ = std::move(score);
        poses_ = {.hand_eye = poses.hand_eye, .board = board};
        is_better = true;
      }
    }
    return is_better;
  }

  bool is_inlier(std::size_t i) const {
    return best_.deviation_mm[i] <= std::max(kInlierRatio * best_.median_mm, 1e-6);
  }

  /// Once more from all inliers.
  bool refine() {
    std::vector<PosePair> inliers;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (is_inlier(i)) {
        inliers.push_back(turned(i, best_.turns[i]));
      }
    }
    const auto poses = park(mounting_, inliers);
    return poses.has_value() && keep_if_better(*poses, 0);
  }

  /// With the board as the first inlier saw it.
  RobustHandEye result() const {
    RobustHandEye found{.poses = poses_,
                        .turns = best_.turns,
                        .deviation_mm = best_.deviation_mm,
                        .median_mm = best_.median_mm};
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      found.is_inlier.push_back(is_inlier(i));
    }
    const auto first = static_cast<std::size_t>(std::ranges::find(found.is_inlier, true) -
                                                found.is_inlier.begin());
    const int shift = found.turns[first];
    found.poses.board =
        found.poses.board *
        turns_[static_cast<std::size_t>((symmetry_.turns - shift) % symmetry_.turns)];
    for (int& turn : found.turns) {
      turn = (turn - shift + symmetry_.turns) % symmetry_.turns;
    }
    return found;
  }

  Mounting mounting_;
  std::span<const PosePair> pairs_;
  BoardSymmetry symmetry_;
  std::uint64_t seed_;
  std::vector<Isometry3d> turns_;
  Score best_;
  HandEye poses_;
};

}  // namespace

Isometry3d board_turn(const BoardSymmetry& symmetry, int turn) {
  const double angle = 2.0 * std::numbers::pi * turn / symmetry.turns;
  Isometry3d result = Isometry3d::Identity();
  result.linear() = rotation_of(angle * Vector3d::UnitZ());
  result.translation() = symmetry.center_mm - result.linear() * symmetry.center_mm;
  return result;
}

std::optional<HandEye> park(Mounting mounting, std::span<const PosePair> pairs) {
  if (pairs.size() < 3) {
    return std::nullopt;
  }
  const std::vector<MotionPair> motions = motions_of(mounting, pairs);
  const auto rotation = park_rotation(motions);
  if (!rotation.has_value()) {
    return std::nullopt;
  }
  HandEye poses;
  poses.hand_eye.linear() = *rotation;
  poses.hand_eye.translation() = park_translation(motions, *rotation);
  if (!poses.hand_eye.matrix().allFinite()) {
    return std::nullopt;
  }
  std::vector<Isometry3d> boards;
  for (const PosePair& pair : pairs) {
    boards.push_back(board_by(mounting, poses.hand_eye, pair));
  }
  poses.board = mean_pose(boards);
  return poses;
}

double board_size_by_motion(Mounting mounting, std::span<const PosePair> pairs) {
  const std::vector<MotionPair> motions = motions_of(mounting, pairs);
  const auto rotation = park_rotation(motions);
  if (pairs.size() < 3 || !rotation.has_value()) {
    return 1.0;
  }
  // (R_P - I) t - s R t_Q = -t_P
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const MotionPair& motion : motions) {
    Eigen::Matrix<double, 3, 4> rows;
    rows << motion.robot.linear() - Matrix3d::Identity(), -*rotation * motion.camera.translation();
    normal += rows.transpose() * rows;
    right -= rows.transpose() * motion.robot.translation();
  }
  constexpr double kPriorSigma = 0.1;
  constexpr double kTypicalMm2 = 1.0;  // what a row leaves, squared
  normal(3, 3) += kTypicalMm2 / (kPriorSigma * kPriorSigma);
  right[3] += kTypicalMm2 / (kPriorSigma * kPriorSigma);
  return normal.ldlt().solve(right)[3];
}

BoardScatter board_scatter(Mounting mounting,
                           const Isometry3d& hand_eye,
                           std::span<const PosePair> pairs) {
  std::vector<Isometry3d> boards;
  for (const PosePair& pair : pairs) {
    boards.push_back(board_by(mounting, hand_eye, pair));
  }
  const Isometry3d mean = mean_pose(boards);
  const auto count = static_cast<double>(boards.size());
  BoardScatter scatter;
  for (const Isometry3d& board : boards) {
    const double turn = angle_rad(mean.linear().transpose() * board.linear());
    scatter.rotation_rad += turn * turn / count;
    scatter.translation_mm += (board.translation() - mean.translation()).squaredNorm() / count;
  }
  scatter.rotation_rad = std::sqrt(scatter.rotation_rad);
  scatter.translation_mm = std::sqrt(scatter.translation_mm);
  return scatter;
}

std::optional<RobustHandEye> robust_hand_eye(Mounting mounting,
                                             std::span<const PosePair> pairs,
                                             const BoardSymmetry& symmetry,
                                             std::uint64_t seed) {
  if (pairs.size() < 3) {
    return std::nullopt;
  }
  return Search(mounting, pairs, symmetry, seed).run();
}

}  // namespace glint
