// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inside and light are weighted sums of grey values, so mean inside - ratio * light is one, too. Of
// a sum with weights w over pixels whose noise has the variance s^2 and the correlation r at a lag,
// the variance is s^2 (sum of w^2 + 2 sum over lags of r times the sum of w w' over pixels that far
// apart). s and r are those of the residuals around the defect.
#include "studies/inspect/defect_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kInnerRing = 1.5;  ///< of the surroundings, in radii from the defect
constexpr double kOuterRing = 3.0;
constexpr int kTerms = 6;  ///< of a quadratic in x and y
constexpr double kMinInside = 4.0;
constexpr double kMinAround = 2.0 * kTerms;
constexpr double kSingular = 1e-9;  ///< of the normal equations' largest pivot
constexpr int kAlikeReachPx = 4;    ///< of the correlation between pixels

using Row = Eigen::Matrix<double, kTerms, 1>;
using Square = Eigen::Matrix<double, kTerms, kTerms>;

enum class PatchPart : std::uint8_t { kElsewhere, kInside, kAround };

/// A picture's pixels around a defect: where each is, and its grey.
class DefectPatch {
 public:
  DefectPatch(const ImageF& picture, const Mask& region, const KnownDefect& defect)
      : middle_(defect.middle_px()) {
    const double reach_px = kOuterRing * defect.radius_px;
    const Vector2d line = defect.to_px - defect.from_px;
    const Vector2d along = line.norm() > 0.0 ? line.normalized() : Vector2d(1.0, 0.0);
    to_unit_.row(0) = along.transpose() / (reach_px + 0.5 * line.norm());
    to_unit_.row(1) = Vector2d(-along.y(), along.x()).transpose() / reach_px;
    const Vector2d low = defect.from_px.cwiseMin(defect.to_px).array() - reach_px;
    const Vector2d high = defect.from_px.cwiseMax(defect.to_px).array() + reach_px;
    left_ = std::max(0, static_cast<int>(low.x()));
    top_ = std::max(0, static_cast<int>(low.y()));
    width_ = std::max(0, std::min(picture.width(), static_cast<int>(high.x()) + 1) - left_);
    height_ = std::max(0, std::min(picture.height(), static_cast<int>(high.y()) + 1) - top_);
    for (int y = top_; y < top_ + height_; ++y) {
      for (int x = left_; x < left_ + width_; ++x) {
        const bool is_part = region.empty() || region(x, y) != 0;
        parts_.push_back(is_part ? part_at(defect, x, y) : PatchPart::kElsewhere);
        greys_.push_back(static_cast<double>(picture(x, y)));
      }
    }
  }

  std::optional<Estimate> contrast() const {
    const double inside = count(PatchPart::kInside);
    const double around = count(PatchPart::kAround);
    if (inside < kMinInside || around < kMinAround) {
      return std::nullopt;
    }
    const Eigen::ColPivHouseholderQR<Square> products = products_around();
    if (products.rank() < kTerms) {
      return std::nullopt;
    }
    const Row share = products.solve(mean_row(PatchPart::kInside));
    std::vector<double> weights(greys_.size(), 0.0);
    for_each(PatchPart::kInside, [&](std::size_t i) { weights[i] = 1.0 / inside; });
    for_each(PatchPart::kAround, [&](std::size_t i) { weights[i] = share.dot(row_of(i)); });
    const auto weighted = [&](std::size_t i) { return weights[i] * greys_[i]; };
    const double light = sum(PatchPart::kAround, weighted);
    if (!(light > 0.0)) {
      return std::nullopt;
    }
    const double ratio = sum(PatchPart::kInside, weighted) / light;
    for_each(PatchPart::kAround, [&](std::size_t i) { weights[i] *= -ratio; });
    const double half = 1.96 * std::sqrt(variance_of(weights, residuals_about(products))) / light;
    return Estimate{.value = ratio - 1.0, .low = ratio - 1.0 - half, .high = ratio - 1.0 + half};
  }

 private:
  static PatchPart part_at(const KnownDefect& defect, int x, int y) {
    const double radii = defect.distance_px({x + 0.5, y + 0.5}) / defect.radius_px;
    if (radii <= 1.0) {
      return PatchPart::kInside;
    }
    return radii >= kInnerRing && radii <= kOuterRing ? PatchPart::kAround : PatchPart::kElsewhere;
  }

  double count(PatchPart part) const {
    return static_cast<double>(std::ranges::count(parts_, part));
  }

  template <class Function>
  void for_each(PatchPart part, const Function& function) const {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (parts_[i] == part) {
        function(i);
      }
    }
  }

  template <class Function>
  double sum(PatchPart part, const Function& function) const {
    double total = 0.0;
    for_each(part, [&](std::size_t i) { total += function(i); });
    return total;
  }

  /// The terms of the quadratic at a pixel.
  Row row_of(std::size_t i) const {
    const auto width = static_cast<std::size_t>(width_);
    const std::size_t row_of_pixel = i / width;
    const Vector2d at(left_ + static_cast<double>(i % width) + 0.5,
                      top_ + static_cast<double>(row_of_pixel) + 0.5);
    const Vector2d off = to_unit_ * (at - middle_);
    Row row;
    row << 1.0, off.x(), off.y(), off.x() * off.x(), off.x() * off.y(), off.y() * off.y();
    return row;
  }

  Row mean_row(PatchPart part) const {
    Row total = Row::Zero();
    for_each(part, [&](std::size_t i) { total += row_of(i); });
    return total / count(part);
  }

  /// The normal equations of the fit.
  Eigen::ColPivHouseholderQR<Square> products_around() const {
    Square products = Square::Zero();
    for_each(PatchPart::kAround, [&](std::size_t i) {
      const Row row = row_of(i);
      products += row * row.transpose();
    });
    Eigen::ColPivHouseholderQR<Square> solver;
    solver.setThreshold(kSingular);
    solver.compute(products);
    return solver;
  }

  /// What the fit leaves of the pixels around; 0 elsewhere.
  std::vector<double> residuals_about(const Eigen::ColPivHouseholderQR<Square>& products) const {
    Row right = Row::Zero();
    for_each(PatchPart::kAround, [&](std::size_t i) { right += row_of(i) * greys_[i]; });
    const Row fit = products.solve(right);
    std::vector<double> residuals(greys_.size(), 0.0);
    for_each(PatchPart::kAround,
             [&](std::size_t i) { residuals[i] = greys_[i] - fit.dot(row_of(i)); });
    return residuals;
  }

  /// Of the sum of grey values times weights.
  double variance_of(const std::vector<double>& weights,
                     const std::vector<double>& residuals) const {
    const double around = count(PatchPart::kAround);
    const double variance = lagged(residuals, residuals, 0, 0) / (around - kTerms);
    std::vector<double> is_around(greys_.size(), 0.0);
    for_each(PatchPart::kAround, [&](std::size_t i) { is_around[i] = 1.0; });
    const double alone = lagged(weights, weights, 0, 0);
    double together = alone;
    for (int dy = 0; dy <= kAlikeReachPx; ++dy) {
      for (int dx = dy == 0 ? 1 : -kAlikeReachPx; dx <= kAlikeReachPx && variance > 0.0; ++dx) {
        const double pairs = lagged(is_around, is_around, dx, dy);
        if (dx * dx + dy * dy <= kAlikeReachPx * kAlikeReachPx && pairs > 0.0) {
          const double alike = lagged(residuals, residuals, dx, dy) / pairs / variance;
          together += 2.0 * alike * lagged(weights, weights, dx, dy);
        }
      }
    }
    return variance * std::max(together, alone);
  }

  /// Sum over pixels of one value times the other one a step further. @param dy  >= 0
  double lagged(const std::vector<double>& first,
                const std::vector<double>& second,
                int dx,
                int dy) const {
    double total = 0.0;
    for (int y = 0; y + dy < height_; ++y) {
      for (int x = std::max(0, -dx); x < width_ - std::max(0, dx); ++x) {
        total += first[index(x, y)] * second[index(x + dx, y + dy)];
      }
    }
    return total;
  }

  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * width_ + x); }

  Vector2d middle_;
  Eigen::Matrix2d to_unit_;  ///< offsets from there, along the line and across it, in [-1, 1]
  int left_ = 0;
  int top_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<PatchPart> parts_;
  std::vector<double> greys_;
};

}  // namespace

std::optional<Estimate> defect_contrast(const ImageF& picture,
                                        const Mask& region,
                                        const KnownDefect& defect) {
  return DefectPatch(picture, region, defect).contrast();
}

}  // namespace glint
