// SPDX-License-Identifier: GPL-3.0-or-later
//
// Removes the noise of path tracing from a picture that was rendered twice. At each pixel a
// polynomial of second degree is fitted by least squares to the pixels around that show the same
// surface; of what the fit leaves over, the share that both renderings agree on is added again
// (their product is free of noise on average). Both use the geometry of the camera rays, which has
// no noise. Own method, docs/theory/simulated_line.md. Cost: 13 x 13 pixels per fit, whose weights
// serve all pictures. Memory: a copy of each picture and two doubles per pixel.
#include "simulator/render/path_tracing/smooth_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

namespace glint {
namespace {

constexpr int kReach = 6;   ///< of a fit, to each side
constexpr int kAround = 4;  ///< of the judgement, to each side
constexpr double kPixelsAround = (2 * kAround + 1) * (2 * kAround + 1);
constexpr int kTerms = 6;  ///< 1, u, v, u^2, u v, v^2
constexpr int kMinPixels = 3 * kTerms;

using Terms = Eigen::Matrix<double, kTerms, 1>;

Terms terms_at(int du, int dv) {
  const double u = static_cast<double>(du) / kReach;
  const double v = static_cast<double>(dv) / kReach;
  return {1.0, u, v, u * u, u * v, v * v};
}

/// Pixels that show the same surface as another.
class SameSurface {
 public:
  SameSurface(const SurfaceImages& surface, const CoverageImages& coverage)
      : surface_(surface), on_part_(coverage.background.width(), coverage.background.height()) {
    constexpr float kOnPart = 1e-6F;
    for (std::size_t i = 0; i < on_part_.size(); ++i) {
      on_part_.values()[i] = coverage.background.values()[i] < kOnPart ? 1 : 0;
    }
  }

  const Mask& on_part() const { return on_part_; }

  /// @param a, b  indices of pixels, both on the part
  bool are_near(std::size_t a, std::size_t b) const {
    constexpr float kMinCosine = 0.97F;  // 14 degrees
    constexpr float kMaxRise = 0.25F;    // above the tangent plane, of the distance
    const float nx = surface_.normal_x.values()[a];
    const float ny = surface_.normal_y.values()[a];
    const float nz = surface_.normal_z.values()[a];
    const float cosine = nx * surface_.normal_x.values()[b] + ny * surface_.normal_y.values()[b] +
                         nz * surface_.normal_z.values()[b];
    const float dx = surface_.x_mm.values()[b] - surface_.x_mm.values()[a];
    const float dy = surface_.y_mm.values()[b] - surface_.y_mm.values()[a];
    const float dz = surface_.z_mm.values()[b] - surface_.z_mm.values()[a];
    const float rise = dx * nx + dy * ny + dz * nz;
    return cosine > kMinCosine &&
           rise * rise <= kMaxRise * kMaxRise * (dx * dx + dy * dy + dz * dz);
  }

 private:
  const SurfaceImages& surface_;
  Mask on_part_;
};

/// Weights of a pixel's neighbours that give the fitted polynomial's value there.
class FitWeights {
 public:
  FitWeights() {
    for (int v = -kReach; v <= kReach; ++v) {
      for (int u = -kReach; u <= kReach; ++u) {
        terms_.push_back(terms_at(u, v));
      }
    }
  }

  struct Weight {
    std::size_t pixel = 0;
    float weight = 0.0F;
  };

  /// Empty where too little of the surface is seen.
  const std::vector<Weight>& at(const SameSurface& same, int x, int y) {
    weights_.clear();
    const Mask& on_part = same.on_part();
    const auto width = static_cast<std::size_t>(on_part.width());
    const std::size_t here = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    near_.clear();
    Eigen::Matrix<double, kTerms, kTerms> moments = Eigen::Matrix<double, kTerms, kTerms>::Zero();
    for (int v = std::max(-kReach, -y); v <= std::min(kReach, on_part.height() - 1 - y); ++v) {
      for (int u = std::max(-kReach, -x); u <= std::min(kReach, on_part.width() - 1 - x); ++u) {
        const std::size_t there =
            static_cast<std::size_t>(y + v) * width + static_cast<std::size_t>(x + u);
        if (on_part.values()[there] != 0 && same.are_near(here, there)) {
          const std::size_t term =
              static_cast<std::size_t>((v + kReach) * (2 * kReach + 1) + u + kReach);
          near_.push_back({.pixel = there, .term = term});
          moments.selfadjointView<Eigen::Lower>().rankUpdate(terms_[term]);
        }
      }
    }
    if (static_cast<int>(near_.size()) >= kMinPixels) {
      solve(moments);
    }
    return weights_;
  }

 private:
  struct Near {
    std::size_t pixel = 0;
    std::size_t term = 0;
  };

  /// The value at the pixel itself is the polynomial's first coefficient.
  void solve(Eigen::Matrix<double, kTerms, kTerms>& moments) {
    constexpr double kRidge = 1e-6;  // narrow strips do not determine all terms
    moments.diagonal().array() += kRidge * static_cast<double>(near_.size());
    const Terms row = moments.selfadjointView<Eigen::Lower>().llt().solve(Terms(Terms::Unit(0)));
    for (const Near& one : near_) {
      weights_.push_back(
          {.pixel = one.pixel, .weight = static_cast<float>(row.dot(terms_[one.term]))});
    }
  }

  std::vector<Terms> terms_;
  std::vector<Near> near_;
  std::vector<Weight> weights_;
};

/// Sums over the 9 x 9 pixels around each.
std::vector<double> sums_around(const std::vector<double>& values, int width, int height) {
  std::vector<double> along(values.size());
  std::vector<double> sums(values.size());
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int u = std::max(0, x - kAround); u <= std::min(width - 1, x + kAround); ++u) {
        along[at(x, y)] += values[at(u, y)];
      }
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int v = std::max(0, y - kAround); v <= std::min(height - 1, y + kAround); ++v) {
      for (int x = 0; x < width; ++x) {
        sums[at(x, y)] += along[at(x, v)];
      }
    }
  }
  return sums;
}

/// Adds again what both renderings have beyond their fits.
void restore(const Mask& on_part, const RenderedTwice& rendered, RenderedTwice& fitted) {
  std::vector<double> products(on_part.size());
  std::vector<double> squares(on_part.size());
  const auto left_over = [&](std::size_t k, std::size_t i) {
    return rendered[k].values()[i] - fitted[k].values()[i];
  };
  for (std::size_t i = 0; i < on_part.size(); ++i) {
    const auto a = static_cast<double>(left_over(0, i));
    const auto b = static_cast<double>(left_over(1, i));
    products[i] = a * b;
    squares[i] = 0.25 * (a + b) * (a + b);
  }
  products = sums_around(products, on_part.width(), on_part.height());
  squares = sums_around(squares, on_part.width(), on_part.height());
  for (std::size_t i = 0; i < on_part.size(); ++i) {
    const double agreed = agreed_share(products[i], squares[i], kPixelsAround);
    const float share = on_part.values()[i] != 0 ? static_cast<float>(agreed) : 1.0F;
    for (std::size_t k = 0; k < 2; ++k) {
      fitted[k].values()[i] += share * left_over(k, i);
    }
  }
}

}  // namespace

double agreed_share(double product, double square, double count) {
  constexpr double kMaxScatter = 0.5;
  const double noise_variance = std::min(kMaxScatter, 2.0 / std::sqrt(std::max(1.0, count)));
  const double share = square > 0.0 ? product / square : 1.0;
  return std::clamp((share - noise_variance) / (1.0 - noise_variance), 0.0, 1.0);
}

void smooth(const SurfaceImages& surface,
            const CoverageImages& coverage,
            std::span<RenderedTwice> pictures,
            ThreadPool& pool) {
  const SameSurface same(surface, coverage);
  const Mask& on_part = same.on_part();
  std::vector<RenderedTwice> fitted(pictures.begin(), pictures.end());
  pool.for_each(on_part.height(), [&](std::int64_t row) {
    FitWeights fit;
    const int y = static_cast<int>(row);
    for (int x = 0; x < on_part.width(); ++x) {
      if (on_part(x, y) == 0) {
        continue;
      }
      const auto& weights = fit.at(same, x, y);
      for (std::size_t p = 0; p < pictures.size() && !weights.empty(); ++p) {
        for (std::size_t k = 0; k < 2; ++k) {
          float value = 0.0F;
          for (const FitWeights::Weight& one : weights) {
            value += one.weight * pictures[p][k].values()[one.pixel];
          }
          fitted[p][k](x, y) = value;
        }
      }
    }
  });
  pool.for_each(static_cast<std::int64_t>(pictures.size()), [&](std::int64_t p) {
    const auto i = static_cast<std::size_t>(p);
    restore(on_part, pictures[i], fitted[i]);
    pictures[i] = std::move(fitted[i]);
  });
}

}  // namespace glint
