// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/hand_eye_calibration.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "core/units.h"
#include "hardware/calibration/joint_fit.h"
#include "hardware/calibration/lens_choice.h"
#include "hardware/calibration/moved_board.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Of six degrees of freedom: passed by 1 right picture in 100 000.
constexpr double kChiSquareLimit = 33.1;
constexpr double kWorstHandEyeRad = kRadPerDeg;
constexpr double kWorstRobotRad = 3.0 * kRadPerDeg;
constexpr double kWorstShareOfDistance = 0.05;
constexpr const char* kContradiction =
    "other order, unit, direction or rotation than assumed, or the board or the camera has moved";

/// A calibration on its way.
struct Work {
  std::span<const BoardCorners> pictures;
  std::span<const Isometry3d> base_from_flange;
  const HandEyeOptions& options;
  HandEyeCalibration result;
  BoardSymmetry symmetry;
  std::vector<std::size_t> seen;  ///< pictures that the camera's calibration accepted
  std::vector<PosePair> pairs;    ///< of those
  double distance_mm = 1.0;       ///< median from the camera to the board
  EstimatedNoise estimated;
};

bool is_rigid(const Isometry3d& pose) {
  return pose.matrix().allFinite() &&
         (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 &&
         pose.linear().determinant() > 0.0;
}

std::string fault_of_input(const Work& work) {
  if (work.pictures.size() != work.base_from_flange.size()) {
    return fmt::format(
        "{} pictures but {} robot poses", work.pictures.size(), work.base_from_flange.size());
  }
  for (std::size_t i = 0; i < work.base_from_flange.size(); ++i) {
    if (!is_rigid(work.base_from_flange[i])) {
      return fmt::format("robot pose {} is no rotation and translation", i + 1);
    }
  }
  return {};
}

BoardSymmetry symmetry_of(const Work& work) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  for (const BoardCorners& corners : work.pictures) {
    for (const Vector3d& point : corners.board_mm) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  BoardSymmetry symmetry{.turns = work.options.board_turns, .center_mm = 0.5 * (low + high)};
  if (work.options.board_center_mm.has_value()) {
    symmetry.center_mm.head<2>() = *work.options.board_center_mm;
  }
  // Rms distance of a filled rectangle.
  symmetry.radius_mm = std::max(1e-3, (high - low).norm() / std::sqrt(12.0));
  return symmetry;
}

/// What the camera's calibration says of each picture.
void take_camera(Work& work) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < work.pictures.size(); ++i) {
    const CalibratedPicture& picture = work.result.camera.pictures[i];
    HandEyePicture& own = work.result.pictures[i];
    own.reason = picture.reason;
    own.rms_px = picture.rms_px;
    if (picture.accepted) {
      work.seen.push_back(i);
      work.pairs.push_back({.base_from_flange = work.base_from_flange[i],
                            .camera_from_board = picture.camera_from_board});
      distances.push_back((picture.camera_from_board * work.symmetry.center_mm).norm());
    }
  }
  std::ranges::sort(distances);
  work.distance_mm = distances[distances.size() / 2];
}

std::string refuse_motion(Work& work, const std::vector<std::size_t>& members) {
  std::vector<Isometry3d> poses;
  for (const std::size_t i : members) {
    poses.push_back(work.base_from_flange[i]);
  }
  work.result.motion = motion_geometry(poses);
  return refusal_of(work.result.motion);
}

/// A bundle without views, at the robust solution.
Bundle start_bundle(const Work& work, const RobustHandEye& robust) {
  const CameraCalibration& camera = work.result.camera;
  Bundle bundle{.mounting = work.options.mounting,
                .lens = camera.lens,
                .is_free = camera.is_free,
                .lens_prior = prior_of(work.options.camera),
                .poses = robust.poses,
                .are_poses_free = true};
  // A deviation is that of about six numbers in the robot's and the picture's pose.
  const double size = std::max(0.5 * robust.median_mm, 1e-6);
  bundle.noise = {.corner_px = camera.corner_sigma_px,
                  .robot_rad = size / work.symmetry.radius_mm,
                  .robot_mm = size};
  return bundle;
}

/// Views of the accepted pictures; the board lies as in the first of them.
void take_members(Work& work) {
  Bundle& bundle = work.result.bundle;
  bundle.views.clear();
  int shift = -1;
  const int turns = work.symmetry.turns;
  for (std::size_t i = 0; i < work.pictures.size(); ++i) {
    HandEyePicture& picture = work.result.pictures[i];
    if (picture.accepted && shift < 0) {
      shift = picture.board_turn;
      bundle.poses.board = bundle.poses.board * board_turn(work.symmetry, (turns - shift) % turns);
    }
  }
  for (std::size_t i = 0; i < work.pictures.size(); ++i) {
    HandEyePicture& picture = work.result.pictures[i];
    picture.board_turn = (picture.board_turn - std::max(0, shift) + turns) % turns;
    if (picture.accepted) {
      bundle.views.push_back(
          joint_view(turned_corners(work.pictures[i], work.symmetry, picture.board_turn),
                     work.base_from_flange[i]));
    }
  }
}

/// Looser while the noise sizes rest on few pictures.
double chi_square_limit(const Work& work, bool is_first) {
  const double freedom =
      std::max(1.0, 6.0 * static_cast<double>(work.result.bundle.views.size()) - 12.0);
  return kChiSquareLimit * (1.0 + 20.0 / freedom) * (is_first ? 2.0 : 1.0);
}

/// Tries all pictures against the solution. True when the same ones are accepted as before.
bool accept_again(Work& work, bool is_first) {
  bool is_same = true;
  for (const std::size_t i : work.seen) {
    HandEyePicture& picture = work.result.pictures[i];
    const Agreement agreement =
        agreement_of(work.result.bundle, work.pictures[i], work.base_from_flange[i], work.symmetry);
    const bool accepted = agreement.chi_square <= chi_square_limit(work, is_first);
    is_same = is_same && accepted == picture.accepted && agreement.turn == picture.board_turn;
    picture.accepted = accepted;
    picture.board_turn = agreement.turn;
    picture.chi_square = agreement.chi_square;
    picture.robot_error = agreement.error;
    picture.rms_px = agreement.rms_px;
  }
  return is_same;
}

/// Solves and accepts by turns until the same pictures stay. False when the minimiser fails.
bool solve(Work& work) {
  for (int round = 0; round < 8; ++round) {
    take_members(work);
    if (work.result.bundle.views.size() < 3 || !fit_joint(work.result.bundle, 8, &work.estimated)) {
      return false;
    }
    if (accept_again(work, round == 0) && round > 0) {
      return true;
    }
  }
  take_members(work);
  return fit_joint(work.result.bundle, 8, &work.estimated);
}

/// The error that the robot's pose must have for the picture to be right.
Isometry3d implied_error(const Work& work, const PosePair& pair, int turn) {
  const HandEye& poses = work.result.bundle.poses;
  const Isometry3d seen = pair.camera_from_board * board_turn(work.symmetry, turn);
  if (work.options.mounting == Mounting::kEyeInHand) {
    return pair.base_from_flange.inverse() * poses.board * seen.inverse() *
           poses.hand_eye.inverse();
  }
  return pair.base_from_flange.inverse() * poses.hand_eye * seen * poses.board.inverse();
}

/// The accepted or rejected picture whose robot pose the picture fits.
int pose_that_fits(const Work& work, std::size_t k, int turn) {
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

void explain_rejections(Work& work) {
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
          fmt::format("; it fits the robot pose of picture {}", picture.fits_pose_of + 1);
    }
  }
}

void take_result(Work& work) {
  HandEyeCalibration& result = work.result;
  result.lens = result.bundle.lens;
  result.poses = result.bundle.poses;
  result.noise = result.bundle.noise;
  result.noise_log_sigma = work.estimated.log_sigma;
  result.covariance = shared_covariance(result.bundle);
  result.scale = board_scale(result.bundle);
  double squares = 0.0;
  double corners = 0.0;
  for (const BundleView& view : result.bundle.views) {
    const auto count = static_cast<double>(view.corners.board_mm.size());
    squares += count * std::pow(rms_px(result.bundle, view), 2);
    corners += count;
  }
  result.rms_px = std::sqrt(squares / corners);
  if (is_possible_lens(result.lens, result.camera.width_px, result.camera.height_px)) {
    result.point = point_error(
        result.bundle, result.covariance, result.camera.width_px, result.camera.height_px);
  }
}

std::string refusal_after(const Work& work) {
  const HandEyeCalibration& result = work.result;
  const double limit_mm = kWorstShareOfDistance * work.distance_mm;
  if (!is_possible_lens(result.lens, result.camera.width_px, result.camera.height_px)) {
    return "the distortion that fits folds the picture upon itself";
  }
  if (result.noise.robot_rad > kWorstRobotRad || result.noise.robot_mm > limit_mm) {
    return fmt::format(
        "robot poses and pictures contradict each other by {:.3g} mm and {:.3g} degrees rms: {}",
        result.noise.robot_mm,
        result.noise.robot_rad * kDegPerRad,
        kContradiction);
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

std::ptrdiff_t num_rejected(const Work& work) {
  return std::ranges::count_if(work.seen,
                               [&](std::size_t i) { return !work.result.pictures[i].accepted; });
}

/// Whether so many pictures with a board are rejected that the fault may be one of all.
bool rejects_many(const Work& work) {
  constexpr double kMany = 0.15;
  return static_cast<double>(num_rejected(work)) > kMany * static_cast<double>(work.seen.size());
}

void add_warnings(Work& work) {
  constexpr double kLeastOff = 0.003;
  constexpr double kSigmas = 3.0;
  HandEyeCalibration& result = work.result;
  result.warnings = result.camera.warnings;
  std::ranges::move(warnings_of(result.motion), std::back_inserter(result.warnings));
  if (rejects_many(work)) {
    result.warnings.push_back(fmt::format(
        "{} of {} pictures with a board are rejected: squares of another size than given, or poses "
        "that are a little wrong, look so, too",
        num_rejected(work),
        work.seen.size()));
  }
  const double off = std::abs(result.scale.factor - 1.0);
  if (off > kLeastOff && off > kSigmas * result.scale.sigma) {
    result.warnings.push_back(fmt::format(
        "the robot's motion says that the board's squares are {:.4f} times (+- {:.4f}) as large as "
        "given",
        result.scale.factor,
        result.scale.sigma));
  }
}

/// Whether so many pictures, or so much of all, disagree that the board may have moved.
bool is_suspicious(const Work& work) {
  constexpr double kLargeShareOfDistance = 0.002;
  return !work.result.refusal.empty() || rejects_many(work) ||
         work.result.noise.robot_mm > kLargeShareOfDistance * work.distance_mm;
}

/// Empty when nothing has moved.
std::string refusal_of_moves(const Work& work) {
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
      work.seen[moved->first_after - 1] + 1,
      work.seen[moved->first_after] + 1,
      moved->moved_mm,
      moved->turned_rad * kDegPerRad);
}

BoardOrientation orientation_of(const HandEyeOptions& options) {
  if (options.has_mark) {
    return BoardOrientation::kMark;
  }
  return options.board_turns == 1 ? BoardOrientation::kPattern : BoardOrientation::kFirstPicture;
}

/// Pictures whose board was seen and whose pose was not thrown out.
std::vector<std::size_t> accepted_pictures(const Work& work) {
  std::vector<std::size_t> members;
  for (const std::size_t i : work.seen) {
    if (work.result.pictures[i].accepted) {
      members.push_back(i);
    }
  }
  return members;
}

void mark_inliers(const RobustHandEye& robust, Work& work) {
  for (std::size_t k = 0; k < work.seen.size(); ++k) {
    work.result.pictures[work.seen[k]].accepted = robust.is_inlier[k];
    work.result.pictures[work.seen[k]].board_turn = robust.turns[k];
  }
}

/// Everything until a refusal; empty when there is none.
std::string run(Work& work) {
  HandEyeCalibration& result = work.result;
  if (std::string fault = fault_of_input(work); !fault.empty()) {
    return fault;
  }
  result.camera = calibrate_camera(work.pictures, work.options.camera);
  if (!result.camera.succeeded) {
    return result.camera.refusal;
  }
  work.symmetry = symmetry_of(work);
  take_camera(work);
  if (std::string missing = refuse_motion(work, work.seen); !missing.empty()) {
    return missing;
  }
  const auto robust =
      robust_hand_eye(work.options.mounting, work.pairs, work.symmetry, work.options.seed);
  if (!robust.has_value()) {
    return "no hand-eye explains the poses: the robot turned about one axis only";
  }
  mark_inliers(*robust, work);
  result.bundle = start_bundle(work, *robust);
  if (!solve(work)) {
    constexpr std::size_t kFew = 8;
    return fmt::format(
        "robot poses and pictures contradict each other, no solution converges: {}{}",
        kContradiction,
        work.seen.size() < kFew ? "; or the views are too few or too much alike" : "");
  }
  explain_rejections(work);
  if (std::string missing = refuse_motion(work, accepted_pictures(work)); !missing.empty()) {
    return missing;
  }
  take_result(work);
  add_warnings(work);
  return refusal_after(work);
}

}  // namespace

HandEyeCalibration calibrate_hand_eye(std::span<const BoardCorners> pictures,
                                      std::span<const Isometry3d> base_from_flange,
                                      const HandEyeOptions& options) {
  Work work{.pictures = pictures, .base_from_flange = base_from_flange, .options = options};
  work.result.mounting = options.mounting;
  work.result.orientation = orientation_of(options);
  work.result.pictures.resize(pictures.size());
  work.result.refusal = run(work);
  if (std::string moved = refusal_of_moves(work); !moved.empty()) {
    work.result.refusal = std::move(moved);
  }
  work.result.succeeded = work.result.refusal.empty();
  return work.result;
}

}  // namespace glint
