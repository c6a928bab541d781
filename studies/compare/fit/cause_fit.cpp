// SPDX-License-Identifier: GPL-3.0-or-later
//
// All 2047 sets of the eleven parameters are compared by their linear fits, which costs eleven
// columns once and a small solution a set; the best set is then fitted with the exact projection by
// Ceres, and what turns out not to be sure leaves it. docs/theory/comparison.md.
#include "studies/compare/fit/cause_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <ceres/ceres.h>
#include <Eigen/Core>

#include "core/units.h"
#include "studies/compare/fit/edge_cost.h"
#include "studies/compare/fit/edge_system.h"

namespace glint {
namespace {

using compare_detail::cost_of;
using compare_detail::EdgeCost;
using compare_detail::EdgeSystem;
using compare_detail::index_of;
using compare_detail::kNotSeparable;
using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kMinEdges = 50;
constexpr double kSure = 3.7;  ///< standard deviations of a cause that is told

using EdgeCostFunction = ceres::AutoDiffCostFunction<EdgeCost, 1, kCauseParameters>;

/// The linear system about some changes: derivatives of the offsets by each parameter, and the
/// offsets that a linear model would have to explain.
EdgeSystem linearised(std::span<const SpaceEdge> edges,
                      const PinholeIntrinsics& camera,
                      const Vector3d& middle_mm,
                      std::size_t parameters,
                      const CauseVector& about) {
  const auto rows = static_cast<Index>(edges.size());
  Eigen::MatrixXd columns(rows, kCauseParameters);
  VectorXd offsets(rows);
  const double* at[] = {about.data()};
  const Eigen::Map<const Eigen::RowVectorXd> changes(about.data(), kCauseParameters);
  for (Index i = 0; i < rows; ++i) {
    const SpaceEdge& edge = edges[static_cast<std::size_t>(i)];
    const EdgeCostFunction cost(new EdgeCost(cost_of(camera, middle_mm, edge)));
    double rest = 0.0;
    std::array<double, kCauseParameters> gradient = {};
    double* jacobians[] = {gradient.data()};
    cost.Evaluate(at, &rest, jacobians);
    columns.row(i) = -Eigen::Map<const Eigen::RowVectorXd>(gradient.data(), kCauseParameters);
    // Without changes to the last bit, so that equal pictures are 0 apart.
    offsets[i] = changes.isZero(0.0) ? edge.offset_px : rest + columns.row(i).dot(changes);
  }
  return {std::move(columns), std::move(offsets), parameters};
}

class CauseSearch {
 public:
  CauseSearch(std::span<const SpaceEdge> edges,
              const PinholeIntrinsics& camera,
              const Vector3d& middle_mm,
              bool is_lens_known,
              double min_agreeing,
              const CauseVector& about)
      : edges_(edges),
        camera_(camera),
        middle_mm_(middle_mm),
        system_(
            linearised(edges,
                       camera,
                       middle_mm,
                       is_lens_known ? index_of(CauseParameter::kFocalLength) : kCauseParameters,
                       about)),
        min_agreeing_(min_agreeing) {}

  CauseFit find() const {
    const auto kept = static_cast<double>(system_.kept());
    CauseFit fit = {.before_px = std::sqrt(system_.squares() / kept),
                    .noise_px = system_.noise_px(),
                    .agreeing = system_.agreeing()};
    fit.after_px = fit.before_px;
    if (fit.agreeing < min_agreeing_) {
      return fit;
    }
    const auto [chosen, sigmas] = sure_set(fit.changes);
    fit.after_px = std::sqrt(system_.rest_of(chosen) / kept);
    const std::vector<double> shares = shares_of(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      fit.causes.push_back({.parameter = static_cast<CauseParameter>(chosen[i]),
                            .value = fit.changes[chosen[i]],
                            .sigma = sigmas[static_cast<Index>(i)],
                            .share = shares[i],
                            .not_separable = partners_of(chosen, chosen[i])});
    }
    add_doubt(chosen, fit.causes);
    std::ranges::stable_sort(fit.causes, std::greater<>(), &FoundCause::share);
    return fit;
  }

 private:
  /// The best set without what is not sure, the least sure one leaving first.
  /// @param changes  receives its values. @returns the set and the standard deviations
  std::pair<std::vector<std::size_t>, VectorXd> sure_set(CauseVector& changes) const {
    std::vector<std::size_t> chosen = system_.best_set();
    while (!chosen.empty()) {
      fit_exactly(chosen, changes);
      const VectorXd sigmas = system_.sigmas_of(chosen, rest_at(changes));
      VectorXd sure(sigmas.size());
      for (Index i = 0; i < sure.size(); ++i) {
        sure[i] = std::abs(changes[chosen[static_cast<std::size_t>(i)]]) / sigmas[i];
      }
      Index least = 0;
      if (sure.minCoeff(&least) >= kSure) {
        return {chosen, sigmas};
      }
      chosen.erase(chosen.begin() + least);
    }
    changes = {};
    return {};
  }

  VectorXd rest_at(const CauseVector& changes) const {
    VectorXd rest(static_cast<Index>(edges_.size()));
    for (Index i = 0; i < rest.size(); ++i) {
      cost_of(camera_, middle_mm_, edges_[static_cast<std::size_t>(i)])(changes.data(), &rest[i]);
    }
    return rest;
  }

  /// Fits the chosen parameters with the exact projection; the others are 0.
  void fit_exactly(const std::vector<std::size_t>& chosen, CauseVector& changes) const {
    changes = {};
    ceres::Problem problem;
    const double scale = 2.0 * system_.noise_px();
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const double weight = system_.weights()[static_cast<Index>(i)];
      if (weight > 0.0) {
        EdgeCost cost = cost_of(camera_, middle_mm_, edges_[i]);
        cost.root_weight = std::sqrt(weight);
        problem.AddResidualBlock(
            new EdgeCostFunction(new EdgeCost(cost)), new ceres::HuberLoss(scale), changes.data());
      }
    }
    std::vector<int> fixed;
    for (std::size_t k = 0; k < kCauseParameters; ++k) {
      if (std::ranges::find(chosen, k) == chosen.end()) {
        fixed.push_back(static_cast<int>(k));
      }
    }
    if (!fixed.empty()) {
      problem.SetManifold(changes.data(), new ceres::SubsetManifold(kCauseParameters, fixed));
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    options.max_num_iterations = 50;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
  }

  /// Were it not this cause but one that cannot be told from it, the others would have other
  /// values: a shift of the part also shows another side of it, a shift of the centre does not.
  /// That is part of what is not known of them.
  void add_doubt(const std::vector<std::size_t>& chosen, std::vector<FoundCause>& causes) const {
    const VectorXd values = system_.values_of(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      VectorXd most = VectorXd::Zero(values.size());
      for (const CauseParameter partner : causes[i].not_separable) {
        std::vector<std::size_t> swapped = chosen;
        swapped[i] = index_of(partner);
        if (std::ranges::count(chosen, swapped[i]) == 0) {
          most = most.cwiseMax((system_.values_of(swapped) - values).cwiseAbs());
        }
      }
      for (std::size_t other = 0; other < chosen.size(); ++other) {
        if (other != i) {
          causes[other].sigma = std::hypot(causes[other].sigma, most[static_cast<Index>(other)]);
        }
      }
    }
  }

  /// Of the sum of squares: what is lost without a parameter, in proportion.
  std::vector<double> shares_of(const std::vector<std::size_t>& chosen) const {
    const double rest = system_.rest_of(chosen);
    std::vector<double> losses;
    for (const std::size_t one : chosen) {
      std::vector<std::size_t> others = chosen;
      std::erase(others, one);
      losses.push_back(std::max(system_.rest_of(others) - rest, 0.0));
    }
    const double sum = std::accumulate(losses.begin(), losses.end(), 0.0);
    const double explained = system_.squares() > 0.0 ? 1.0 - rest / system_.squares() : 0.0;
    for (double& loss : losses) {
      loss = sum > 0.0 ? explained * loss / sum : 0.0;
    }
    return losses;
  }

  /// Parameters whose columns are the chosen one's but for a factor, the other chosen ones free.
  std::vector<CauseParameter> partners_of(const std::vector<std::size_t>& chosen,
                                          std::size_t one) const {
    std::vector<CauseParameter> partners;
    for (std::size_t other = 0; other < system_.parameters(); ++other) {
      if (other != one && std::abs(system_.correlation(one, other, chosen)) > kNotSeparable) {
        partners.push_back(static_cast<CauseParameter>(other));
      }
    }
    return partners;
  }

  std::span<const SpaceEdge> edges_;
  const PinholeIntrinsics& camera_;
  const Vector3d& middle_mm_;
  EdgeSystem system_;
  double min_agreeing_;
};

constexpr std::array<const char*, kCauseParameters> kNames = {"turn_x",
                                                              "turn_y",
                                                              "turn_z",
                                                              "shift_x",
                                                              "shift_y",
                                                              "distance",
                                                              "focal_length",
                                                              "centre_x",
                                                              "centre_y",
                                                              "k1",
                                                              "p1"};

}  // namespace

std::string name_of(CauseParameter parameter) {
  return kNames[index_of(parameter)];
}

std::string unit_of(CauseParameter parameter) {
  if (parameter <= CauseParameter::kTurnZ) {
    return "deg";
  }
  if (parameter <= CauseParameter::kDistance) {
    return "mm";
  }
  return parameter <= CauseParameter::kCentreY ? "px" : "";
}

double told_per_inner(CauseParameter parameter) {
  return parameter <= CauseParameter::kTurnZ ? kDegPerRad : 1.0;
}

Vector2d changed_pixel(const PinholeIntrinsics& camera,
                       const Vector3d& middle_mm,
                       const CauseVector& changes,
                       const Vector3d& point_mm) {
  Vector2d pixel;
  compare_detail::project(camera, middle_mm, changes.data(), point_mm, pixel.data());
  return pixel;
}

CauseFit fit_causes(std::span<const SpaceEdge> edges,
                    const PinholeIntrinsics& camera,
                    const Vector3d& middle_mm,
                    bool is_lens_known,
                    double min_agreeing,
                    const CauseVector& about) {
  const bool is_finite = std::ranges::all_of(edges, [](const SpaceEdge& edge) {
    return std::isfinite(edge.offset_px) && edge.in_camera_mm.allFinite();
  });
  if (edges.size() < kMinEdges || !is_finite) {
    return {};
  }
  return CauseSearch(edges, camera, middle_mm, is_lens_known, min_agreeing, about).find();
}

}  // namespace glint
