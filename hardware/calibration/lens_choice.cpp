// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/lens_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/rng.h"
#include "hardware/calibration/bundle_adjustment.h"
#include "hardware/calibration/camera_bundle.h"

namespace glint {
namespace {

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

/// From few terms to many.
std::vector<LensChoice> candidates(const LensMask& allowed) {
  std::vector<LensChoice> result;
  for (const bool tangential : {false, true}) {
    for (std::size_t radial = 0; radial <= 3; ++radial) {
      LensMask mask = {true, true, true, true};
      std::fill_n(mask.begin() + kFirstTerm, radial, true);
      mask[7] = mask[8] = tangential;
      for (std::size_t i = 0; i < kLensSize; ++i) {
        mask[i] = mask[i] && allowed[i];
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

/// A term that is left out is zero, unless it is known and not to be estimated at all.
Bundle restricted(const Bundle& bundle, const LensMask& mask) {
  Bundle result = bundle;
  result.is_free = mask;
  for (std::size_t i = kFirstTerm; i < kLensSize; ++i) {
    if (bundle.is_free[i] && !mask[i]) {
      result.lens[static_cast<Eigen::Index>(i)] = 0.0;
    }
  }
  return result;
}

/// Mean square of each picture's prediction; empty when a fit fails.
std::vector<double> held_out_squares(Bundle fitted, const std::vector<int>& folds, int num_folds) {
  std::vector<double> squares(fitted.views.size());
  for (int fold = 0; fold < num_folds; ++fold) {
    Bundle rest = without_views(fitted);
    for (std::size_t i = 0; i < folds.size(); ++i) {
      if (folds[i] != fold) {
        rest.views.push_back(fitted.views[i]);
      }
    }
    if (!adjust_bundle(rest).has_converged) {
      return {};
    }
    for (std::size_t i = 0; i < folds.size(); ++i) {
      if (folds[i] == fold) {
        Bundle alone = without_views(rest);
        alone.is_free = {};
        alone.views = {fitted.views[i]};
        adjust_bundle(alone);
        squares[i] = std::pow(rms_px(alone, alone.views[0]), 2);
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

std::size_t choose_lens_terms(const Bundle& bundle,
                              const CameraOptions& options,
                              std::vector<LensChoice>& choices) {
  const int count = static_cast<int>(bundle.views.size());
  const int num_folds = std::min(options.folds, count);
  const std::vector<int> folds = shuffled_folds(count, num_folds, options.seed);
  choices = candidates(bundle.is_free);
  std::vector<std::vector<double>> squares;
  for (LensChoice& choice : choices) {
    Bundle fitted = restricted(bundle, choice.is_free);
    const bool is_usable =
        fit_camera(fitted, 3) && is_possible_lens(fitted.lens, options.width_px, options.height_px);
    squares.push_back(is_usable ? held_out_squares(fitted, folds, num_folds)
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

}  // namespace glint
