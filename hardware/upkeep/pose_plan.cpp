// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/upkeep/pose_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "core/error.h"
#include "core/rng.h"
#include "hardware/calibration/bundle_diagnostics.h"
#include "hardware/calibration/variance_components.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kCandidates = 600;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Where the board lies in a picture, in words of a photographer.
struct View {
  double distance_mm = 0.0;
  Vector2d place_px = {0.0, 0.0};  ///< of the board's middle
  Vector2d tilt_rad = {0.0, 0.0};  ///< about the picture's x and y
  double roll_rad = 0.0;
};

/// Views of a board by a rough camera.
class Photographer {
 public:
  explicit Photographer(const PlanRequest& request) : request_(request), camera_(request.camera) {
    shown_mm_ = request.board_mm;
    shown_mm_.insert(shown_mm_.end(), request.outline_mm.begin(), request.outline_mm.end());
    for (const Vector3d& point : shown_mm_) {
      low_ = low_.cwiseMin(point);
      high_ = high_.cwiseMax(point);
    }
    middle_ = 0.5 * (low_ + high_);
    const double size_mm = (high_ - low_).head<2>().norm();
    const double focal = request.camera.focal_px.mean();
    const int shorter = std::min(request.camera.width_px, request.camera.height_px);
    take_distances(focal * size_mm / (0.9 * shorter), focal * size_mm / (0.4 * shorter));
  }

  double near_mm() const { return near_mm_; }

  double far_mm() const { return far_mm_; }

  /// Empty when some of the board would be outside or out of focus.
  std::optional<Isometry3d> camera_from_board(const View& view) const {
    const auto ray = camera_.ray_through(view.place_px);
    if (!ray) {
      return std::nullopt;
    }
    Isometry3d pose = Isometry3d::Identity();
    pose.translate(*ray * (view.distance_mm / ray->z()));
    pose.rotate(Eigen::AngleAxisd(view.tilt_rad.x(), Vector3d::UnitX()));
    pose.rotate(Eigen::AngleAxisd(view.tilt_rad.y(), Vector3d::UnitY()));
    pose.rotate(Eigen::AngleAxisd(view.roll_rad, Vector3d::UnitZ()));
    pose.translate(-middle_);
    return shows_all(pose) ? std::optional(pose) : std::nullopt;
  }

  [[noreturn]] void refuse(int found) const {
    throw ConfigError(
        fmt::format("only {} of the poses tried show the whole board from {:.4g} to {:.4g} mm: "
                    "another distance, a "
                    "smaller board or less tilt is needed",
                    found,
                    near_mm_,
                    far_mm_));
  }

 private:
  /// Where the board fills enough of the picture and is sharp; where nothing is both, sharp.
  void take_distances(double by_size_near_mm, double by_size_far_mm) {
    sharp_near_mm_ = request_.near_mm > 0.0 ? request_.near_mm : request_.sharp_near_mm;
    sharp_far_mm_ = request_.far_mm > 0.0 ? request_.far_mm : request_.sharp_far_mm;
    near_mm_ = std::max(by_size_near_mm, sharp_near_mm_);
    far_mm_ = std::min(by_size_far_mm, sharp_far_mm_);
    if (request_.near_mm > 0.0 || near_mm_ >= far_mm_) {
      near_mm_ = sharp_near_mm_ > 0.0 ? sharp_near_mm_ : by_size_near_mm;
    }
    if (request_.far_mm > 0.0 || near_mm_ >= far_mm_) {
      far_mm_ = std::isfinite(sharp_far_mm_) ? sharp_far_mm_ : by_size_far_mm;
    }
    if (near_mm_ >= far_mm_) {
      take_other_end();
    }
  }

  /// Where one end alone is asked for, and the board fills enough of the picture only beyond it.
  void take_other_end() {
    constexpr double kRange = 1.5;
    if (sharp_near_mm_ >= sharp_far_mm_) {
      throw ConfigError(fmt::format(
          "plan.near_mm and plan.far_mm: from {:.4g} to {:.4g} mm is no distance; [lens] "
          "of the camera's file says what they do not: give both",
          sharp_near_mm_,
          sharp_far_mm_));
    }
    if (request_.near_mm > 0.0 || sharp_near_mm_ >= far_mm_) {
      far_mm_ = std::min(kRange * near_mm_, sharp_far_mm_);
    } else {
      near_mm_ = std::max(far_mm_ / kRange, sharp_near_mm_);
    }
  }

  bool shows_all(const Isometry3d& pose) const {
    const double margin = request_.margin_px;
    return std::ranges::all_of(shown_mm_, [&](const Vector3d& point) {
      const Vector3d seen = pose * point;
      const auto pixel = camera_.project(seen);
      const bool is_sharp = seen.z() >= sharp_near_mm_ && seen.z() <= sharp_far_mm_;
      return pixel && is_sharp && pixel->x() >= margin && pixel->y() >= margin &&
             pixel->x() <= request_.camera.width_px - margin &&
             pixel->y() <= request_.camera.height_px - margin;
    });
  }

  const PlanRequest& request_;
  PinholeCamera camera_;
  std::vector<Vector3d> shown_mm_;
  Vector3d low_ = Vector3d::Constant(kInfinite);
  Vector3d high_ = Vector3d::Constant(-kInfinite);
  Vector3d middle_;
  double near_mm_ = 0.0;
  double far_mm_ = 0.0;
  double sharp_near_mm_ = 0.0;
  double sharp_far_mm_ = kInfinite;
};

View random_view(const PlanRequest& request, const Photographer& photographer, Rng& rng) {
  View view{.distance_mm = rng.uniform(photographer.near_mm(), photographer.far_mm())};
  view.place_px = {rng.uniform(0.0, request.camera.width_px),
                   rng.uniform(0.0, request.camera.height_px)};
  const bool is_flat = rng.uniform() < 0.125;
  const double tilt = is_flat ? 0.0 : rng.uniform(request.tilt_min_rad, request.tilt_max_rad);
  const double about = rng.uniform(0.0, 2.0 * std::numbers::pi);
  view.tilt_rad = {tilt * std::cos(about), tilt * std::sin(about)};
  view.roll_rad = rng.uniform(-request.roll_rad, request.roll_rad);
  return view;
}

/// The unknowns, without pictures.
Bundle bundle_of(const PlanRequest& request) {
  return with_unseen({.mounting = request.mounting,
                      .lens = lens_vector(request.camera),
                      .is_free = request.is_free,
                      .poses = request.poses,
                      .are_poses_free = true,
                      .noise = request.noise});
}

BundleView view_of(const PlanRequest& request, const Isometry3d& camera_from_board) {
  BundleView view{.base_from_flange =
                      flange_that_sees(request.mounting, request.poses, camera_from_board)};
  view.corners.board_mm = request.board_mm;
  for (const Vector3d& point : request.board_mm) {
    view.corners.picture_px.push_back(
        project_by_lens(lens_vector(request.camera), camera_from_board * point, nullptr)
            .value_or(Vector2d::Zero()));
  }
  view.weights = Eigen::VectorXd::Ones(std::ssize(request.board_mm));
  return view;
}

MatrixXd information_of(const PlanRequest& request, const Isometry3d& camera_from_board) {
  Bundle bundle = bundle_of(request);
  bundle.lens_prior.reset();
  bundle.views.push_back(view_of(request, camera_from_board));
  return shared_information(bundle, compress(bundle), bundle.noise).hessian;
}

/// What is known before: enough that every sum can be inverted, and what the pictures that there
/// are tell.
MatrixXd first_information(const PlanRequest& request) {
  const double focal = request.camera.focal_px.mean();
  LensVector lens;
  lens << 0.1 * focal, 0.1 * focal, 0.1 * focal, 0.1 * focal, 1.0, 10.0, 100.0, 0.1, 0.1;
  const Bundle bundle = bundle_of(request);
  std::vector<double> sigma;
  for (std::size_t i = 0; i < kLensSize; ++i) {
    if (bundle.is_free[i]) {
      sigma.push_back(lens[static_cast<Eigen::Index>(i)]);
    }
  }
  for (const double pose : {1.0, 1000.0, 1.0, 1000.0}) {
    sigma.insert(sigma.end(), 3, pose);
  }
  const Eigen::Map<const Eigen::VectorXd> all(sigma.data(), std::ssize(sigma));
  MatrixXd information = all.cwiseAbs2().cwiseInverse().asDiagonal();
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(all.size());
  add_lens_prior(bundle, information, gradient);
  for (const Isometry3d& pose : request.taken) {
    information += information_of(request, pose.inverse());
  }
  return information;
}

HandEyeSigma hand_eye_sigma(const MatrixXd& information) {
  const Eigen::VectorXd variances = inverse_information(information).diagonal().tail<12>();
  return {.rad = std::sqrt(variances.head<3>().sum()),
          .mm = std::sqrt(variances.segment<3>(3).sum())};
}

/// Natural logarithm of a determinant, in units that make the diagonal one.
double log_determinant(const MatrixXd& information) {
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd even = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LLT<MatrixXd> factor(even);
  return factor.info() == Eigen::Success
             ? 2.0 * (factor.matrixL().toDenseMatrix().diagonal().array().log().sum() -
                      scale.array().log().sum())
             : -kInfinite;
}

/// The more, the better.
double worth_of(const PlanRequest& request, const MatrixXd& information) {
  if (request.aim_rad <= 0.0 && request.aim_mm <= 0.0) {
    return log_determinant(information);
  }
  const HandEyeSigma sigma = hand_eye_sigma(information);
  const double turn = request.aim_rad > 0.0 ? sigma.rad / request.aim_rad : 0.0;
  const double shift = request.aim_mm > 0.0 ? sigma.mm / request.aim_mm : 0.0;
  return -(turn * turn + shift * shift);
}

/// What the hand-eye is known to, from the pictures that there are to the last pose.
void foretell(const PlanRequest& request, PosePlan& plan) {
  MatrixXd information = first_information(request);
  plan.before = hand_eye_sigma(information);
  for (const Isometry3d& pose : plan.board_from_camera) {
    information += information_of(request, pose.inverse());
    plan.after.push_back(hand_eye_sigma(information));
  }
}

PosePlan plan_of(const PlanRequest& request,
                 const Photographer& photographer,
                 const std::vector<Isometry3d>& camera_from_board) {
  PosePlan plan{.near_mm = photographer.near_mm(), .far_mm = photographer.far_mm()};
  Bundle bundle = bundle_of(request);
  for (const Isometry3d& pose : request.taken) {
    bundle.views.push_back(view_of(request, pose.inverse()));
  }
  for (const Isometry3d& pose : camera_from_board) {
    bundle.views.push_back(view_of(request, pose));
    plan.board_from_camera.push_back(pose.inverse());
  }
  const SharedCovariance covariance = shared_covariance(bundle);
  plan.lens_sigma = covariance.diagonal().head<9>().cwiseSqrt();
  plan.hand_eye_rad = std::sqrt(covariance.diagonal().segment<3>(9).sum());
  plan.hand_eye_mm = std::sqrt(covariance.diagonal().segment<3>(12).sum());
  if (!request.taken.empty()) {
    foretell(request, plan);
  }
  return plan;
}

/// Of a range cut into so many steps.
double step_of(double low, double high, int step, int steps) {
  return low + (high - low) * (step + 0.5) / steps;
}

/// The view of a number of the grid: five distances, tilts, axes of the tilt, rolls, 3 x 3 places.
View grid_view(const PlanRequest& request, const Photographer& photographer, int number) {
  const auto next = [&number](int steps) {
    const int step = number % steps;
    number /= steps;
    return step;
  };
  View view;
  view.place_px = {step_of(0.0, request.camera.width_px, next(3), 3),
                   step_of(0.0, request.camera.height_px, next(3), 3)};
  const double tilt = step_of(request.tilt_min_rad, request.tilt_max_rad, next(5), 5);
  const double about = step_of(0.0, 2.0 * std::numbers::pi, next(5), 5);
  view.tilt_rad = {tilt * std::cos(about), tilt * std::sin(about)};
  view.roll_rad = step_of(-request.roll_rad, request.roll_rad, next(5), 5);
  view.distance_mm = step_of(photographer.near_mm(), photographer.far_mm(), next(5), 5);
  return view;
}

}  // namespace

PosePlan informative_poses(const PlanRequest& request) {
  const Photographer photographer(request);
  Rng rng(request.seed, Stream::kViewpoints, 0);
  std::vector<std::pair<Isometry3d, MatrixXd>> candidates;
  for (int i = 0; i < 100 * kCandidates && std::ssize(candidates) < kCandidates; ++i) {
    if (const auto pose = photographer.camera_from_board(random_view(request, photographer, rng))) {
      candidates.emplace_back(*pose, information_of(request, *pose));
    }
  }
  if (std::ssize(candidates) < request.count) {
    photographer.refuse(static_cast<int>(std::ssize(candidates)));
  }
  MatrixXd information = first_information(request);
  std::vector<Isometry3d> chosen;
  while (std::ssize(chosen) < request.count) {
    const auto best = std::ranges::max_element(candidates, {}, [&](const auto& candidate) {
      return worth_of(request, information + candidate.second);
    });
    information += best->second;
    chosen.push_back(best->first);
    candidates.erase(best);
  }
  return plan_of(request, photographer, chosen);
}

PosePlan strided_poses(const PlanRequest& request) {
  constexpr int kGrid = 3 * 3 * 5 * 5 * 5 * 5;
  const Photographer photographer(request);
  std::vector<Isometry3d> all;
  for (int number = 0; number < kGrid; ++number) {
    if (const auto pose =
            photographer.camera_from_board(grid_view(request, photographer, number))) {
      all.push_back(*pose);
    }
  }
  const auto count = static_cast<std::size_t>(request.count);
  if (all.size() < count) {
    photographer.refuse(static_cast<int>(all.size()));
  }
  std::vector<Isometry3d> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
  }
  Rng rng(request.seed, Stream::kViewpoints, 1);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(chosen[i - 1],
              chosen[static_cast<std::size_t>(rng.uniform() * static_cast<double>(i))]);
  }
  return plan_of(request, photographer, chosen);
}

}  // namespace glint
