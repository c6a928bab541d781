// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/hand_eye_verdict.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/units.h"
#include "hardware/calibration/lens_choice.h"
#include "hardware/calibration/moved_board.h"

namespace glint {
namespace {

using Eigen::Isometry3d;

constexpr double kWorstHandEyeRad = kRadPerDeg;
constexpr double kWorstRobotRad = 3.0 * kRadPerDeg;
constexpr double kWorstShareOfDistance = 0.05;
/// Robot errors above this share of the distance are large.
constexpr double kLargeShareOfDistance = 0.002;
/// Fewer pictures do not tell the size of the squares.
constexpr std::size_t kMinViewsOfSize = 10;

/// A picture as its user knows it.
std::string name_of_picture(const HandEyeWork& work, std::size_t i) {
  const std::vector<std::string>& names = work.options.names;
  return i < names.size() ? names[i] : fmt::format("{}", i + 1);
}

/// The error that the robot's pose must have for the picture to be right.
Isometry3d implied_error(const HandEyeWork& work, const PosePair& pair, int turn) {
  const HandEye& poses = work.result.bundle.poses;
  const Isometry3d seen = pair.camera_from_board * board_turn(work.symmetry, turn);
  if (work.options.mounting == Mounting::kEyeInHand) {
    return pair.base_from_flange.inverse() * poses.board * seen.inverse() *
           poses.hand_eye.inverse();
  }
  return pair.base_from_flange.inverse() * poses.hand_eye * seen * poses.board.inverse();
}

/// The accepted or rejected picture whose robot pose the picture fits.
int pose_that_fits(const HandEyeWork& work, std::size_t k, int turn) {
  const NoiseSizes& noise = work.result.bundle.noise;
  const Isometry3d wanted =
      work.pairs[k].base_from_flange * implied_error(work, work.pairs[k], turn);
  for (std::size_t j = 0; j < work.seen.size(); ++j) {
    const Isometry3d off = work.pairs[j].base_from_flange.inverse() * wanted;
    // A single picture's own pose is several times worse than the robot's.
    if (j != k && angle_rad(off.linear()) < std::max(10.0 * noise.robot_rad, 0.2 * kRadPerDeg) &&
        off.translation().norm() < std::max(10.0 * noise.robot_mm, 0.005 * work.distance_mm)) {
      return static_cast<int>(work.seen[j]);
    }
  }
  return -1;
}

/// How far from the flange's axes the board is seen, or with the camera beside the robot held.
double lever_mm(const HandEyeWork& work) {
  return work.options.mounting == Mounting::kEyeInHand
             ? work.distance_mm
             : (work.result.bundle.poses.board * work.symmetry.center_mm).norm();
}

/// The robot's error at the board, of place and rotation together, over the distance.
double robot_share(const HandEyeWork& work) {
  const NoiseSizes& noise = work.result.bundle.noise;
  return std::hypot(noise.robot_mm, noise.robot_rad * lever_mm(work)) / work.distance_mm;
}

/// Whether a solution is none to judge anything by.
bool is_unsure(const HandEyeWork& work) {
  return !work.result.refusal.empty() || rejects_many(work) || has_large_errors(work);
}

/// Whether so many pictures, or so much of all, disagree that the board may have moved.
bool is_suspicious(const HandEyeWork& work) {
  return work.has_disagreed || is_unsure(work);
}

/// "10.01 +- 0.003 mm instead of 10.15 mm"; empty when the size of a square is not known.
std::string squares_text(const HandEyeWork& work, const BoardScale& scale) {
  const double given_mm = work.options.square_mm;
  return given_mm > 0.0 ? fmt::format(": {:.5g} +- {:.2g} mm instead of {:.6g} mm",
                                      given_mm * scale.factor,
                                      given_mm * scale.sigma,
                                      given_mm)
                        : std::string();
}

std::string times_text(const BoardScale& scale) {
  return fmt::format("{:.4f} times (+- {:.4f}) as large as given", scale.factor, scale.sigma);
}

/// How many standard deviations a size must be off; few pictures hardly tell them.
double sigmas_of_size(const HandEyeWork& work) {
  constexpr double kSigmas = 3.0;
  const double freedom =
      std::max(1.0, 6.0 * static_cast<double>(work.result.bundle.views.size()) - 13.0);
  return kSigmas * std::sqrt(1.0 + 20.0 / freedom);
}

/// Whether the robot's motion is surely of another size than that of the pictures by far more than
/// a board can be mistaken.
bool is_of_other_unit(const BoardScale& scale) {
  constexpr double kSigmas = 5.0;
  return (scale.factor < 0.5 || scale.factor > 2.0) &&
         std::abs(scale.factor - 1.0) > kSigmas * scale.sigma;
}

std::string warning_of_noise(const HandEyeWork& work) {
  return work.has_known_noise
             ? fmt::format(
                   "{} pictures are too few to tell how large the robot's errors are; they "
                   "are taken as {:.2g} mm and {:.2g} degrees (standard deviation of an axis)",
                   work.seen.size(),
                   work.result.noise.robot_mm,
                   work.result.noise.robot_rad * kDegPerRad)
             : std::string();
}

std::string warning_of_many(const HandEyeWork& work) {
  return rejects_many(work)
             ? fmt::format(
                   "{} of {} pictures with a board are rejected: poses that are a little "
                   "wrong look so, too",
                   num_rejected(work),
                   work.seen.size())
             : std::string();
}

/// Of a size that is told but not taken. What a bad robot says of it is in its note.
std::string warning_of_size(const HandEyeWork& work) {
  constexpr double kMinOff = 0.003;
  constexpr double kSigmas = 3.0;
  const BoardScale& scale = work.result.scale;
  const double off = std::abs(scale.factor - 1.0);
  const bool is_told =
      !work.is_size_free && !has_large_errors(work) && off > kMinOff && off > kSigmas * scale.sigma;
  return is_told ? fmt::format("the robot's motion says that the board's squares are {}",
                               times_text(scale))
                 : std::string();
}

}  // namespace

std::ptrdiff_t num_rejected(const HandEyeWork& work) {
  return std::ranges::count_if(work.seen,
                               [&](std::size_t i) { return !work.result.pictures[i].accepted; });
}

bool rejects_many(const HandEyeWork& work) {
  constexpr double kMany = 0.15;
  return static_cast<double>(num_rejected(work)) > kMany * static_cast<double>(work.seen.size());
}

bool has_large_errors(const HandEyeWork& work) {
  return robot_share(work) > kLargeShareOfDistance;
}

void explain_rejections(HandEyeWork& work) {
  for (std::size_t k = 0; k < work.seen.size(); ++k) {
    HandEyePicture& picture = work.result.pictures[work.seen[k]];
    if (picture.accepted) {
      continue;
    }
    Isometry3d nearest = implied_error(work, work.pairs[k], 0);
    for (int turn = 0; turn < work.symmetry.turns; ++turn) {
      const Isometry3d error = implied_error(work, work.pairs[k], turn);
      if (six_of(error).head<3>().norm() <= six_of(nearest).head<3>().norm()) {
        nearest = error;
      }
      const int fits = pose_that_fits(work, k, turn);
      picture.fits_pose_of = fits >= 0 ? fits : picture.fits_pose_of;
    }
    picture.reason = fmt::format(
        "its robot pose disagrees with the other pictures by {:.3g} mm and {:.3g} degrees",
        nearest.translation().norm(),
        angle_rad(nearest.linear()) * kDegPerRad);
    if (picture.fits_pose_of >= 0) {
      picture.reason +=
          fmt::format("; it fits the robot pose of picture {}",
                      name_of_picture(work, static_cast<std::size_t>(picture.fits_pose_of)));
    }
  }
}

std::string refusal_of_solution(const HandEyeWork& work) {
  const HandEyeCalibration& result = work.result;
  const double limit_mm = kWorstShareOfDistance * work.distance_mm;
  if (!is_possible_lens(result.lens, result.camera.width_px, result.camera.height_px)) {
    return "the distortion that fits folds the picture upon itself";
  }
  if (is_of_other_unit(result.scale)) {
    return fmt::format(
        "robot poses and pictures contradict each other: the robot moves {:.3g} times as far as "
        "the pictures show: {}",
        result.scale.factor,
        kHandEyeContradiction);
  }
  if (result.noise.robot_rad > kWorstRobotRad || result.noise.robot_mm > limit_mm) {
    return fmt::format(
        "robot poses and pictures contradict each other by {:.3g} mm and {:.3g} degrees rms: {}",
        result.noise.robot_mm,
        result.noise.robot_rad * kDegPerRad,
        kHandEyeContradiction);
  }
  if (!(result.rotation_sigma_rad() <= kWorstHandEyeRad) ||
      !(result.translation_sigma_mm() <= limit_mm)) {
    return fmt::format(
        "the hand-eye stays unknown by {:.2g} degrees and {:.2g} mm: take more pictures, with the "
        "robot turned by 20 to 30 degrees about two axes",
        result.rotation_sigma_rad() * kDegPerRad,
        result.translation_sigma_mm());
  }
  return {};
}

std::string refusal_of_moves(const HandEyeWork& work) {
  if (work.pairs.empty() || !is_suspicious(work)) {
    return {};
  }
  const auto moved =
      find_moved_board(work.options.mounting, work.pairs, work.symmetry, work.options.seed);
  if (!moved.has_value()) {
    return {};
  }
  return fmt::format(
      "board or camera moved between pictures {} and {}, by {:.3g} mm and {:.3g} degrees: "
      "calibrate from the pictures before or after it",
      name_of_picture(work, work.seen[moved->first_after - 1]),
      name_of_picture(work, work.seen[moved->first_after]),
      moved->moved_mm,
      moved->turned_rad * kDegPerRad);
}

bool may_have_other_squares(const HandEyeWork& as_given) {
  constexpr double kSigmas = 2.0;
  const BoardScale& scale = as_given.result.scale;
  return !as_given.result.refusal.empty() || num_rejected(as_given) > 0 ||
         !(std::abs(scale.factor - 1.0) < kSigmas * scale.sigma);
}

bool has_other_squares(const HandEyeWork& as_given, const HandEyeWork& with_free_size) {
  constexpr double kMinOff = 3e-4;
  const BoardScale& scale = with_free_size.result.scale;
  const double off = std::abs(scale.factor - 1.0);
  return with_free_size.result.bundle.views.size() >= kMinViewsOfSize &&
         !is_unsure(with_free_size) && off > kMinOff &&
         off > sigmas_of_size(with_free_size) * scale.sigma &&
         (!as_given.result.refusal.empty() ||
          num_rejected(with_free_size) <= num_rejected(as_given));
}

std::string refusal_of_squares(const HandEyeWork& with_free_size) {
  constexpr double kMaxOff = 0.005;
  const BoardScale& scale = with_free_size.result.scale;
  if (std::abs(scale.factor - 1.0) <= kMaxOff) {
    return {};
  }
  return fmt::format(
      "the robot's motion says that the board's squares are {}{}, more than the 0.5 % that is "
      "corrected: measure them and correct square_mm; if they are right, the robot's lengths or "
      "the "
      "focal length of --camera are off by that",
      times_text(scale),
      squares_text(with_free_size, scale));
}

std::string note_of_squares(const HandEyeWork& with_free_size) {
  const BoardScale& scale = with_free_size.result.scale;
  return fmt::format("the robot's motion says that the board's squares are {}{}; they are taken so",
                     times_text(scale),
                     squares_text(with_free_size, scale));
}

std::string note_of_robot(const HandEyeWork& as_given, const HandEyeWork* with_free_size) {
  if (!has_large_errors(as_given) || as_given.has_known_noise) {
    return {};
  }
  const NoiseSizes& noise = as_given.result.noise;
  std::string text = fmt::format(
      "the robot's poses are off by {:.2g} mm and {:.2g} degrees (standard deviation of an axis; "
      "together {:.2g} % of the distance to the board), while corners are known to {:.2g} px: "
      "the errors are the robot's, not the camera's",
      noise.robot_mm,
      noise.robot_rad * kDegPerRad,
      100.0 * robot_share(as_given),
      noise.corner_px);
  if (with_free_size != nullptr && with_free_size->result.refusal.empty()) {
    const BoardScale& scale = with_free_size->result.scale;
    text += fmt::format(
        "; squares {}{} would leave {:.2g} mm and {:.2g} degrees of it, but such poses are "
        "no ruler",
        times_text(scale),
        squares_text(*with_free_size, scale),
        with_free_size->result.noise.robot_mm,
        with_free_size->result.noise.robot_rad * kDegPerRad);
  }
  return text;
}

void add_warnings(HandEyeWork& work) {
  std::vector<std::string>& warnings = work.result.warnings;
  warnings = work.result.camera.warnings;
  std::ranges::move(warnings_of(work.result.motion), std::back_inserter(warnings));
  for (std::string text : {warning_of_noise(work), warning_of_many(work), warning_of_size(work)}) {
    if (!text.empty()) {
      warnings.push_back(std::move(text));
    }
  }
}

}  // namespace glint
