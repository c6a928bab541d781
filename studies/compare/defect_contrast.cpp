// SPDX-License-Identifier: GPL-3.0-or-later
//
// The variance of a mean of n pixels whose neighbours are alike is s^2 / n (1 + 2 sum over lags of
// N r / n), r the correlation at a lag and N how many of the pixels have a partner at it. r is that
// of the pixels around the defect, about the plane through their greys: the defect itself and
// uneven light are no noise.
#include "studies/compare/defect_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInnerRing = 1.5;  ///< of the surroundings, in radii from the defect
constexpr double kOuterRing = 3.0;
constexpr double kLeastOfEither = 4.0;
constexpr int kAlikeReachPx = 4;  ///< of the correlation between pixels

enum class Kind : std::uint8_t { kNone, kInside, kAround };

/// A picture's pixels around a defect: which is what, and its grey.
class Patch {
 public:
  Patch(const ImageF& picture, const Mask& region, const KnownDefect& defect) {
    const double reach = kOuterRing * defect.radius_px;
    const Eigen::Vector2d low = defect.from_px.cwiseMin(defect.to_px).array() - reach;
    const Eigen::Vector2d high = defect.from_px.cwiseMax(defect.to_px).array() + reach;
    const int left = std::max(0, static_cast<int>(low.x()));
    const int top = std::max(0, static_cast<int>(low.y()));
    const int right = std::min(picture.width(), static_cast<int>(high.x()) + 1);
    const int bottom = std::min(picture.height(), static_cast<int>(high.y()) + 1);
    width_ = std::max(0, right - left);
    height_ = std::max(0, bottom - top);
    for (int y = top; y < top + height_; ++y) {
      for (int x = left; x < left + width_; ++x) {
        const bool is_part = region.empty() || region(x, y) != 0;
        kinds_.push_back(is_part ? kind_at(defect, x, y) : Kind::kNone);
        greys_.push_back(static_cast<double>(picture(x, y)));
      }
    }
  }

  double count(Kind kind) const { return static_cast<double>(std::ranges::count(kinds_, kind)); }

  double mean(Kind kind) const {
    double sum = 0.0;
    for_each(kind, [&](int, int, double grey) { sum += grey; });
    return sum / count(kind);
  }

  /// Takes the slope of the surroundings out of all greys.
  void flatten() {
    Matrix3d products = Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    for_each(Kind::kAround, [&](int x, int y, double grey) {
      const Vector3d row = row_at(x, y);
      products += row * row.transpose();
      right += row * grey;
    });
    const Vector3d plane = products.completeOrthogonalDecomposition().solve(right);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        greys_[index(x, y)] -= plane.head<2>().dot(row_at(x, y).head<2>());
      }
    }
  }

  /// Of the pixels of a kind.
  double variance(Kind kind) const {
    const double middle = mean(kind);
    double squares = 0.0;
    for_each(kind, [&](int, int, double grey) { squares += (grey - middle) * (grey - middle); });
    return squares / std::max(count(kind) - 1.0, 1.0);
  }

  /// Of their mean.
  double variance_of_mean(Kind kind) const {
    const double around = variance(Kind::kAround);
    const double size = count(kind);
    double alike = 1.0;
    for (int dy = 0; dy <= kAlikeReachPx; ++dy) {
      for (int dx = dy == 0 ? 1 : -kAlikeReachPx; dx <= kAlikeReachPx && around > 0.0; ++dx) {
        if (dx * dx + dy * dy <= kAlikeReachPx * kAlikeReachPx) {
          const Pairs ring = pairs(Kind::kAround, dx, dy);
          const double correlation = ring.count > 0.0 ? ring.products / ring.count / around : 0.0;
          alike += 2.0 * pairs(kind, dx, dy).count / size * correlation;
        }
      }
    }
    return variance(kind) / size * std::max(alike, 1.0);
  }

 private:
  /// Pixels of one kind that are a step apart.
  struct Pairs {
    double count = 0.0;
    double products = 0.0;  ///< of what they are off their mean
  };

  static Kind kind_at(const KnownDefect& defect, int x, int y) {
    const double radii = defect.distance_px({x + 0.5, y + 0.5}) / defect.radius_px;
    if (radii <= 1.0) {
      return Kind::kInside;
    }
    return radii >= kInnerRing && radii <= kOuterRing ? Kind::kAround : Kind::kNone;
  }

  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * width_ + x); }

  Vector3d row_at(int x, int y) const { return {x - 0.5 * width_, y - 0.5 * height_, 1.0}; }

  template <class Function>
  void for_each(Kind kind, const Function& function) const {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        if (kinds_[index(x, y)] == kind) {
          function(x, y, greys_[index(x, y)]);
        }
      }
    }
  }

  Pairs pairs(Kind kind, int dx, int dy) const {
    const double middle = mean(kind);
    Pairs result;
    for_each(kind, [&](int x, int y, double grey) {
      const bool is_within = x + dx >= 0 && x + dx < width_ && y + dy < height_;
      if (is_within && kinds_[index(x + dx, y + dy)] == kind) {
        result.count += 1.0;
        result.products += (grey - middle) * (greys_[index(x + dx, y + dy)] - middle);
      }
    });
    return result;
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<Kind> kinds_;
  std::vector<double> greys_;
};

}  // namespace

std::optional<Estimate> defect_contrast(const ImageF& picture,
                                        const Mask& region,
                                        const KnownDefect& defect) {
  Patch patch(picture, region, defect);
  if (patch.count(Kind::kInside) < kLeastOfEither || patch.count(Kind::kAround) < kLeastOfEither) {
    return std::nullopt;
  }
  const double around = patch.mean(Kind::kAround);
  if (!(around > 0.0)) {
    return std::nullopt;
  }
  const double ratio = patch.mean(Kind::kInside) / around;
  patch.flatten();
  const double deviation = std::sqrt(patch.variance_of_mean(Kind::kInside) +
                                     ratio * ratio * patch.variance_of_mean(Kind::kAround)) /
                           around;
  return Estimate{.value = ratio - 1.0,
                  .low = ratio - 1.0 - 1.96 * deviation,
                  .high = ratio - 1.0 + 1.96 * deviation};
}

}  // namespace glint
