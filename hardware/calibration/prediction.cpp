// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/prediction.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/joint_fit.h"

namespace glint {
namespace {

/// The bundle of a fold's training pictures, solved; empty when it cannot be.
using Solver = std::function<std::optional<Bundle>(Bundle)>;

Prediction failed_prediction(std::size_t size) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {.has_failed = true,
          .rms_px = kNone,
          .median_px = kNone,
          .picture_rms_px = std::vector<double>(size, kNone)};
}

Prediction summary_of(const Bundle& solved, std::vector<double> rms) {
  double squares = 0.0;
  double corners = 0.0;
  for (std::size_t i = 0; i < rms.size(); ++i) {
    const auto count = static_cast<double>(solved.views[i].corners.board_mm.size());
    squares += count * rms[i] * rms[i];
    corners += count;
  }
  Prediction result{.rms_px = std::sqrt(squares / corners), .picture_rms_px = rms};
  std::ranges::sort(rms);
  result.median_px = rms[rms.size() / 2];
  result.has_failed = !std::isfinite(result.rms_px);
  return result;
}

/// rms of the fold's pictures as {index, rms}.
using FoldResult = std::vector<std::pair<std::size_t, double>>;

FoldResult predict_fold(const Bundle& solved,
                        std::span<const int> folds,
                        int fold,
                        const Solver& solve) {
  Bundle training = without_views(solved);
  std::vector<std::size_t> left_out;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (folds[i] == fold) {
      left_out.push_back(i);
    } else {
      training.views.push_back(solved.views[i]);
    }
  }
  const auto fitted = training.views.empty() ? std::nullopt : solve(std::move(training));
  FoldResult result;
  for (const std::size_t i : left_out) {
    BundleView view = solved.views[i];
    view.error.setZero();
    result.emplace_back(
        i, fitted.has_value() ? rms_px(*fitted, view) : std::numeric_limits<double>::infinity());
  }
  return result;
}

Prediction predict(const Bundle& solved,
                   std::span<const int> folds,
                   const Solver& solve,
                   ThreadPool& pool) {
  if (folds.empty() || folds.size() != solved.views.size()) {
    return failed_prediction(solved.views.size());
  }
  const int count = *std::ranges::max_element(folds) + 1;
  const auto results = pool.map<FoldResult>(count, [&](std::int64_t fold) {
    return predict_fold(solved, folds, static_cast<int>(fold), solve);
  });
  std::vector<double> rms(folds.size());
  for (const FoldResult& fold : results) {
    for (const auto& [index, value] : fold) {
      rms[index] = value;
    }
  }
  return summary_of(solved, std::move(rms));
}

/// Camera alone, then the method.
std::optional<Bundle> solve_by(HandEyeMethod method, Bundle training) {
  Bundle camera = camera_bundle(training.lens, training.is_free);
  camera.lens_prior = training.lens_prior;
  for (const BundleView& view : training.views) {
    camera.views.push_back(free_view(view.corners, pose_of(training, view)));
  }
  if (!fit_camera(camera, 3)) {
    return std::nullopt;
  }
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < training.views.size(); ++i) {
    pairs.push_back({.base_from_flange = training.views[i].base_from_flange,
                     .camera_from_board = pose_of(camera, camera.views[i])});
  }
  const auto poses = hand_eye_by(method, training.mounting, pairs);
  if (!poses.has_value()) {
    return std::nullopt;
  }
  training.lens = camera.lens;
  training.poses = *poses;
  return training;
}

}  // namespace

std::vector<int> leave_one_out(int count) {
  std::vector<int> folds;
  for (int i = 0; i < count; ++i) {
    folds.push_back(i);
  }
  return folds;
}

Prediction predict_left_out(const Bundle& solved, std::span<const int> folds, ThreadPool& pool) {
  const Solver solve = [](Bundle training) -> std::optional<Bundle> {
    if (!fit_joint(training, 8, nullptr)) {
      return std::nullopt;
    }
    return training;
  };
  return predict(solved, folds, solve, pool);
}

Prediction predict_left_out(const Bundle& solved,
                            std::span<const int> folds,
                            HandEyeMethod method,
                            ThreadPool& pool) {
  const Solver solve = [&](Bundle training) { return solve_by(method, std::move(training)); };
  return predict(solved, folds, solve, pool);
}

}  // namespace glint
