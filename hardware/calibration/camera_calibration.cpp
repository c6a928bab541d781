// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/LU>

#include "core/median.h"
#include "core/units.h"
#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/lens_choice.h"
#include "hardware/calibration/planar.h"
#include "hardware/calibration/variance_components.h"

namespace glint {
namespace {

constexpr std::size_t kMinCorners = 6;
constexpr double kWorstFocalShare = 0.05;
constexpr double kRejectedRatio = 5.0;
constexpr double kWeakTilt = 8.0 * kRadPerDeg;

/// A calibration on its way: the bundle's views are those of the pictures in `used`.
struct Work {
  std::span<const BoardCorners> pictures;
  const CameraOptions& options;
  CameraCalibration result;
  Bundle bundle;
  std::vector<std::size_t> used;
};

void reject(CalibratedPicture& picture, std::string reason) {
  picture.accepted = false;
  picture.reason = std::move(reason);
}

/// Homographies of the pictures that have one.
std::vector<Eigen::Matrix3d> find_homographies(Work& work) {
  std::vector<Eigen::Matrix3d> found;
  for (std::size_t i = 0; i < work.pictures.size(); ++i) {
    CalibratedPicture& picture = work.result.pictures[i];
    const std::size_t count = work.pictures[i].board_mm.size();
    if (count < kMinCorners || work.pictures[i].picture_px.size() != count) {
      reject(picture, fmt::format("has {} corners, needs {}", count, kMinCorners));
      continue;
    }
    const auto matrix = homography(work.pictures[i]);
    if (!matrix.has_value()) {
      reject(picture, "its corners lie on one line");
      continue;
    }
    found.push_back(*matrix);
    work.used.push_back(i);
  }
  return found;
}

LensVector plain_lens(const Work& work, const Eigen::Vector2d& focal) {
  LensVector lens = LensVector::Zero();
  lens.head<2>() = focal;
  lens.segment<2>(2) = 0.5 * Eigen::Vector2d(work.options.width_px, work.options.height_px);
  return lens;
}

/// Sum of the squares of each picture's own pose, to compare starts.
double squares_of(const Work& work, const LensVector& lens) {
  Bundle bundle = camera_bundle(lens, {});
  double sum = 0.0;
  for (const std::size_t i : work.used) {
    const auto pose = board_pose(work.pictures[i], lens);
    if (!pose) {
      return std::numeric_limits<double>::infinity();
    }
    sum += std::pow(rms_px(bundle, free_view(work.pictures[i], *pose)), 2);
  }
  return sum;
}

/// Zhang's focal lengths, or the best of a row when the views do not give them.
LensVector start_lens(const Work& work, std::span<const Eigen::Matrix3d> homographies) {
  if (work.options.known.has_value()) {
    return work.options.known->lens;
  }
  const double size = std::max(work.options.width_px, work.options.height_px);
  LensVector best = plain_lens(work, {size, size});
  const auto focal = focal_px(homographies, best.segment<2>(2));
  if (focal.has_value() && focal->minCoeff() > 0.2 * size && focal->maxCoeff() < 30.0 * size) {
    return plain_lens(work, *focal);
  }
  double least = std::numeric_limits<double>::infinity();
  for (int i = -2; i <= 8; ++i) {
    const double length = size * std::exp2(0.5 * i);
    const LensVector lens = plain_lens(work, {length, length});
    const double squares = squares_of(work, lens);
    if (squares < least) {
      least = squares;
      best = lens;
    }
  }
  return best;
}

/// Views at poses from their homographies; pictures that have none are rejected.
void start_bundle(Work& work, std::span<const Eigen::Matrix3d> homographies) {
  work.bundle = camera_bundle(start_lens(work, homographies), allowed_terms(work.options));
  work.bundle.lens_prior = prior_of(work.options);
  std::vector<std::size_t> kept;
  for (const std::size_t i : work.used) {
    const auto pose = board_pose(work.pictures[i], work.bundle.lens);
    if (pose.has_value()) {
      work.bundle.views.push_back(free_view(work.pictures[i], *pose));
      kept.push_back(i);
    } else {
      reject(work.result.pictures[i], "no pose of the board explains its corners");
    }
  }
  work.used = kept;
}

/// As rms_px(), without the worst tenth of the corners: a single wrong one is weighed, not the
/// picture rejected.
double trimmed_rms_px(const Bundle& bundle, const BundleView& view) {
  ViewSystem system;
  if (!evaluate_view(bundle, view, bundle.lens, {.error = view.error}, false, system)) {
    return std::numeric_limits<double>::infinity();
  }
  std::vector<double> squares;
  for (Eigen::Index i = 0; i < system.residual_px.size(); i += 2) {
    squares.push_back(system.residual_px.segment<2>(i).squaredNorm());
  }
  std::ranges::sort(squares);
  squares.resize(squares.size() - squares.size() / 10);
  double sum = 0.0;
  for (const double square : squares) {
    sum += square;
  }
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

/// Rejects the pictures that fit far worse than the others. True when there were any.
bool reject_misfits(Work& work) {
  std::vector<double> rms;
  for (const BundleView& view : work.bundle.views) {
    rms.push_back(trimmed_rms_px(work.bundle, view));
  }
  const double middle = median(rms);
  const double limit = std::max(kRejectedRatio * middle, 1e-3);
  std::vector<BundleView> views;
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < rms.size(); ++i) {
    if (rms[i] <= limit) {
      views.push_back(work.bundle.views[i]);
      used.push_back(work.used[i]);
      continue;
    }
    CalibratedPicture& picture = work.result.pictures[work.used[i]];
    picture.rms_px = rms[i];
    reject(picture,
           fmt::format("its corners fit no pose: {:.3g} px rms, the median of all is {:.3g} px",
                       rms[i],
                       middle));
  }
  const bool has_rejected = used.size() < work.used.size();
  work.bundle.views = std::move(views);
  work.used = std::move(used);
  return has_rejected;
}

/// First the terms that every lens has, so that the rest starts near.
bool fit_in_steps(Work& work) {
  const LensMask all = work.bundle.is_free;
  constexpr LensMask kFirst = {true, true, false, false, true};
  for (std::size_t i = 0; i < kLensSize; ++i) {
    work.bundle.is_free[i] = all[i] && kFirst[i];
  }
  const bool has_started = fit_camera(work.bundle, 1);
  work.bundle.is_free = all;
  // Higher terms than the pictures need are not looked at before they are chosen.
  if (!work.options.free_terms.has_value()) {
    work.bundle.is_free[6] = false;
  }
  const bool is_fitted = has_started && fit_camera(work.bundle, 6);
  work.bundle.is_free = all;
  return is_fitted;
}

void choose_terms(Work& work) {
  if (work.options.free_terms.has_value() || work.used.size() < 4) {
    if (!work.options.free_terms.has_value()) {
      work.bundle.is_free[6] = false;
    }
    return;
  }
  const std::size_t taken = choose_lens_terms(work.bundle, work.options, work.result.choices);
  take_lens_terms(work.bundle, work.result.choices[taken].is_free);
}

void take_covariance(Work& work) {
  const CompressedBundle compressed = compress(work.bundle);
  const SharedInformation information =
      shared_information(work.bundle, compressed, work.bundle.noise);
  const Eigen::MatrixXd covariance = inverse_information(information.hessian);
  Eigen::Index a = 0;
  for (Eigen::Index i = 0; i < 9; ++i) {
    if (!work.bundle.is_free[static_cast<std::size_t>(i)]) {
      continue;
    }
    Eigen::Index b = 0;
    for (Eigen::Index j = 0; j < 9; ++j) {
      if (work.bundle.is_free[static_cast<std::size_t>(j)]) {
        work.result.covariance(i, j) = covariance(a, b++);
      }
    }
    ++a;
  }
}

/// Angle between the board's normal and the view to its middle.
double tilt_rad(const Bundle& bundle, const BundleView& view) {
  const Eigen::Isometry3d pose = pose_of(bundle, view);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : view.corners.board_mm) {
    middle += pose * point / static_cast<double>(view.corners.board_mm.size());
  }
  return std::acos(std::min(1.0, std::abs(pose.linear().col(2).dot(middle.normalized()))));
}

void take_pictures(Work& work) {
  CameraCalibration& result = work.result;
  double squares = 0.0;
  double corners = 0.0;
  for (std::size_t i = 0; i < work.used.size(); ++i) {
    const BundleView& view = work.bundle.views[i];
    CalibratedPicture& picture = result.pictures[work.used[i]];
    const auto count = static_cast<double>(view.corners.board_mm.size());
    picture.accepted = true;
    picture.rms_px = rms_px(work.bundle, view);
    picture.camera_from_board = pose_of(work.bundle, view);
    squares += count * picture.rms_px * picture.rms_px;
    corners += count;
    result.largest_tilt_rad = std::max(result.largest_tilt_rad, tilt_rad(work.bundle, view));
  }
  result.rms_px = std::sqrt(squares / corners);
  result.corner_sigma_px = work.bundle.noise.corner_px;
  result.bundle = work.bundle;
}

/// Empty when the focal lengths are known well enough.
std::string weakness_of(const CameraCalibration& result) {
  const Eigen::Vector2d share =
      result.sigma().head<2>().cwiseQuotient(result.lens.head<2>().cwiseAbs());
  constexpr const char* kAdvice =
      "the board is tilted by at most {:.1f} degrees, tilt it by 20 to 30 degrees about both axes";
  const std::string advice = fmt::format(kAdvice, result.largest_tilt_rad * kDegPerRad);
  if (!share.allFinite()) {
    return "the focal length cannot be determined: " + advice;
  }
  if (share.maxCoeff() > kWorstFocalShare) {
    return fmt::format(
        "the focal length stays unknown by {:.2g} %: {}", 100.0 * share.maxCoeff(), advice);
  }
  return {};
}

void add_warnings(CameraCalibration& result) {
  if (result.is_free[0] && result.largest_tilt_rad < kWeakTilt) {
    result.warnings.push_back(fmt::format(
        "the board is tilted by at most {:.1f} degrees: focal length and distance can hardly be "
        "told apart, tilt it by 20 to 30 degrees about both axes",
        result.largest_tilt_rad * kDegPerRad));
  }
}

std::string refusal_before(const Work& work) {
  const bool knows_focal = !allowed_terms(work.options)[0];
  const std::size_t needed = knows_focal ? 1 : 3;
  if (work.used.size() < needed) {
    return fmt::format(
        "{} usable pictures of the board, at least {} are needed", work.used.size(), needed);
  }
  return {};
}

/// The lens terms that the pictures support, the last fit and what it says of itself.
void finish(Work& work) {
  CameraCalibration& result = work.result;
  choose_terms(work);
  const bool is_fitted = fit_camera(work.bundle, 6);
  result.lens = work.bundle.lens;
  result.is_free = work.bundle.is_free;
  take_covariance(work);
  take_pictures(work);
  result.refusal = weakness_of(result);
  if (result.refusal.empty() && !is_fitted) {
    result.refusal = fmt::format(
        "the corners fit no camera, the solution does not converge: the board is tilted by at most "
        "{:.1f} degrees, tilt it by 20 to 30 degrees about both axes",
        result.largest_tilt_rad * kDegPerRad);
  }
}

}  // namespace

CameraCalibration calibrate_camera(std::span<const BoardCorners> pictures,
                                   const CameraOptions& options) {
  Work work{.pictures = pictures, .options = options};
  CameraCalibration& result = work.result;
  result.width_px = options.width_px;
  result.height_px = options.height_px;
  result.pictures.resize(pictures.size());
  if (options.width_px < 1 || options.height_px < 1) {
    result.refusal = "the size of the pictures is not given";
    return result;
  }
  start_bundle(work, find_homographies(work));
  result.refusal = refusal_before(work);
  if (!result.refusal.empty()) {
    return result;
  }
  fit_in_steps(work);
  for (int i = 0; i < 3 && reject_misfits(work) && refusal_before(work).empty(); ++i) {
    fit_in_steps(work);
  }
  result.refusal = refusal_before(work);
  if (!result.refusal.empty()) {
    return result;
  }
  finish(work);
  result.succeeded = result.refusal.empty();
  add_warnings(result);
  return result;
}

}  // namespace glint
