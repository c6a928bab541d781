// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/second_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "core/rng.h"
#include "hardware/calibration/bundle_adjustment.h"
#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration_review/view_information.h"

namespace glint {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Which views are the second camera's.
using Sides = std::vector<bool>;

constexpr std::ptrdiff_t kMinViews = 4;
constexpr int kMaxTurns = 20;
constexpr int kRandomStarts = 20;

bool has_enough(const Sides& sides) {
  const auto second = std::ranges::count(sides, true);
  return second >= kMinViews && std::ssize(sides) - second >= kMinViews;
}

// --- By one step of least squares ----------------------------------------------------------------

/// To the intrinsics that fit some views best.
VectorXd step_of(const MatrixXd& hessian, const VectorXd& gradient) {
  const VectorXd scale = hessian.diagonal().array().max(1e-300).rsqrt();
  MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  scaled.diagonal().array() += 1e-10;  // for what these views do not tell
  return -scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(gradient)));
}

/// What the views say of the intrinsics, each by itself, near the solution of all.
class LinearViews {
 public:
  explicit LinearViews(const Bundle& solved) {
    for (const BundleView& view : solved.views) {
      views_.push_back(view_information(solved, view));
    }
  }

  /// By turns of a step for both cameras and a choice for each view, from given sides.
  /// @return by how much half the sum of squares falls; 0 where a camera loses its views
  double settle(Sides& sides) const {
    double gain = 0.0;
    for (int turn = 0; turn < kMaxTurns; ++turn) {
      const std::array<VectorXd, 2> steps = {step(sides, false), step(sides, true)};
      Sides chosen;
      gain = 0.0;
      for (const SharedInformation& view : views_) {
        const double first = change(view, steps[0]);
        const double second = change(view, steps[1]);
        chosen.push_back(second < first);
        gain -= std::min(first, second);
      }
      if (chosen == sides) {
        break;
      }
      sides = std::move(chosen);
      if (!has_enough(sides)) {
        return 0.0;
      }
    }
    return gain;
  }

 private:
  VectorXd step(const Sides& sides, bool side) const {
    MatrixXd hessian = MatrixXd::Zero(views_[0].hessian.rows(), views_[0].hessian.cols());
    VectorXd gradient = VectorXd::Zero(hessian.rows());
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (sides[i] == side) {
        hessian += views_[i].hessian;
        gradient += views_[i].gradient;
      }
    }
    return step_of(hessian, gradient);
  }

  /// Of half the sum of squares of a view.
  static double change(const SharedInformation& view, const VectorXd& step) {
    return step.dot(view.gradient) + 0.5 * step.dot(view.hessian * step);
  }

  std::vector<SharedInformation> views_;
};

std::vector<Sides> starts(std::size_t size) {
  std::vector<Sides> all;
  for (std::size_t i = kMinViews; i + kMinViews <= size; ++i) {
    Sides& sides = all.emplace_back(size, false);
    std::fill(sides.begin() + static_cast<std::ptrdiff_t>(i), sides.end(), true);
  }
  Sides& every_second = all.emplace_back(size, false);
  for (std::size_t i = 1; i < size; i += 2) {
    every_second[i] = true;
  }
  for (std::uint64_t start = 0; start < kRandomStarts; ++start) {
    Rng rng(1, Stream::kResampling, start);
    Sides& sides = all.emplace_back();
    for (std::size_t i = 0; i < size; ++i) {
      sides.push_back(rng.uniform() < 0.5);
    }
  }
  std::erase_if(all, [](const Sides& sides) { return !has_enough(sides); });
  return all;
}

/// The sides that promise most; empty where none do.
Sides best_start(const Bundle& solved) {
  const LinearViews views(solved);
  Sides best;
  double most = 0.0;
  for (Sides& sides : starts(solved.views.size())) {
    const double gain = views.settle(sides);
    if (gain > most && has_enough(sides)) {
      most = gain;
      best = std::move(sides);
    }
  }
  return best;
}

// --- In full -------------------------------------------------------------------------------------

double square_with(const BundleView& view, const LensVector& lens) {
  const auto fitted = fit_view(view.corners, lens);
  return fitted.has_value()
             ? std::pow(fitted->rms_px, 2) * static_cast<double>(view.corners.board_mm.size())
             : std::numeric_limits<double>::infinity();
}

/// The camera of one side's views.
LensVector lens_of(const Bundle& solved, const Sides& sides, bool side) {
  Bundle part = without_views(solved);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i] == side) {
      part.views.push_back(solved.views[i]);
      part.views.back().weights.setOnes();
    }
  }
  adjust_bundle(part);
  return part.lens;
}

/// Sum of squares that one camera leaves, fitted as the two are.
double square_of_one(const Bundle& solved) {
  const LensVector lens = lens_of(solved, Sides(solved.views.size(), false), false);
  double sum = 0.0;
  for (const BundleView& view : solved.views) {
    sum += square_with(view, lens);
  }
  return sum;
}

/// Two cameras and the views of each.
struct TwoCameras {
  Sides sides;
  std::array<LensVector, 2> lenses;
  double square_px2 = std::numeric_limits<double>::infinity();
};

/// By turns of a fit of both cameras and a choice for each view.
TwoCameras settled_cameras(const Bundle& solved, Sides sides) {
  constexpr int kMaxFits = 6;
  TwoCameras best;
  for (int turn = 0; turn < kMaxFits && has_enough(sides); ++turn) {
    TwoCameras now{.sides = sides,
                   .lenses = {lens_of(solved, sides, false), lens_of(solved, sides, true)},
                   .square_px2 = 0.0};
    Sides chosen;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const double first = square_with(solved.views[i], now.lenses[0]);
      const double second = square_with(solved.views[i], now.lenses[1]);
      now.square_px2 += sides[i] ? second : first;
      chosen.push_back(second < first);
    }
    if (!(now.square_px2 < best.square_px2)) {
      break;
    }
    best = std::move(now);
    if (chosen == sides) {
      break;
    }
    sides = std::move(chosen);
  }
  return best;
}

bool is_preferred(const Bundle& solved, double one_px2, double two_px2) {
  constexpr double kMinExplained = 0.5;
  constexpr double kNumbersOfAView = 14.0;
  const auto views = static_cast<double>(solved.views.size());
  const double numbers = kNumbersOfAView * views;
  const double gain = numbers * std::log(one_px2 / two_px2);
  return two_px2 < (1.0 - kMinExplained) * one_px2 &&
         gain > num_shared(solved) * std::log(numbers) + 2.0 * views * std::log(2.0);
}

/// Squares that are longer one way look like two cameras in pictures turned by a quarter: wider
/// upright, narrower turned. Then one camera and a stretched board leave little more than both.
bool is_stretched_board(const Bundle& solved, const TwoCameras& two) {
  constexpr double kLittleMore = 2.0;
  const auto aspect = [](const LensVector& lens) { return lens[0] / lens[1]; };
  const double stretch = 0.5 * std::log(aspect(two.lenses[1]) / aspect(two.lenses[0]));
  return std::ranges::any_of(std::array{-stretch, stretch}, [&](double by) {
    Bundle one = solved;
    for (BundleView& view : one.views) {
      for (Eigen::Vector3d& point : view.corners.board_mm) {
        point.x() *= 1.0 + by;
      }
    }
    return square_of_one(one) < kLittleMore * two.square_px2;
  });
}

SecondCamera second_camera_of(const Bundle& solved, TwoCameras two, double one_px2) {
  if (two.sides.front()) {
    two.sides.flip();
    std::swap(two.lenses[0], two.lenses[1]);
  }
  const auto first = std::ranges::find(two.sides, true) - two.sides.begin();
  return {.is_second = two.sides,
          .first_view = static_cast<std::size_t>(first),
          .explained = 1.0 - two.square_px2 / one_px2,
          .focal_ratio = solved.is_free[0] ? two.lenses[1][0] / two.lenses[0][0] : 1.0};
}

}  // namespace

bool SecondCamera::is_one_after_the_other() const {
  return std::ranges::is_sorted(is_second);
}

std::optional<SecondCamera> find_second_camera(const Bundle& solved) {
  if (solved.are_poses_free || num_shared(solved) == 0 ||
      std::ssize(solved.views) < 2 * kMinViews) {
    return std::nullopt;
  }
  const Sides start = best_start(solved);
  if (start.empty()) {
    return std::nullopt;
  }
  TwoCameras two = settled_cameras(solved, start);
  const double one_px2 = square_of_one(solved);
  if (!is_preferred(solved, one_px2, two.square_px2) || is_stretched_board(solved, two)) {
    return std::nullopt;
  }
  return second_camera_of(solved, std::move(two), one_px2);
}

}  // namespace glint
