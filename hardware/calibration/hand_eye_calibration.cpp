// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/hand_eye_calibration.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "hardware/calibration/hand_eye_verdict.h"
#include "hardware/calibration/joint_fit.h"
#include "hardware/calibration/lens_choice.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
/// Of six degrees of freedom: passed by 1 right picture in 100 000.
constexpr double kChiSquareLimit = 33.1;

void resize(BoardCorners& corners, double factor) {
  for (Vector3d& point : corners.board_mm) {
    point *= factor;
  }
}

bool is_possible_size(double size) {
  return size > 0.5 && size < 2.0;
}

bool is_rigid(const Isometry3d& pose) {
  return pose.matrix().allFinite() &&
         (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 &&
         pose.linear().determinant() > 0.0;
}

std::string fault_of_input(const HandEyeWork& work) {
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

BoardSymmetry symmetry_of(const HandEyeWork& work) {
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
void take_camera(HandEyeWork& work) {
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
  work.sized.assign(work.pictures.begin(), work.pictures.end());
  std::ranges::sort(distances);
  work.distance_mm = distances[distances.size() / 2];
}

/// Makes the board that is assumed larger.
void resize_board(HandEyeWork& work, double factor) {
  work.size *= factor;
  work.distance_mm *= factor;
  work.symmetry.center_mm *= factor;
  work.symmetry.radius_mm *= factor;
  for (BoardCorners& corners : work.sized) {
    resize(corners, factor);
  }
  for (BundleView& view : work.result.bundle.views) {
    resize(view.corners, factor);
  }
  for (PosePair& pair : work.pairs) {
    pair.camera_from_board.translation() *= factor;
  }
}

std::string refuse_motion(HandEyeWork& work, const std::vector<std::size_t>& members) {
  std::vector<Isometry3d> poses;
  for (const std::size_t i : members) {
    poses.push_back(work.base_from_flange[i]);
  }
  work.result.motion = motion_geometry(poses);
  return refusal_of(work.result.motion);
}

/// A bundle without views, at the robust solution.
Bundle start_bundle(const HandEyeWork& work, const RobustHandEye& robust) {
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
void take_members(HandEyeWork& work) {
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
          joint_view(turned_corners(work.sized[i], work.symmetry, picture.board_turn),
                     work.base_from_flange[i]));
    }
  }
}

/// Looser while the noise sizes rest on few pictures.
double chi_square_limit(const HandEyeWork& work, bool is_first) {
  const double freedom =
      std::max(1.0, 6.0 * static_cast<double>(work.result.bundle.views.size()) - 12.0);
  return kChiSquareLimit * (1.0 + 20.0 / freedom) * (is_first ? 2.0 : 1.0);
}

/// Tries all pictures against the solution. True when the same ones are accepted as before.
bool accept_again(HandEyeWork& work, bool is_first) {
  bool is_same = true;
  for (const std::size_t i : work.seen) {
    HandEyePicture& picture = work.result.pictures[i];
    const Agreement agreement =
        agreement_of(work.result.bundle, work.sized[i], work.base_from_flange[i], work.symmetry);
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

bool is_few(const HandEyeWork& work) {
  constexpr std::size_t kFew = 8;
  return work.seen.size() < kFew;
}

/// Least squares over all accepted pictures; with a free size by turns with steps of the size.
/// False when the minimiser fails, or the size does not settle.
bool fit(HandEyeWork& work) {
  constexpr double kSmallStep = 0.02;  // in standard deviations of the size
  constexpr int kMaxSteps = 8;
  for (int step = 0; step < kMaxSteps; ++step) {
    const int rounds = work.has_known_noise ? 0 : 8;
    if (!fit_joint(work.result.bundle, rounds, &work.estimated)) {
      return false;
    }
    if (!work.is_size_free) {
      return true;
    }
    const BoardScale scale = board_scale(work.result.bundle);
    if (!is_possible_size(work.size * scale.factor)) {
      return false;
    }
    resize_board(work, scale.factor);
    if (std::abs(scale.factor - 1.0) < kSmallStep * scale.sigma) {
      return true;
    }
  }
  return false;
}

/// Solves and accepts by turns until the same pictures stay. False when the minimiser fails.
bool solve(HandEyeWork& work) {
  for (int round = 0; round < 8; ++round) {
    take_members(work);
    if (work.result.bundle.views.size() < 3 || !fit(work)) {
      return false;
    }
    if (accept_again(work, round == 0) && round > 0) {
      return true;
    }
  }
  take_members(work);
  return fit(work);
}

/// The covariances of what is shared grow by what the size leaves open.
void take_size(const HandEyeWork& work, HandEyeCalibration& result) {
  BoardScale scale = board_scale(result.bundle);
  if (work.is_size_free) {
    const SharedCovariance by_size = scale.coupling * scale.coupling.transpose();
    result.covariance += by_size;
    result.with_unseen += by_size;
    // What is left of the last step is too little to look at.
    scale.factor = work.size;
    scale.sigma *= work.size;
  }
  result.scale = scale;
}

void take_result(HandEyeWork& work) {
  HandEyeCalibration& result = work.result;
  result.lens = result.bundle.lens;
  result.poses = result.bundle.poses;
  result.noise = result.bundle.noise;
  result.noise_log_sigma = work.estimated.log_sigma;
  result.covariance = shared_covariance(result.bundle);
  result.with_unseen = covariance_with_unseen(result.bundle);
  take_size(work, result);
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

BoardOrientation orientation_of(const HandEyeOptions& options) {
  if (options.has_mark) {
    return BoardOrientation::kMark;
  }
  return options.board_turns == 1 ? BoardOrientation::kPattern : BoardOrientation::kFirstPicture;
}

/// Pictures whose board was seen and whose pose was not thrown out.
std::vector<std::size_t> accepted_pictures(const HandEyeWork& work) {
  std::vector<std::size_t> members;
  for (const std::size_t i : work.seen) {
    if (work.result.pictures[i].accepted) {
      members.push_back(i);
    }
  }
  return members;
}

/// The camera, and how the robot moved. A refusal; empty when there is none.
std::string prepare(HandEyeWork& work) {
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
  return refuse_motion(work, work.seen);
}

std::vector<PosePair> turned_inliers(const HandEyeWork& work, const RobustHandEye& robust) {
  std::vector<PosePair> inliers;
  for (std::size_t k = 0; k < work.pairs.size(); ++k) {
    if (robust.is_inlier[k]) {
      inliers.push_back(work.pairs[k]);
      inliers.back().camera_from_board =
          work.pairs[k].camera_from_board * board_turn(work.symmetry, robust.turns[k]);
    }
  }
  return inliers;
}

/// A hand-eye that most pictures agree on; with a free size at the size that they say.
std::optional<RobustHandEye> robust_start(HandEyeWork& work) {
  constexpr int kMaxSteps = 5;
  constexpr double kSmallStep = 1e-3;
  std::optional<RobustHandEye> robust;
  for (int step = 0; step < kMaxSteps; ++step) {
    robust = robust_hand_eye(work.options.mounting, work.pairs, work.symmetry, work.options.seed);
    if (!robust.has_value() || !work.is_size_free) {
      break;
    }
    const double factor =
        board_size_by_motion(work.options.mounting, turned_inliers(work, *robust));
    if (!is_possible_size(work.size * factor) || std::abs(factor - 1.0) < kSmallStep) {
      break;
    }
    resize_board(work, factor);
  }
  return robust;
}

/// Of few pictures that agree roughly it is not said that they contradict each other.
std::string refusal_to_converge(const HandEyeWork& work, const RobustHandEye& robust) {
  constexpr double kRoughShareOfDistance = 0.03;
  if (is_few(work) && robust.median_mm < kRoughShareOfDistance * work.distance_mm) {
    return fmt::format(
        "{} pictures are too few, or too similar, to determine camera and hand-eye: no solution "
        "converges; take more, with the robot turned by 20 to 30 degrees about two axes",
        work.seen.size());
  }
  return fmt::format("robot poses and pictures contradict each other, no solution converges: {}",
                     kHandEyeContradiction);
}

/// From the pictures whose board lies within some of the robust start's medians.
bool solve_near(const RobustHandEye& robust, double medians, HandEyeWork& work) {
  for (std::size_t k = 0; k < work.seen.size(); ++k) {
    HandEyePicture& picture = work.result.pictures[work.seen[k]];
    picture.accepted = robust.deviation_mm[k] <= std::max(medians * robust.median_mm, 1e-6);
    picture.board_turn = robust.turns[k];
  }
  work.result.bundle = start_bundle(work, robust);
  return solve(work);
}

/// From what surely agrees. Where that rejects many it may have fitted its own pictures too well:
/// then from all that agree roughly, and what rejects fewer is taken.
bool solve_from(const RobustHandEye& robust, HandEyeWork& work) {
  constexpr double kSurely = 3.0;
  constexpr double kRoughly = 10.0;
  HandEyeWork wide = work;
  const bool is_solved = solve_near(robust, kSurely, work);
  if (is_solved && !rejects_many(work)) {
    return true;
  }
  work.has_disagreed = wide.has_disagreed = true;
  if (solve_near(robust, kRoughly, wide) &&
      (!is_solved || (num_rejected(wide) < num_rejected(work) && !has_large_errors(wide)))) {
    work = std::move(wide);
    return true;
  }
  return is_solved;
}

/// Few pictures may not tell the sizes of the errors: then those of the start are taken.
bool solve_by_start(const RobustHandEye& robust, HandEyeWork& work) {
  work.has_known_noise = is_few(work);
  return work.has_known_noise && solve_from(robust, work);
}

/// From a prepared calibration to its result. A refusal; empty when there is none.
std::string solve_prepared(HandEyeWork& work) {
  const auto robust = robust_start(work);
  if (!robust.has_value()) {
    return "no hand-eye explains the poses: the robot turned about one axis only";
  }
  if (!solve_from(*robust, work) && !solve_by_start(*robust, work)) {
    return refusal_to_converge(work, *robust);
  }
  explain_rejections(work);
  if (std::string missing = refuse_motion(work, accepted_pictures(work)); !missing.empty()) {
    return missing;
  }
  take_result(work);
  add_warnings(work);
  return refusal_of_solution(work);
}

void add_note(HandEyeCalibration& result, std::string note) {
  if (!note.empty()) {
    result.notes.push_back(std::move(note));
  }
}

/// With squares as given; where these do not fit and others do, with those.
void solve_either(HandEyeWork& work) {
  HandEyeWork free = work;
  work.result.refusal = solve_prepared(work);
  if (!may_have_other_squares(work)) {
    add_note(work.result, note_of_robot(work, nullptr));
    return;
  }
  free.is_size_free = true;
  free.result.refusal = solve_prepared(free);
  if (!has_other_squares(work, free)) {
    add_note(work.result, note_of_robot(work, &free));
    return;
  }
  work.result = std::move(free.result);
  work.result.has_other_squares = true;
  work.result.refusal = refusal_of_squares(work);
  if (work.result.refusal.empty()) {
    add_note(work.result, note_of_squares(work));
  }
}

}  // namespace

HandEyeCalibration calibrate_hand_eye(std::span<const BoardCorners> pictures,
                                      std::span<const Isometry3d> base_from_flange,
                                      const HandEyeOptions& options) {
  HandEyeWork work{.pictures = pictures, .base_from_flange = base_from_flange, .options = options};
  work.result.mounting = options.mounting;
  work.result.orientation = orientation_of(options);
  work.result.pictures.resize(pictures.size());
  work.result.refusal = prepare(work);
  if (work.result.refusal.empty()) {
    solve_either(work);
  }
  if (!work.result.has_other_squares) {
    if (std::string moved = refusal_of_moves(work); !moved.empty()) {
      work.result.refusal = std::move(moved);
    }
  }
  work.result.succeeded = work.result.refusal.empty();
  return work.result;
}

}  // namespace glint
