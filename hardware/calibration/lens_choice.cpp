// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/lens_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/QR>

#include "core/rng.h"
#include "hardware/calibration/camera_bundle.h"
#include "hardware/calibration/variance_components.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFirstTerm = 4;  // of the distortion

std::string name_of(const LensMask& mask) {
  std::string name;
  for (std::size_t i = kFirstTerm; i < kLensSize; ++i) {
    if (mask[i]) {
      name += (name.empty() ? "" : " ") + std::string(kLensNames[i]);
    }
  }
  return name.empty() ? "no distortion" : name;
}

/// Terms of which something is known: they are never left out.
bool has_prior(const Bundle& bundle, std::size_t term) {
  return bundle.lens_prior.has_value() &&
         std::isfinite(bundle.lens_prior->sigma[static_cast<Index>(term)]);
}

/// From few terms to many.
std::vector<LensChoice> candidates(const Bundle& bundle) {
  std::vector<LensChoice> result;
  for (const bool tangential : {false, true}) {
    for (std::size_t radial = 0; radial <= 3; ++radial) {
      LensMask mask = {true, true, true, true};
      std::fill_n(mask.begin() + kFirstTerm, radial, true);
      mask[7] = mask[8] = tangential;
      for (std::size_t i = 0; i < kLensSize; ++i) {
        mask[i] = (mask[i] || has_prior(bundle, i)) && bundle.is_free[i];
      }
      const std::string name = name_of(mask);
      if (std::ranges::none_of(result, [&](const LensChoice& c) { return c.name == name; })) {
        result.push_back({.name = name, .is_free = mask});
      }
    }
  }
  std::ranges::stable_sort(result, {}, [](const LensChoice& choice) {
    return std::ranges::count(choice.is_free, true);
  });
  return result;
}

/// Sum of squares of a picture's residuals against a step of the lens, its pose following.
struct Quadratic {
  MatrixXd hessian;
  VectorXd gradient;
  double square = 0.0;

  explicit Quadratic(Index size)
      : hessian(MatrixXd::Zero(size, size)), gradient(VectorXd::Zero(size)) {}

  Quadratic(const MatrixXd& by, const VectorXd& residual)
      : hessian(by.transpose() * by),
        gradient(by.transpose() * residual),
        square(residual.squaredNorm()) {}

  void add(const Quadratic& other) {
    hessian += other.hessian;
    gradient += other.gradient;
    square += other.square;
  }

  double at(const VectorXd& step) const {
    return square + 2.0 * gradient.dot(step) + step.dot(hessian * step);
  }
};

struct LinearView {
  Quadratic fitted;  ///< what a fit minimises: corners weighted
  Quadratic judged;  ///< not weighted, a corner's mean
};

/// Empty when a corner is behind the camera.
std::optional<LinearView> linear_view(const Bundle& bundle, const BundleView& view) {
  const auto weighted = weighted_system(bundle, view);
  BundleView plain_view = view;
  plain_view.weights.setOnes();
  const auto plain = weighted_system(bundle, plain_view);
  if (!weighted.has_value() || !plain.has_value()) {
    return std::nullopt;
  }
  // The pose that follows a step d of the lens: the least squares of the weighted rows.
  const Eigen::HouseholderQR<MatrixXd> qr(weighted->by_error);
  const MatrixXd follows = -qr.solve(weighted->by_shared);
  const VectorXd moved = -qr.solve(weighted->residual_px);
  LinearView result{.fitted = Quadratic(weighted->by_shared + weighted->by_error * follows,
                                        weighted->residual_px + weighted->by_error * moved),
                    .judged = Quadratic(plain->by_shared + plain->by_error * follows,
                                        plain->residual_px + plain->by_error * moved)};
  const double scale = 2.0 / static_cast<double>(plain->residual_px.size());
  result.judged.hessian *= scale;
  result.judged.gradient *= scale;
  result.judged.square *= scale;
  return result;
}

/// The linear system of all pictures near a fit with all terms.
struct LinearCamera {
  Bundle bundle;  ///< fitted
  std::vector<LinearView> views;
  std::vector<Index> terms;  ///< of the lens, of each unknown

  /// The step of the unknowns that the sum asks for, terms that are left out going to zero.
  VectorXd step(const Quadratic& sum, const LensMask& mask) const {
    const auto size = static_cast<Index>(terms.size());
    VectorXd result = VectorXd::Zero(size);
    std::vector<Index> kept;
    for (Index i = 0; i < size; ++i) {
      const Index term = terms[static_cast<std::size_t>(i)];
      if (mask[static_cast<std::size_t>(term)]) {
        kept.push_back(i);
      } else {
        result[i] = -bundle.lens[term];
      }
    }
    MatrixXd hessian = sum.hessian / std::pow(bundle.noise.corner_px, 2);
    VectorXd gradient = sum.gradient / std::pow(bundle.noise.corner_px, 2);
    add_lens_prior(bundle, hessian, gradient);
    const VectorXd slope = gradient + hessian * result;
    const MatrixXd kept_hessian = hessian(kept, kept);
    const VectorXd right = -slope(kept);
    result(kept) = inverse_information(kept_hessian) * right;
    return result;
  }

  Quadratic sum_of(const std::vector<int>& folds, int left_out) const {
    Quadratic sum(static_cast<Index>(terms.size()));
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (folds[i] != left_out) {
        sum.add(views[i].fitted);
      }
    }
    return sum;
  }

  LensVector lens_after(const VectorXd& step) const {
    LensVector lens = bundle.lens;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      lens[terms[i]] += step[static_cast<Index>(i)];
    }
    return lens;
  }
};

/// Empty when nothing can be fitted.
std::optional<LinearCamera> linear_camera(const Bundle& start) {
  LinearCamera camera{.bundle = start};
  // A fit with terms that the pictures do not tell may stop early: its system is as good.
  if (!fit_camera(camera.bundle, 3)) {
    camera.bundle = start;
    camera.bundle.is_free[6] = false;
    const bool is_fitted = fit_camera(camera.bundle, 3);
    camera.bundle.is_free = start.is_free;
    if (!is_fitted) {
      return std::nullopt;
    }
  }
  for (Index i = 0; i < static_cast<Index>(kLensSize); ++i) {
    if (start.is_free[static_cast<std::size_t>(i)]) {
      camera.terms.push_back(i);
    }
  }
  for (const BundleView& view : camera.bundle.views) {
    auto linear = linear_view(camera.bundle, view);
    if (!linear.has_value()) {
      return std::nullopt;
    }
    camera.views.push_back(std::move(*linear));
  }
  return camera;
}

/// Mean square of each picture's prediction; empty when the lens that fits folds.
std::vector<double> held_out_squares(const LinearCamera& camera,
                                     const LensMask& mask,
                                     const std::vector<int>& folds,
                                     const CameraOptions& options) {
  const VectorXd whole = camera.step(camera.sum_of(folds, -1), mask);
  if (!is_possible_lens(camera.lens_after(whole), options.width_px, options.height_px)) {
    return {};
  }
  std::vector<double> squares(camera.views.size());
  const int num_folds = *std::ranges::max_element(folds) + 1;
  for (int fold = 0; fold < num_folds; ++fold) {
    const VectorXd step = camera.step(camera.sum_of(folds, fold), mask);
    for (std::size_t i = 0; i < folds.size(); ++i) {
      if (folds[i] == fold) {
        squares[i] = std::max(0.0, camera.views[i].judged.at(step));
      }
    }
  }
  return squares;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Standard error of the mean of the differences.
double standard_error(const std::vector<double>& a, const std::vector<double>& b) {
  const double middle = mean(a) - mean(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += std::pow(a[i] - b[i] - middle, 2);
  }
  const auto count = static_cast<double>(a.size());
  return std::sqrt(sum / (count * std::max(1.0, count - 1.0)));
}

}  // namespace

std::vector<int> shuffled_folds(int count, int num_folds, std::uint64_t seed) {
  std::vector<int> folds;
  for (int i = 0; i < count; ++i) {
    folds.push_back(i % num_folds);
  }
  Rng rng(seed, Stream::kResampling, 0);
  for (std::size_t i = folds.size(); i > 1; --i) {
    std::swap(folds[i - 1],
              folds[static_cast<std::size_t>(rng.uniform() * static_cast<double>(i))]);
  }
  return folds;
}

LensMask allowed_terms(const CameraOptions& options) {
  LensMask mask;
  mask.fill(true);
  for (std::size_t i = 0; i < kLensSize; ++i) {
    const bool is_exact =
        options.known.has_value() && (!options.known->sigma.has_value() ||
                                      (*options.known->sigma)[static_cast<Eigen::Index>(i)] <= 0.0);
    const bool is_left_out = options.free_terms.has_value() && !(*options.free_terms)[i];
    mask[i] = !is_exact && !is_left_out;
  }
  return mask;
}

std::optional<LensPrior> prior_of(const CameraOptions& options) {
  if (!options.known.has_value() || !options.known->sigma.has_value()) {
    return std::nullopt;
  }
  return LensPrior{.mean = options.known->lens, .sigma = *options.known->sigma};
}

std::size_t choose_lens_terms(const Bundle& bundle,
                              const CameraOptions& options,
                              std::vector<LensChoice>& choices) {
  const int count = static_cast<int>(bundle.views.size());
  const int num_folds = std::min(options.folds, count);
  const std::vector<int> folds = shuffled_folds(count, num_folds, options.seed);
  choices = candidates(bundle);
  const auto camera = linear_camera(bundle);
  std::vector<std::vector<double>> squares;
  for (LensChoice& choice : choices) {
    squares.push_back(camera.has_value() ? held_out_squares(*camera, choice.is_free, folds, options)
                                         : std::vector<double>());
    choice.held_out_rms_px = squares.back().empty() ? std::numeric_limits<double>::infinity()
                                                    : std::sqrt(mean(squares.back()));
  }
  const auto best = static_cast<std::size_t>(
      std::ranges::min_element(choices, {}, &LensChoice::held_out_rms_px) - choices.begin());
  std::size_t taken = best;
  for (std::size_t i = choices.size(); i-- > 0;) {
    if (squares[i].empty() || squares[best].empty()) {
      continue;
    }
    choices[i].standard_error_px2 = standard_error(squares[i], squares[best]);
    if (mean(squares[i]) - mean(squares[best]) <= choices[i].standard_error_px2 && i < taken) {
      taken = i;
    }
  }
  return taken;
}

void take_lens_terms(Bundle& bundle, const LensMask& chosen) {
  for (std::size_t i = kFirstTerm; i < kLensSize; ++i) {
    if (bundle.is_free[i] && !chosen[i]) {
      bundle.lens[static_cast<Eigen::Index>(i)] = 0.0;
    }
  }
  bundle.is_free = chosen;
}

}  // namespace glint
