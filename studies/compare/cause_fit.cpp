// SPDX-License-Identifier: GPL-3.0-or-later
//
// All 2047 sets of the eleven parameters are compared by their linear fits, which costs eleven
// columns once and a small solution a set; the best set is then fitted with the exact projection by
// Ceres. docs/theory/comparison.md.
#include "studies/compare/cause_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <Eigen/Dense>

#include "core/units.h"

namespace glint {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kMinEdges = 50;
constexpr double kPrice = 14.0;  ///< of a parameter, in squared standard deviations
/// What a parameter must explain of the misfit: the model of edges is not better than that where
/// they have moved far.
constexpr double kLeastShare = 0.005;
constexpr double kNotSeparable = 0.99;
constexpr double kOutlierSigmas = 4.0;
constexpr int kMaxLag = 40;  ///< of neighbours whose noise may be alike

constexpr std::size_t index_of(CauseParameter parameter) {
  return static_cast<std::size_t>(parameter);
}

/// The pixel of a point under changes of all parameters.
template <class T>
void project(const PinholeIntrinsics& camera,
             const Vector3d& middle_mm,
             const T* change,
             const Vector3d& point_mm,
             T* pixel) {
  const Vector3d from = point_mm - middle_mm;
  const T around[3] = {T(from.x()), T(from.y()), T(from.z())};
  T turned[3];
  ceres::AngleAxisRotatePoint(change, around, turned);
  const T z = turned[2] + middle_mm.z() + change[index_of(CauseParameter::kDistance)];
  const T x = (turned[0] + middle_mm.x() + change[index_of(CauseParameter::kShiftX)]) / z;
  const T y = (turned[1] + middle_mm.y() + change[index_of(CauseParameter::kShiftY)]) / z;
  const T r2 = x * x + y * y;
  const T k1 = camera.radial[0] + change[index_of(CauseParameter::kK1)];
  const T p1 = camera.tangential[0] + change[index_of(CauseParameter::kP1)];
  const double p2 = camera.tangential[1];
  const T radial = 1.0 + r2 * (k1 + r2 * (camera.radial[1] + r2 * camera.radial[2]));
  const T u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const T v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  const T focal = 1.0 + change[index_of(CauseParameter::kFocalLength)] / camera.focal_px.x();
  pixel[0] = camera.focal_px.x() * focal * u + camera.center_px.x() +
             change[index_of(CauseParameter::kCentreX)];
  pixel[1] = camera.focal_px.y() * focal * v + camera.center_px.y() +
             change[index_of(CauseParameter::kCentreY)];
}

/// Offset of an edge that the changes leave.
struct EdgeCost {
  const PinholeIntrinsics& camera;
  const Vector3d& middle_mm;
  const SpaceEdge& edge;
  Vector2d before_px;

  template <class T>
  bool operator()(const T* change, T* rest) const {
    T pixel[2];
    project(camera, middle_mm, change, edge.in_camera_mm, pixel);
    rest[0] = edge.offset_px - ((pixel[0] - before_px.x()) * edge.normal.x() +
                                (pixel[1] - before_px.y()) * edge.normal.y());
    return true;
  }
};

using EdgeCostFunction = ceres::AutoDiffCostFunction<EdgeCost, 1, kCauseParameters>;

class CauseSearch {
 public:
  CauseSearch(std::span<const SpaceEdge> edges,
              const PinholeIntrinsics& camera,
              const Vector3d& middle_mm,
              bool is_lens_known)
      : edges_(edges),
        camera_(camera),
        middle_mm_(middle_mm),
        parameters_(is_lens_known ? index_of(CauseParameter::kFocalLength) : kCauseParameters) {
    linearise();
    leave_out_outliers();
  }

  CauseFit find() {
    CauseFit fit;
    fit.noise_px = noise_px_;
    fit.before_px = std::sqrt(right_squares_ / static_cast<double>(kept_));
    const std::vector<std::size_t> chosen = best_set();
    fit.after_px = std::sqrt(rest_of(chosen) / static_cast<double>(kept_));
    if (chosen.empty()) {
      return fit;
    }
    const VectorXd sigmas = fit_exactly(chosen, fit.changes);
    const std::vector<double> shares = shares_of(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const auto parameter = static_cast<CauseParameter>(chosen[i]);
      fit.causes.push_back({.parameter = parameter,
                            .value = fit.changes[chosen[i]],
                            .sigma = sigmas[static_cast<Eigen::Index>(i)],
                            .share = shares[i],
                            .not_separable = partners_of(chosen, chosen[i])});
    }
    add_doubt(chosen, fit.causes);
    std::ranges::stable_sort(fit.causes, std::greater<>(), &FoundCause::share);
    return fit;
  }

 private:
  EdgeCost cost_of(const SpaceEdge& edge) const {
    const CauseVector none = {};
    return {.camera = camera_,
            .middle_mm = middle_mm_,
            .edge = edge,
            .before_px = changed_pixel(camera_, middle_mm_, none, edge.in_camera_mm)};
  }

  /// How offsets grow with each parameter, at no change.
  void linearise() {
    const auto rows = static_cast<Eigen::Index>(edges_.size());
    columns_.resize(rows, kCauseParameters);
    offsets_.resize(rows);
    const CauseVector none = {};
    const double* parameters[] = {none.data()};
    for (Eigen::Index i = 0; i < rows; ++i) {
      const SpaceEdge& edge = edges_[static_cast<std::size_t>(i)];
      const EdgeCostFunction cost(new EdgeCost(cost_of(edge)));
      double rest = 0.0;
      std::array<double, kCauseParameters> slope = {};
      double* slopes[] = {slope.data()};
      cost.Evaluate(parameters, &rest, slopes);
      offsets_[i] = edge.offset_px;
      for (std::size_t k = 0; k < kCauseParameters; ++k) {
        columns_(i, static_cast<Eigen::Index>(k)) = -slope[k];
      }
    }
    // Every column counts alike: parameters differ by many orders of magnitude.
    scales_ = columns_.colwise().norm().transpose().cwiseMax(1e-12);
    columns_.array().rowwise() /= scales_.transpose().array();
  }

  /// What all parameters together leave.
  VectorXd rest_of_all(const VectorXd& weights) const {
    const MatrixXd columns = columns_.leftCols(static_cast<Eigen::Index>(parameters_));
    const MatrixXd weighted = weights.asDiagonal() * columns;
    MatrixXd normal = weighted.transpose() * columns;
    normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff();
    return offsets_ - columns * normal.ldlt().solve(weighted.transpose() * offsets_);
  }

  void leave_out_outliers() {
    weights_ = VectorXd::Ones(offsets_.size());
    for (int pass = 0; pass < 4; ++pass) {
      const VectorXd rest = rest_of_all(weights_);
      std::vector<double> sizes;
      for (Eigen::Index i = 0; i < rest.size(); ++i) {
        sizes.push_back(std::abs(rest[i]));
      }
      const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
      std::nth_element(sizes.begin(), middle, sizes.end());
      noise_px_ = std::max(1.4826 * *middle, 1e-6);
      for (Eigen::Index i = 0; i < rest.size(); ++i) {
        weights_[i] = std::abs(rest[i]) <= kOutlierSigmas * noise_px_ ? 1.0 : 0.0;
      }
    }
    kept_ = static_cast<std::size_t>(weights_.sum());
    const MatrixXd weighted = weights_.asDiagonal() * columns_;
    normal_ = weighted.transpose() * columns_;
    right_ = weighted.transpose() * offsets_;
    right_squares_ = offsets_.dot(weights_.cwiseProduct(offsets_));
    alike_ = alike_neighbours(rest_of_all(weights_).cwiseProduct(weights_));
  }

  /// How many neighbours tell what one would: 1 + 2 sum of the autocorrelations, at least 1.
  static double alike_neighbours(const VectorXd& rest) {
    const double square = rest.squaredNorm();
    double sum = 1.0;
    for (int lag = 1; lag <= kMaxLag && square > 0.0; ++lag) {
      const Eigen::Index count = rest.size() - lag;
      const double correlation = rest.head(count).dot(rest.tail(count)) / square;
      if (correlation < 0.05) {
        break;
      }
      sum += 2.0 * correlation;
    }
    return sum;
  }

  /// Sum of squares that the best values of these parameters leave.
  double rest_of(std::span<const std::size_t> chosen) const {
    if (chosen.empty()) {
      return right_squares_;
    }
    const auto [normal, right] = part_of(chosen);
    return std::max(right_squares_ - right.dot(normal.ldlt().solve(right)), 0.0);
  }

  std::pair<MatrixXd, VectorXd> part_of(std::span<const std::size_t> chosen) const {
    const auto count = static_cast<Eigen::Index>(chosen.size());
    MatrixXd normal(count, count);
    VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto row = static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(i)]);
      right[i] = right_[row];
      for (Eigen::Index j = 0; j < count; ++j) {
        normal(i, j) = normal_(row, static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(j)]));
      }
    }
    normal.diagonal().array() += 1e-10;
    return {normal, right};
  }

  std::vector<std::size_t> best_set() const {
    const double price =
        std::max(kPrice * alike_ * noise_px_ * noise_px_, kLeastShare * right_squares_);
    std::vector<std::size_t> best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (unsigned set = 0; set < (1U << parameters_); ++set) {
      std::vector<std::size_t> chosen;
      for (std::size_t k = 0; k < kCauseParameters; ++k) {
        if ((set >> k & 1U) != 0) {
          chosen.push_back(k);
        }
      }
      const double cost = rest_of(chosen) + price * static_cast<double>(chosen.size());
      if (cost < best_cost) {
        best_cost = cost;
        best = chosen;
      }
    }
    return best;
  }

  /// Fits the chosen parameters with the exact projection. @returns their standard deviations
  VectorXd fit_exactly(const std::vector<std::size_t>& chosen, CauseVector& changes) const {
    ceres::Problem problem;
    const double scale = 2.0 * noise_px_;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (weights_[static_cast<Eigen::Index>(i)] > 0.0) {
        problem.AddResidualBlock(new EdgeCostFunction(new EdgeCost(cost_of(edges_[i]))),
                                 new ceres::HuberLoss(scale),
                                 changes.data());
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
    // Covariance of the linear fit: sigma^2 times the number of alike neighbours.
    const auto [normal, right] = part_of(chosen);
    const MatrixXd covariance = normal.inverse() * (alike_ * noise_px_ * noise_px_);
    VectorXd sigmas(static_cast<Eigen::Index>(chosen.size()));
    for (Eigen::Index i = 0; i < sigmas.size(); ++i) {
      const double own = scales_[static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(i)])];
      sigmas[i] = std::sqrt(std::max(covariance(i, i), 0.0)) / own;
    }
    return sigmas;
  }

  /// Values of the linear fit, in inner units.
  VectorXd values_of(std::span<const std::size_t> chosen) const {
    const auto [normal, right] = part_of(chosen);
    VectorXd values = normal.ldlt().solve(right);
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      values[i] /= scales_[static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(i)])];
    }
    return values;
  }

  /// Were it not this cause but one that cannot be told from it, the others would have other
  /// values: a shift of the part also shows another side of it, a shift of the centre does not.
  /// That is part of what is not known of them.
  void add_doubt(const std::vector<std::size_t>& chosen, std::vector<FoundCause>& causes) const {
    const VectorXd values = values_of(chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      VectorXd most = VectorXd::Zero(values.size());
      for (const CauseParameter partner : causes[i].not_separable) {
        std::vector<std::size_t> swapped = chosen;
        swapped[i] = index_of(partner);
        if (std::ranges::count(chosen, swapped[i]) == 0) {
          most = most.cwiseMax((values_of(swapped) - values).cwiseAbs());
        }
      }
      for (std::size_t other = 0; other < chosen.size(); ++other) {
        if (other != i) {
          causes[other].sigma =
              std::hypot(causes[other].sigma, most[static_cast<Eigen::Index>(other)]);
        }
      }
    }
  }

  /// Of the sum of squares: what is lost without a parameter, in proportion.
  std::vector<double> shares_of(const std::vector<std::size_t>& chosen) const {
    const double rest = rest_of(chosen);
    std::vector<double> losses;
    for (const std::size_t one : chosen) {
      std::vector<std::size_t> others = chosen;
      std::erase(others, one);
      losses.push_back(std::max(rest_of(others) - rest, 0.0));
    }
    const double sum = std::accumulate(losses.begin(), losses.end(), 0.0);
    const double explained = right_squares_ > 0.0 ? 1.0 - rest / right_squares_ : 0.0;
    for (double& loss : losses) {
      loss = sum > 0.0 ? explained * loss / sum : 0.0;
    }
    return losses;
  }

  /// Parameters whose columns are the chosen one's but for a factor, the other chosen ones free.
  std::vector<CauseParameter> partners_of(const std::vector<std::size_t>& chosen,
                                          std::size_t one) const {
    std::vector<CauseParameter> partners;
    for (std::size_t other = 0; other < parameters_; ++other) {
      if (other == one) {
        continue;
      }
      std::vector<std::size_t> set = {one, other};
      for (const std::size_t k : chosen) {
        if (k != one && k != other) {
          set.push_back(k);
        }
      }
      const MatrixXd inverse = part_of(set).first.inverse();
      const double correlation = inverse(0, 1) / std::sqrt(inverse(0, 0) * inverse(1, 1));
      if (std::abs(correlation) > kNotSeparable) {
        partners.push_back(static_cast<CauseParameter>(other));
      }
    }
    return partners;
  }

  std::span<const SpaceEdge> edges_;
  const PinholeIntrinsics& camera_;
  const Vector3d& middle_mm_;
  std::size_t parameters_;  ///< that may differ: the first ones
  MatrixXd columns_;
  VectorXd offsets_;
  VectorXd scales_;
  VectorXd weights_;
  MatrixXd normal_;
  VectorXd right_;
  double right_squares_ = 0.0;
  double noise_px_ = 0.0;
  double alike_ = 1.0;
  std::size_t kept_ = 0;
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
  project(camera, middle_mm, changes.data(), point_mm, pixel.data());
  return pixel;
}

CauseFit fit_causes(std::span<const SpaceEdge> edges,
                    const PinholeIntrinsics& camera,
                    const Vector3d& middle_mm,
                    bool is_lens_known) {
  if (edges.size() < kMinEdges) {
    return {};
  }
  return CauseSearch(edges, camera, middle_mm, is_lens_known).find();
}

}  // namespace glint
