// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/corner_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "core/units.h"

namespace glint {
namespace {

using Vector11 = Eigen::Matrix<double, 11, 1>;
using Matrix11 = Eigen::Matrix<double, 11, 11>;

/// Indices into the unknowns; the angles are those of the edges' normals.
enum Unknown {
  kX,
  kY,
  kAngle1,
  kAngle2,
  kLogBlur,
  kLevel,
  kLevelX,
  kLevelY,
  kHalf,
  kHalfX,
  kHalfY
};

constexpr double kWantedPx = 0.018;
constexpr double kMinBlurPx = 0.3;
constexpr double kMaxOfClearance = 0.42;
constexpr double kMaxForNoise = 12.0;  ///< px of a level
constexpr double kMinInside = 3.0;     ///< distance of a corner from the border, px of a level

/// erf(d / (sqrt(2) s)) and its derivative by d.
struct Edge {
  float value = 0.0F;
  float slope = 0.0F;
};

/// To 5e-7. Source: M. Abramowitz, I. Stegun, "Handbook of mathematical functions", 7.1.26.
Edge edge_at(float distance, float per_blur) {
  const float x = distance * per_blur;
  const float bell = std::exp(-x * x);
  const float t = 1.0F / (1.0F + 0.3275911F * std::abs(x));
  const float series =
      0.254829592F +
      t * (-0.284496736F + t * (1.421413741F + t * (-1.453152027F + t * 1.061405429F)));
  return {.value = std::copysign(1.0F - t * series * bell, x),
          .slope = 2.0F * std::numbers::inv_sqrtpi_v<float> * per_blur * bell};
}

/// The grey values around a corner, in px of one level.
struct Window {
  ImageF grey;
  Eigen::Vector2d origin_px = {0.0, 0.0};  ///< of its first pixel's outer corner
  double radius_px = 0.0;
};

/// The window around a point, narrower where the border is nearer than its radius: as much on
/// either side, so that it still looks the same after half a turn. Empty when less than
/// kMinInside is left.
std::optional<Window> window_around(PictureLevels& levels,
                                    int level,
                                    const Eigen::Vector2d& at_px,
                                    double radius_px) {
  const Eigen::Array2d size(levels.width() >> level, levels.height() >> level);
  const Eigen::Array2d inside = at_px.array().min(size - at_px.array());
  if (!(inside.minCoeff() >= kMinInside)) {
    return std::nullopt;
  }
  const Eigen::Array2d half = inside.min(radius_px + 1.5);
  const Eigen::Array2i first = (at_px.array() - half).ceil().cast<int>();
  const Eigen::Array2i end = (at_px.array() + half).floor().cast<int>();
  return Window{
      .grey = levels.part(level, first.x(), first.y(), end.x() - first.x(), end.y() - first.y()),
      .origin_px = first.matrix().cast<double>(),
      .radius_px = radius_px};
}

/// Sums over the window for one step.
struct Sums {
  Matrix11 normal = Matrix11::Zero();
  Vector11 right = Vector11::Zero();
  double squares = 0.0;  ///< of the weighted residuals
  double weights = 0.0;
};

/// What a pixel adds: the derivatives of the model, and last what the model leaves of its grey
/// value.
constexpr int kTerms = 12;
using Terms = std::array<float, kTerms>;

/// The model with its unknowns in single precision, for the pixels of one step.
class PixelModel {
 public:
  PixelModel(const Vector11& unknowns, double radius_px) {
    for (std::size_t k = 0; k < u_.size(); ++k) {
      u_[k] = static_cast<float>(unknowns[static_cast<Eigen::Index>(k)]);
    }
    per_radius_ = static_cast<float>(1.0 / radius_px);
    per_blur_ = static_cast<float>(std::exp(-unknowns[kLogBlur]) / std::numbers::sqrt2);
    normals_ = {
        std::cos(u_[kAngle1]), std::sin(u_[kAngle1]), std::cos(u_[kAngle2]), std::sin(u_[kAngle2])};
  }

  /// @param x, y  from the corner
  Terms terms(float x, float y, float grey) const {
    const auto& n = normals_;
    const float d1 = n[0] * x + n[1] * y;
    const float d2 = n[2] * x + n[3] * y;
    const Edge e1 = edge_at(d1, per_blur_);
    const Edge e2 = edge_at(d2, per_blur_);
    const float sx = x * per_radius_;
    const float sy = y * per_radius_;
    const float pattern = e1.value * e2.value;
    const float half = u_[kHalf] + u_[kHalfX] * sx + u_[kHalfY] * sy;
    const float by_d1 = half * e1.slope * e2.value;
    const float by_d2 = half * e1.value * e2.slope;
    const float model = u_[kLevel] + u_[kLevelX] * sx + u_[kLevelY] * sy + half * pattern;
    return {-(u_[kLevelX] + u_[kHalfX] * pattern) * per_radius_ - by_d1 * n[0] - by_d2 * n[2],
            -(u_[kLevelY] + u_[kHalfY] * pattern) * per_radius_ - by_d1 * n[1] - by_d2 * n[3],
            by_d1 * (n[0] * y - n[1] * x),
            by_d2 * (n[2] * y - n[3] * x),
            -by_d1 * d1 - by_d2 * d2,
            1.0F,
            sx,
            sy,
            pattern,
            pattern * sx,
            pattern * sy,
            grey - model};
  }

 private:
  std::array<float, 11> u_ = {};
  std::array<float, 4> normals_ = {};
  float per_radius_ = 1.0F;
  float per_blur_ = 1.0F;
};

/// Products of the terms of some pixels, in single precision.
class Products {
 public:
  void add(const Terms& terms, float weight) {
    for (std::size_t i = 0; i < kTerms; ++i) {
      const float factor = weight * terms[i];
      for (std::size_t j = 0; j < kTerms; ++j) {
        sums_[i][j] += factor * terms[j];
      }
    }
  }

  void add_to(Sums& sums) const {
    for (int i = 0; i < kTerms - 1; ++i) {
      for (int j = 0; j < kTerms - 1; ++j) {
        sums.normal(i, j) += at(i, j);
      }
      sums.right[i] += at(i, kTerms - 1);
    }
    sums.squares += at(kTerms - 1, kTerms - 1);
  }

 private:
  double at(int i, int j) const {
    return static_cast<double>(sums_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
  }

  std::array<std::array<float, kTerms>, kTerms> sums_ = {};
};

Sums sums_over(const Window& window, const Vector11& u) {
  Sums sums;
  const PixelModel model(u, window.radius_px);
  const auto radius = static_cast<float>(window.radius_px + 0.5);
  const auto left = static_cast<float>(window.origin_px.x() + 0.5 - u[kX]);
  for (int j = 0; j < window.grey.height(); ++j) {
    Products products;  // of one row: single precision is enough for so few
    const float* row = window.grey.row(j);
    const auto y = static_cast<float>(window.origin_px.y() + j + 0.5 - u[kY]);
    float weights = 0.0F;
    for (int i = 0; i < window.grey.width(); ++i) {
      const float x = left + static_cast<float>(i);
      const float weight = std::min(1.0F, radius - std::sqrt(x * x + y * y));
      if (weight > 0.0F) {
        products.add(model.terms(x, y, row[i]), weight);
        weights += weight;
      }
    }
    products.add_to(sums);
    sums.weights += static_cast<double>(weights);
  }
  return sums;
}

/// A fit on one level, in its px.
struct LevelFit {
  Vector11 unknowns = Vector11::Zero();
  double noise = 0.0;
};

/// The next step of Gauss-Newton; a blur at its lower bound stays there when it would go below.
Vector11 gauss_newton_step(Sums& sums, const Vector11& u) {
  sums.normal.diagonal() *= 1.0 + 1e-9;
  Vector11 change = sums.normal.ldlt().solve(sums.right);
  if (change[kLogBlur] < 0.0 && u[kLogBlur] <= std::log(kMinBlurPx)) {
    sums.normal.row(kLogBlur).setZero();
    sums.normal.col(kLogBlur).setZero();
    sums.normal(kLogBlur, kLogBlur) = 1.0;
    sums.right[kLogBlur] = 0.0;
    change = sums.normal.ldlt().solve(sums.right);
  }
  return change;
}

/// Steps of Gauss-Newton, each cut to what the model is good for. Edges sharper than a pixel make
/// them swing, so later ones are shorter.
std::optional<LevelFit> settle(const Window& window, Vector11 u) {
  constexpr int kMaxSteps = 20;
  constexpr int kFullSteps = 6;
  constexpr double kSettledPx = 1e-3;
  for (int step = 0; step < kMaxSteps; ++step) {
    Sums sums = sums_over(window, u);
    const Vector11 change = gauss_newton_step(sums, u);
    const double largest = std::max({change.head<2>().norm() / (0.4 * window.radius_px),
                                     change.segment<2>(kAngle1).cwiseAbs().maxCoeff() / 0.3,
                                     std::abs(change[kLogBlur]) / 0.5});
    if (!std::isfinite(largest)) {
      return std::nullopt;
    }
    u += (step < kFullSteps ? 1.0 : 0.5) * change / std::max(1.0, largest);
    u[kLogBlur] = std::max(u[kLogBlur], std::log(kMinBlurPx));
    const double enough = step < kFullSteps ? kSettledPx : 5.0 * kSettledPx;
    if (change.head<2>().norm() < enough && std::abs(change[kLogBlur]) < 10.0 * enough) {
      const double spare = std::max(1.0, sums.weights - static_cast<double>(u.size()));
      return LevelFit{.unknowns = u, .noise = std::sqrt(sums.squares / spare)};
    }
  }
  return std::nullopt;
}

/// Unknowns that follow from the guess and the mean and the spread of the window.
Vector11 begin_at(const Window& window, const CornerGuess& guess, double factor) {
  const auto& values = window.grey.values();
  double mean = 0.0;
  for (const float value : values) {
    mean += static_cast<double>(value);
  }
  mean /= static_cast<double>(values.size());
  double spread = 0.0;
  for (const float value : values) {
    spread += std::abs(static_cast<double>(value) - mean);
  }
  Vector11 u = Vector11::Zero();
  u.head<2>() = guess.at_px / factor;
  // Across `rising` it becomes brighter on the side of `falling`: there both normals point to
  // bright, so the product is positive between the two directions.
  const auto normal_of = [](const Eigen::Vector2d& edge, const Eigen::Vector2d& side) {
    const Eigen::Vector2d normal(-edge.y(), edge.x());
    const Eigen::Vector2d to_side = normal.dot(side) < 0.0 ? Eigen::Vector2d(-normal) : normal;
    return std::atan2(to_side.y(), to_side.x());
  };
  u[kAngle1] = normal_of(guess.rising, guess.falling);
  u[kAngle2] = normal_of(guess.falling, guess.rising);
  u[kLogBlur] = std::log(1.0);
  u[kLevel] = mean;
  u[kHalf] = spread / static_cast<double>(values.size());
  return u;
}

/// The unknowns of a fit on another level.
Vector11 on_level(Vector11 u, double factor_from, double factor_to, double radius_ratio) {
  u.head<2>() *= factor_from / factor_to;
  // Means of n x n pixels add (n^2 - 1) / 12 to the variance of the blur.
  const double blur = std::exp(u[kLogBlur]) * factor_from;
  const double variance = blur * blur + (factor_to * factor_to - factor_from * factor_from) / 12.0;
  const double least = kMinBlurPx * factor_to;
  u[kLogBlur] = 0.5 * std::log(std::max(variance, least * least) / (factor_to * factor_to));
  u.segment<2>(kLevelX) *= radius_ratio;
  u.segment<2>(kHalfX) *= radius_ratio;
  return u;
}

double blur_of(const Vector11& u, double factor) {
  const double blur = std::exp(u[kLogBlur]) * factor;
  return std::sqrt(std::max(blur * blur - (factor * factor - 1.0) / 12.0, kMinBlurPx * kMinBlurPx));
}

/// Radius of the window, px of a level: see the head of corner_fit.h.
double wanted_radius(const LevelFit& fit, double factor, double clearance_px) {
  const double blur = std::exp(fit.unknowns[kLogBlur]);
  const double step = 2.0 * std::abs(fit.unknowns[kHalf]);
  const double wanted = kWantedPx / factor;
  const double relative = fit.noise / (step * wanted);
  const double by_noise = std::min(relative * relative * std::sqrt(kPi) * blur, kMaxForNoise);
  const double most = kMaxOfClearance * clearance_px / factor;
  return std::min(std::max({by_noise, 2.2 * blur + 1.5, 3.5}), most);
}

double clipped_share(const Window& window, double clipped_value) {
  const auto& values = window.grey.values();
  const auto clipped = std::ranges::count_if(
      values, [&](float value) { return static_cast<double>(value) >= clipped_value; });
  return static_cast<double>(clipped) / static_cast<double>(values.size());
}

/// The level on which a blur is 1 to 2.4 px wide, but none on which the widest window is too small
/// for the model's unknowns.
int level_for(double blur_px, double clearance_px) {
  constexpr double kMinRadius = 3.5;
  int level = 0;
  while (blur_px > 2.4 * (1 << level) &&
         kMaxOfClearance * clearance_px > kMinRadius * (2 << level) && level < 6) {
    ++level;
  }
  return level;
}

}  // namespace

std::optional<CornerFit> fit_corner(PictureLevels& levels, int level, const CornerGuess& guess) {
  double factor = 1 << level;
  const double first_radius = std::clamp(0.35 * guess.clearance_px / factor, 2.5, 6.0);
  auto window = window_around(levels, level, guess.at_px / factor, first_radius);
  auto fit = window ? settle(*window, begin_at(*window, guess, factor)) : std::nullopt;
  for (int pass = 0; pass < 2 && fit; ++pass) {
    const int next = level_for(blur_of(fit->unknowns, factor), guess.clearance_px);
    const double next_factor = 1 << next;
    LevelFit moved = {.unknowns = on_level(fit->unknowns, factor, next_factor, 1.0),
                      .noise = fit->noise * factor / next_factor};
    const double radius = wanted_radius(moved, next_factor, guess.clearance_px);
    const double old_radius = window->radius_px * factor / next_factor;
    if (next == level && radius < 1.25 * old_radius && radius > 0.5 * old_radius) {
      break;
    }
    const double ratio = radius / old_radius;
    auto next_window = window_around(levels, next, moved.unknowns.head<2>(), radius);
    if (!next_window) {
      break;  // so near the border the finer level has to do
    }
    window = std::move(next_window);
    fit = settle(*window, on_level(fit->unknowns, factor, next_factor, ratio));
    level = next;
    factor = next_factor;
  }
  if (!fit) {
    return std::nullopt;
  }
  const Eigen::Vector2d at_px = fit->unknowns.head<2>() * factor;
  if ((at_px - guess.at_px).norm() > 0.4 * guess.clearance_px) {
    return std::nullopt;
  }
  return CornerFit{.at_px = at_px,
                   .blur_px = blur_of(fit->unknowns, factor),
                   .contrast = 2.0 * fit->unknowns[kHalf],
                   .noise = fit->noise * factor,
                   .clipped_share = clipped_share(*window, levels.clipped_value()),
                   .window_px = window->radius_px * factor};
}

}  // namespace glint
