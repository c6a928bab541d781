// SPDX-License-Identifier: GPL-3.0-or-later
//
// A blurred step fitted to grey values along a normal: Gauss-Newton steps with Levenberg's damping
// over place, spread and both greys. docs/theory/comparison.md.
#include "metrics/overlap/edge_location.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector4d;

constexpr double kStepPx = 0.5;       ///< between samples of a profile
constexpr double kFitReachPx = 3.0;   ///< around the steepest place
constexpr double kMinSpreadPx = 0.2;  ///< less than a pixel's own extent
constexpr double kMaxSpreadPx = 3.0;
constexpr double kMaxResidual = 0.15;  ///< rms of a step's fit, share of its contrast
constexpr int kIterations = 15;

struct Profile {
  std::vector<double> at_px;
  std::vector<double> grey;  ///< mean of the lines
  double variance = 0.0;     ///< of that mean, by the scatter between lines; 0: there is one line
};

Profile profile_at(const ImageF& picture, const BoundaryPoint& point, const EdgeSearch& search) {
  Profile profile;
  const Vector2d along(-point.normal.y(), point.normal.x());
  const int half = static_cast<int>(search.reach_px / kStepPx);
  const int beside = static_cast<int>(search.along_px);
  for (int i = -half; i <= half; ++i) {
    const double t = i * kStepPx;
    double sum = 0.0;
    double squares = 0.0;
    for (int j = -beside; j <= beside; ++j) {
      const double grey = sample(picture, point.at_px + t * point.normal + j * along);
      sum += grey;
      squares += grey * grey;
    }
    const int lines = 2 * beside + 1;
    profile.at_px.push_back(t);
    profile.grey.push_back(sum / lines);
    if (lines > 1) {
      profile.variance +=
          std::max(squares - sum * sum / lines, 0.0) / (lines - 1) / lines / (2 * half + 1);
    }
  }
  return profile;
}

/// Whether all samples of the profile lie in the picture.
bool is_inside(const ImageF& picture, const BoundaryPoint& point, const EdgeSearch& search) {
  const double reach = search.reach_px + search.along_px;
  return point.at_px.x() > reach && point.at_px.y() > reach &&
         point.at_px.x() < picture.width() - reach && point.at_px.y() < picture.height() - reach;
}

/// The sample around which grey values change most over two pixels; of alike ones the nearest to
/// the middle.
std::size_t steepest(const Profile& profile) {
  constexpr std::size_t kReach = 2;
  std::size_t best = kReach;
  double best_change = -1.0;
  for (std::size_t i = kReach; i + kReach < profile.grey.size(); ++i) {
    const double change = std::abs(profile.grey[i + kReach] - profile.grey[i - kReach]) /
                          (1.0 + 0.05 * profile.at_px[i] * profile.at_px[i]);
    if (change > best_change) {
      best_change = change;
      best = i;
    }
  }
  return best;
}

/// Place, logarithm of the spread, grey far behind and far ahead.
struct StepFit {
  Vector4d values;
  double cost = 0.0;  ///< sum of squares
  double sigma_px = 0.0;
  int samples = 0;
};

class StepProblem {
 public:
  StepProblem(const Profile& profile, double middle_px) : profile_variance_(profile.variance) {
    for (std::size_t i = 0; i < profile.at_px.size(); ++i) {
      if (std::abs(profile.at_px[i] - middle_px) <= kFitReachPx + 1e-9) {
        at_px_.push_back(profile.at_px[i]);
        grey_.push_back(profile.grey[i]);
      }
    }
  }

  Vector4d start(double middle_px) const {
    return {middle_px,
            std::log(0.8),
            0.5 * (grey_[0] + grey_[1]),
            0.5 * (grey_[grey_.size() - 1] + grey_[grey_.size() - 2])};
  }

  double cost(const Vector4d& values) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < at_px_.size(); ++i) {
      const double u = (at_px_[i] - values[0]) / std::exp(values[1]);
      const double ahead = 0.5 * std::erfc(-u / std::sqrt(2.0));
      const double rest = grey_[i] - (values[2] + (values[3] - values[2]) * ahead);
      sum += rest * rest;
    }
    return sum;
  }

  void linearise(const Vector4d& values, Eigen::Matrix4d& normal, Vector4d& right) const {
    normal.setZero();
    right.setZero();
    const double spread = std::exp(values[1]);
    const double step = values[3] - values[2];
    for (std::size_t i = 0; i < at_px_.size(); ++i) {
      const double u = (at_px_[i] - values[0]) / spread;
      const double ahead = 0.5 * std::erfc(-u / std::sqrt(2.0));
      const double density = std::exp(-0.5 * u * u) / std::sqrt(2.0 * kPi);
      const Vector4d row(-step * density / spread, -step * density * u, 1.0 - ahead, ahead);
      normal += row * row.transpose();
      right += row * (grey_[i] - (values[2] + step * ahead));
    }
  }

  StepFit fit(double middle_px) const {
    StepFit best = {.values = start(middle_px), .samples = static_cast<int>(at_px_.size())};
    best.cost = cost(best.values);
    double damping = 1e-3;
    Eigen::Matrix4d normal;
    Vector4d right;
    for (int i = 0; i < kIterations; ++i) {
      linearise(best.values, normal, right);
      Eigen::Matrix4d damped = normal;
      damped.diagonal() *= 1.0 + damping;
      damped.diagonal().array() += 1e-12;
      const Vector4d change = damped.ldlt().solve(right);
      Vector4d values = best.values + change;
      values[1] = std::clamp(values[1], std::log(kMinSpreadPx), std::log(kMaxSpreadPx));
      const double next = cost(values);
      damping = next < best.cost ? 0.2 * damping : 10.0 * damping;
      if (next < best.cost) {
        best.values = values;
        best.cost = next;
        if (std::abs(change[0]) < 1e-5) {
          break;
        }
      }
    }
    linearise(best.values, normal, right);
    normal.diagonal().array() += 1e-12;
    // Noise of samples half a pixel apart by bilinear interpolation: what it does to a sum along
    // the profile, over what scatters between lines, is 8/3 along rows and 6 at any other angle.
    constexpr double kAlike = 4.0;
    const double variance =
        profile_variance_ > 0.0 ? profile_variance_ : best.cost / std::max(best.samples - 4, 1);
    best.sigma_px = std::sqrt(kAlike * variance * std::max(normal.inverse()(0, 0), 0.0));
    return best;
  }

 private:
  std::vector<double> at_px_;
  std::vector<double> grey_;
  double profile_variance_;
};

/// @param contrast  of the whole profile
bool is_step(const StepFit& fit, double middle_px, double contrast, const EdgeSearch& search) {
  const double size = std::abs(fit.values[2] - fit.values[3]);
  return size >= search.min_contrast && size <= 2.0 * contrast &&
         std::sqrt(fit.cost / fit.samples) <= kMaxResidual * size &&
         std::abs(fit.values[0] - middle_px) < kFitReachPx - 1.0 &&
         std::abs(fit.values[0]) < search.reach_px;
}

std::optional<LocatedEdge> locate(const ImageF& picture,
                                  const BoundaryPoint& point,
                                  const EdgeSearch& search) {
  if (!is_inside(picture, point, search)) {
    return std::nullopt;
  }
  const Profile profile = profile_at(picture, point, search);
  const auto [low, high] = std::ranges::minmax(profile.grey);
  if (high - low < search.min_contrast) {
    return std::nullopt;
  }
  const double middle_px = profile.at_px[steepest(profile)];
  const StepFit fit = StepProblem(profile, middle_px).fit(middle_px);
  if (!is_step(fit, middle_px, high - low, search)) {
    return std::nullopt;
  }
  LocatedEdge edge;
  edge.edge = {.at_px = point.at_px + fit.values[0] * point.normal, .normal = point.normal};
  edge.moved_px = fit.values[0];
  edge.contrast = fit.values[2] - fit.values[3];
  edge.sigma_px = fit.sigma_px;
  edge.spread_px = std::exp(fit.values[1]);
  return edge;
}

}  // namespace

std::vector<LocatedEdge> locate_edges(const ImageF& picture,
                                      std::span<const Boundary> boundaries,
                                      const EdgeSearch& search) {
  std::vector<LocatedEdge> edges;
  for (std::size_t b = 0; b < boundaries.size(); ++b) {
    for (std::size_t i = 0; i < boundaries[b].points.size(); ++i) {
      std::optional<LocatedEdge> edge = locate(picture, boundaries[b].points[i], search);
      if (edge) {
        edge->boundary = b;
        edge->point = i;
        edges.push_back(*edge);
      }
    }
  }
  return edges;
}

std::vector<Boundary> joined(std::span<const LocatedEdge> edges,
                             std::span<const Boundary> boundaries) {
  constexpr double kMaxGapPx = 3.0;
  constexpr std::size_t kMaxLeftOut = 2;
  constexpr std::size_t kShortestLine = 5;
  std::vector<Boundary> lines;
  const LocatedEdge* last = nullptr;
  for (const LocatedEdge& edge : edges) {
    const bool follows = last != nullptr && last->boundary == edge.boundary &&
                         edge.point - last->point <= kMaxLeftOut + 1 &&
                         (edge.edge.at_px - last->edge.at_px).norm() <= kMaxGapPx;
    if (!follows) {
      lines.emplace_back();
    }
    lines.back().points.push_back(edge.edge);
    lines.back().is_closed = boundaries[edge.boundary].is_closed &&
                             lines.back().points.size() == boundaries[edge.boundary].points.size();
    last = &edge;
  }
  std::erase_if(lines, [](const Boundary& line) { return line.points.size() < kShortestLine; });
  return lines;
}

}  // namespace glint
