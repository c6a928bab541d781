// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/prediction.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/joint_fit.h"
#include "hardware/calibration/lens_choice.h"

namespace glint {
namespace {

/// The camera of a fold's training pictures by themselves, unknown terms and all.
Bundle camera_of(const Bundle& training) {
  Bundle camera = camera_bundle(training.lens, training.is_free);
  camera.lens_prior = training.lens_prior;
  for (const BundleView& view : training.views) {
    camera.views.push_back(free_view(view.corners, pose_of(training, view)));
  }
  return camera;
}

/// Lens terms by the training pictures alone. With fewer than four pictures those of the start.
void choose_terms(Bundle& training, const CameraOptions& options) {
  if (options.free_terms.has_value() || training.views.size() < 4) {
    return;
  }
  training.is_free = allowed_terms(options);
  std::vector<LensChoice> choices;
  const std::size_t taken = choose_lens_terms(camera_of(training), options, choices);
  take_lens_terms(training, choices[taken].is_free);
}

/// The pictures of all folds but one, lens terms chosen.
struct Training {
  Bundle bundle;
  Bundle camera;  ///< the same without the robot, solved
  bool is_camera_solved = false;
};

/// The bundle of the training pictures, solved; empty when it cannot be.
using Solver = std::function<std::optional<Bundle>(const Training&)>;

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

/// The pictures of all folds but one.
Bundle training_of(const Bundle& solved, std::span<const int> folds, int fold) {
  Bundle training = without_views(solved);
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (folds[i] != fold) {
      training.views.push_back(solved.views[i]);
    }
  }
  return training;
}

/// From each fold's pictures in their order to the order of all.
std::vector<double> by_picture(std::span<const int> folds,
                               const std::vector<std::vector<double>>& by_fold) {
  std::vector<double> values;
  std::vector<std::size_t> next(by_fold.size());
  for (const int fold : folds) {
    const auto at = static_cast<std::size_t>(fold);
    values.push_back(by_fold[at][next[at]++]);
  }
  return values;
}

/// Of each solver, the rms of the fold's pictures in their order.
using FoldResult = std::vector<std::vector<double>>;

FoldResult predict_fold(const Bundle& solved,
                        const CameraOptions& camera,
                        std::span<const int> folds,
                        int fold,
                        std::span<const Solver> solvers) {
  Training training{.bundle = training_of(solved, folds, fold)};
  const bool is_empty = training.bundle.views.empty();
  if (!is_empty) {
    choose_terms(training.bundle, camera);
    training.camera = camera_of(training.bundle);
    training.is_camera_solved = fit_camera(training.camera, 3);
  }
  FoldResult result;
  for (const Solver& solve : solvers) {
    const auto fitted = is_empty ? std::nullopt : solve(training);
    std::vector<double>& rms = result.emplace_back();
    for (std::size_t i = 0; i < folds.size(); ++i) {
      if (folds[i] == fold) {
        BundleView view = solved.views[i];
        view.error.setZero();
        rms.push_back(fitted.has_value() ? rms_px(*fitted, view)
                                         : std::numeric_limits<double>::infinity());
      }
    }
  }
  return result;
}

/// One fold of one of several splits.
struct FoldOfSplit {
  std::size_t split = 0;
  int fold = 0;
};

/// Without those of a split that is not of the bundle's views.
std::vector<FoldOfSplit> folds_of(const Bundle& solved, std::span<const std::vector<int>> splits) {
  std::vector<FoldOfSplit> all;
  for (std::size_t split = 0; split < splits.size(); ++split) {
    const std::vector<int>& folds = splits[split];
    const bool is_known = !folds.empty() && folds.size() == solved.views.size();
    const int count = is_known ? *std::ranges::max_element(folds) + 1 : 0;
    for (int fold = 0; fold < count; ++fold) {
      all.push_back({.split = split, .fold = fold});
    }
  }
  return all;
}

/// Of each solver. @param results  of each fold; none: nothing could be predicted
std::vector<Prediction> predictions_of(const Bundle& solved,
                                       std::span<const int> folds,
                                       const std::vector<FoldResult>& results,
                                       std::size_t num_solvers) {
  std::vector<Prediction> predictions(num_solvers, failed_prediction(solved.views.size()));
  for (std::size_t solver = 0; solver < num_solvers && !results.empty(); ++solver) {
    std::vector<std::vector<double>> by_fold;
    for (const FoldResult& result : results) {
      by_fold.push_back(result[solver]);
    }
    predictions[solver] = summary_of(solved, by_picture(folds, by_fold));
  }
  return predictions;
}

/// Of each split, of each solver. The folds of all splits are predicted side by side.
std::vector<std::vector<Prediction>> predict_splits(const Bundle& solved,
                                                    const CameraOptions& camera,
                                                    std::span<const std::vector<int>> splits,
                                                    std::span<const Solver> solvers,
                                                    ThreadPool& pool) {
  const std::vector<FoldOfSplit> all = folds_of(solved, splits);
  const auto results = pool.map<FoldResult>(std::ssize(all), [&](std::int64_t i) {
    const FoldOfSplit& one = all[static_cast<std::size_t>(i)];
    return predict_fold(solved, camera, splits[one.split], one.fold, solvers);
  });
  std::vector<std::vector<FoldResult>> by_split(splits.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    by_split[all[i].split].push_back(results[i]);
  }
  std::vector<std::vector<Prediction>> predictions;
  for (std::size_t split = 0; split < splits.size(); ++split) {
    predictions.push_back(predictions_of(solved, splits[split], by_split[split], solvers.size()));
  }
  return predictions;
}

std::vector<Prediction> predict(const Bundle& solved,
                                const CameraOptions& camera,
                                std::span<const int> folds,
                                std::span<const Solver> solvers,
                                ThreadPool& pool) {
  const std::vector<std::vector<int>> one(1, std::vector<int>(folds.begin(), folds.end()));
  return predict_splits(solved, camera, one, solvers, pool).front();
}

/// Camera alone, then the method.
std::optional<Bundle> solve_by(HandEyeMethod method, const Training& training) {
  if (!training.is_camera_solved) {
    return std::nullopt;
  }
  Bundle solved = training.bundle;
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < solved.views.size(); ++i) {
    pairs.push_back({.base_from_flange = solved.views[i].base_from_flange,
                     .camera_from_board = pose_of(training.camera, training.camera.views[i])});
  }
  const auto poses = hand_eye_by(method, solved.mounting, pairs);
  if (!poses.has_value()) {
    return std::nullopt;
  }
  solved.lens = training.camera.lens;
  solved.poses = *poses;
  return solved;
}

std::optional<Bundle> solve_jointly(const Training& training) {
  Bundle solved = training.bundle;
  if (!fit_joint(solved, 8, nullptr)) {
    return std::nullopt;
  }
  return solved;
}

std::vector<Solver> all_solvers() {
  std::vector<Solver> solvers = {solve_jointly};
  for (const HandEyeMethod method : kHandEyeMethods) {
    solvers.emplace_back([method](const Training& training) { return solve_by(method, training); });
  }
  return solvers;
}

/// rms of the fold's pictures, their poses fitted.
std::vector<double> predict_camera_fold(const Bundle& start,
                                        const CameraOptions& options,
                                        std::span<const int> folds,
                                        int fold) {
  Bundle training = training_of(start, folds, fold);
  bool is_fitted = !training.views.empty();
  if (is_fitted) {
    choose_terms(training, options);
    is_fitted = fit_camera(training, 6);
  }
  std::vector<double> rms;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (folds[i] == fold) {
      const auto fitted =
          is_fitted ? fit_view(start.views[i].corners, training.lens) : std::optional<FittedView>();
      rms.push_back(fitted.has_value() ? fitted->rms_px : std::numeric_limits<double>::infinity());
    }
  }
  return rms;
}

SplitMean mean_of(std::span<const double> rms) {
  SplitMean mean;
  for (const double value : rms) {
    mean.rms_px += value / static_cast<double>(rms.size());
  }
  mean.has_failed = !std::isfinite(mean.rms_px);
  double squares = 0.0;
  for (const double value : rms) {
    squares += std::pow(value - mean.rms_px, 2);
  }
  mean.deviation_px =
      mean.has_failed ? mean.rms_px
                      : std::sqrt(squares / std::max(1.0, static_cast<double>(rms.size()) - 1.0));
  return mean;
}

}  // namespace

std::vector<int> leave_one_out(int count) {
  std::vector<int> folds;
  for (int i = 0; i < count; ++i) {
    folds.push_back(i);
  }
  return folds;
}

Prediction predict_left_out(const Bundle& solved,
                            const CameraOptions& camera,
                            std::span<const int> folds,
                            ThreadPool& pool) {
  const std::vector<Solver> solvers = {solve_jointly};
  return predict(solved, camera, folds, solvers, pool).front();
}

std::vector<Prediction> predict_by_all(const Bundle& solved,
                                       const CameraOptions& camera,
                                       std::span<const int> folds,
                                       ThreadPool& pool) {
  return predict(solved, camera, folds, all_solvers(), pool);
}

Prediction predict_camera_left_out(std::span<const BoardCorners> pictures,
                                   const LensVector& lens,
                                   const CameraOptions& camera,
                                   std::span<const int> folds,
                                   ThreadPool& pool) {
  Bundle start = camera_bundle(lens, allowed_terms(camera));
  start.lens_prior = prior_of(camera);
  for (const BoardCorners& corners : pictures) {
    const auto fitted = fit_view(corners, lens);
    if (!fitted.has_value()) {
      return failed_prediction(pictures.size());
    }
    start.views.push_back(fitted->view);
  }
  if (folds.empty() || folds.size() != pictures.size()) {
    return failed_prediction(pictures.size());
  }
  const int count = *std::ranges::max_element(folds) + 1;
  const auto results = pool.map<std::vector<double>>(count, [&](std::int64_t fold) {
    return predict_camera_fold(start, camera, folds, static_cast<int>(fold));
  });
  return summary_of(start, by_picture(folds, results));
}

std::vector<SplitMean> predict_five_fold(const Bundle& solved,
                                         const CameraOptions& camera,
                                         int splits,
                                         ThreadPool& pool) {
  const int count = static_cast<int>(solved.views.size());
  std::vector<std::vector<int>> folds;
  for (int split = 0; split < splits; ++split) {
    folds.push_back(
        shuffled_folds(count, std::min(5, count), static_cast<std::uint64_t>(split + 1)));
  }
  std::vector<std::vector<double>> rms(1 + kHandEyeMethods.size());
  for (const std::vector<Prediction>& predictions :
       predict_splits(solved, camera, folds, all_solvers(), pool)) {
    for (std::size_t i = 0; i < rms.size(); ++i) {
      rms[i].push_back(predictions[i].rms_px);
    }
  }
  std::vector<SplitMean> means;
  for (const std::vector<double>& of_method : rms) {
    means.push_back(mean_of(of_method));
  }
  return means;
}

}  // namespace glint
