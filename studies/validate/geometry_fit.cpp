// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/geometry_fit.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/median.h"
#include "hardware/calibration/lens_vector.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr Index kHandEyeAt = 9;
constexpr Index kPartAt = 15;
constexpr Index kRobotAt = 21;
constexpr std::size_t kMinEdges = 50;
constexpr double kGeometryPrice = 14.0;  ///< 3.7 standard deviations for each number
constexpr double kMinOfMisfit = 0.02;    ///< of the misfit, for each fault
constexpr double kNearlyShare = 0.05;    ///< of the misfit: explanations that are as good
constexpr double kMinNoisePx = 0.03;     ///< how well an edge of a rendered picture is located
constexpr double kEdgeHuber = 2.5;
constexpr std::size_t kMaxLag = 60;

Matrix3d cross_of(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

struct Block {
  Index first;
  Index size;
};

/// Focal length: fx, fy; centre: cx, cy; distortion: k1 .. p2.
constexpr std::array<Block, kGeometryFaults> kBlocks = {
    {{0, 2}, {2, 2}, {4, 5}, {kHandEyeAt, 6}, {kPartAt, 6}}};

/// Least change that a block may freely make, in the units of its numbers.
constexpr std::array<double, kGeometryFaults> kFreeStep = {100.0, 100.0, 0.3, 5.0, 5.0};

class Fitter {
 public:
  Fitter(std::span<const ViewEdges> views,
         const PinholeIntrinsics& camera,
         const GeometryBudget& budget)
      : views_(views), lens_(lens_vector(camera)), budget_(budget) {
    fill();
  }

  GeometryFit find() {
    GeometryFit fit;
    fit.is_known = static_cast<std::size_t>(offsets_.size()) >= kMinEdges;
    if (!fit.is_known) {
      return fit;
    }
    weigh();
    choose(fit);
    prefer_simple(fit);
    tell(fit);
    return fit;
  }

 private:
  /// Motions of pixels along the edges' normals by all numbers.
  void fill() {
    std::size_t count = 0;
    for (const ViewEdges& view : views_) {
      count += view.edges.size();
    }
    const auto size = static_cast<Index>(count);
    columns_ = MatrixXd::Zero(size, kRobotAt + 6 * static_cast<Index>(views_.size()));
    offsets_ = VectorXd::Zero(size);
    Index row = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      for (const SpaceEdge& edge : views_[v].edges) {
        row += fill_row(v, edge, row) ? 1 : 0;
      }
    }
    columns_.conservativeResize(row, Eigen::NoChange);
    offsets_.conservativeResize(row);
  }

  bool fill_row(std::size_t v, const SpaceEdge& edge, Index row) {
    LensDerivatives by;
    const Vector3d& at = edge.in_camera_mm;
    if (!project_by_lens(lens_, at, &by)) {
      return false;
    }
    const RigidTransform& pose = views_[v].camera_from_scene;
    const Eigen::RowVector2d normal = edge.normal.transpose();
    const Eigen::RowVector3d by_point = normal * by.by_point;
    columns_.block<1, 9>(row, 0) = normal * by.by_lens;
    // The camera moves by a small motion in its frame: the point moves against it.
    const Eigen::RowVector3d by_turn = by_point * cross_of(at);
    columns_.block<1, 3>(row, kHandEyeAt) = by_turn;
    columns_.block<1, 3>(row, kHandEyeAt + 3) = -by_point;
    const Index robot = kRobotAt + 6 * static_cast<Index>(v);
    columns_.block<1, 3>(row, robot) = by_turn;
    columns_.block<1, 3>(row, robot + 3) = -by_point;
    const Vector3d arm = at - pose * budget_.middle_mm;
    columns_.block<1, 3>(row, kPartAt) = -by_point * cross_of(arm) * pose.rotation;
    columns_.block<1, 3>(row, kPartAt + 3) = by_point * pose.rotation;
    offsets_[row] = edge.offset_px;
    return true;
  }

  /// Covariance of all numbers with some faults freed.
  MatrixXd prior(unsigned faults) const {
    MatrixXd covariance = MatrixXd::Zero(columns_.cols(), columns_.cols());
    covariance.topLeftCorner<15, 15>() =
        budget_.camera + budget_.unseen * budget_.unseen.transpose();
    covariance.diagonal().segment<6>(kPartAt) = budget_.part_sigma.cwiseAbs2();
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const Index at = kRobotAt + 6 * static_cast<Index>(v);
      covariance.diagonal().segment<3>(at).setConstant(square(views_[v].robot_sigma_rad));
      covariance.diagonal().segment<3>(at + 3).setConstant(square(views_[v].robot_sigma_mm));
    }
    for (Index i = 0; i < covariance.rows(); ++i) {
      covariance(i, i) += 1e-16 + 1e-12 * covariance(i, i);
    }
    for (std::size_t f = 0; f < kGeometryFaults; ++f) {
      if ((faults >> f & 1U) != 0) {
        for (Index k = kBlocks[f].first; k < kBlocks[f].first + kBlocks[f].size; ++k) {
          const bool is_turn = f >= 3 && k - kBlocks[f].first < 3;
          covariance(k, k) += square(is_turn ? 0.2 : kFreeStep[f]);
        }
      }
    }
    return covariance;
  }

  static double square(double value) { return value * value; }

  /// What all solutions with the same weights share.
  void take_weights() {
    const MatrixXd weighted = weights_.asDiagonal() * columns_;
    squares_ = columns_.transpose() * weighted;
    right_ = weighted.transpose() * offsets_;
    offset_squares_ = offsets_.cwiseAbs2().dot(weights_);
  }

  struct Solution {
    VectorXd values;
    MatrixXd covariance;
    double cost = std::numeric_limits<double>::max();
  };

  Solution solve(unsigned faults) const {
    const MatrixXd information =
        prior(faults).ldlt().solve(MatrixXd::Identity(columns_.cols(), columns_.cols()));
    const MatrixXd normal = squares_ + information;
    const Eigen::LDLT<MatrixXd> solver(normal);
    Solution solution;
    solution.values = solver.solve(right_);
    solution.covariance = solver.solve(MatrixXd::Identity(normal.rows(), normal.cols()));
    solution.cost = offset_squares_ - 2.0 * solution.values.dot(right_) +
                    solution.values.dot(normal * solution.values);
    return solution;
  }

  /// Noise and weights from what all faults together leave; edges that they leave far off hardly
  /// count.
  void weigh() {
    weights_ = VectorXd::Ones(offsets_.size());
    VectorXd left = offsets_;
    for (int round = 0; round < 4; ++round) {
      take_weights();
      left = offsets_ - columns_ * solve((1U << kGeometryFaults) - 1U).values;
      std::vector<double> sizes(static_cast<std::size_t>(left.size()));
      for (Index i = 0; i < left.size(); ++i) {
        sizes[static_cast<std::size_t>(i)] = std::abs(left[i]);
      }
      noise_px_ = std::max(1.4826 * median(std::move(sizes)), kMinNoisePx);
      for (Index i = 0; i < left.size(); ++i) {
        const double ratio = std::abs(left[i]) / (kEdgeHuber * noise_px_);
        weights_[i] = (ratio > 1.0 ? 1.0 / square(ratio) : 1.0) / square(noise_px_);
      }
    }
    weights_ /= alike(left);
    take_weights();
  }

  /// How many neighbouring edges tell what one would.
  double alike(const VectorXd& left) const {
    const double squares = std::max(left.squaredNorm(), 1e-12);
    double sum = 1.0;
    for (std::size_t lag = 1; lag < kMaxLag && lag < static_cast<std::size_t>(left.size()); ++lag) {
      const auto shift = static_cast<Index>(lag);
      const double rho =
          left.head(left.size() - shift).dot(left.tail(left.size() - shift)) / squares;
      if (rho < 0.05) {
        break;
      }
      sum += 2.0 * rho;
    }
    return sum;
  }

  void choose(GeometryFit& fit) {
    std::array<double, 1U << kGeometryFaults> prices = {};
    const double whole = solve(0).cost;
    double best = std::numeric_limits<double>::max();
    unsigned chosen = 0;
    for (unsigned faults = 0; faults < prices.size(); ++faults) {
      const Solution solution = solve(faults);
      double price = solution.cost;
      for (std::size_t f = 0; f < kGeometryFaults; ++f) {
        if ((faults >> f & 1U) != 0) {
          price +=
              std::max(kGeometryPrice * static_cast<double>(kBlocks[f].size), kMinOfMisfit * whole);
        }
      }
      prices[faults] = price;
      if (price < best) {
        best = price;
        chosen = faults;
        solution_ = solution;
      }
    }
    for (std::size_t f = 0; f < kGeometryFaults; ++f) {
      if ((chosen >> f & 1U) != 0) {
        fit.faults.push_back(static_cast<GeometryFault>(f));
      } else if (std::bitset<kGeometryFaults>(chosen).count() == 1 &&
                 prices[1U << f] < best + kNearlyShare * (whole - best)) {
        fit.or_these.push_back(static_cast<GeometryFault>(f));
      }
    }
  }

  /// Of explanations that are nearly as good the one with the fewest numbers is told first.
  void prefer_simple(GeometryFit& fit) {
    if (fit.faults.size() != 1 || fit.or_these.empty()) {
      return;
    }
    const auto size_of = [](GeometryFault fault) {
      return kBlocks[static_cast<std::size_t>(fault)].size;
    };
    const auto simplest = std::ranges::min_element(fit.or_these, {}, size_of);
    if (size_of(*simplest) < size_of(fit.faults[0])) {
      std::swap(*simplest, fit.faults[0]);
      solution_ = solve(1U << static_cast<unsigned>(fit.faults[0]));
    }
  }

  /// How GeometryFit::covariance's numbers follow from all: where the part moves, the camera moves
  /// the other way against it.
  MatrixXd seen_motions() const {
    const auto count = static_cast<Index>(views_.size());
    MatrixXd by = MatrixXd::Zero(9 + 6 * count, columns_.cols());
    by.topLeftCorner<9, 9>().setIdentity();
    for (Index v = 0; v < count; ++v) {
      const Index row = 9 + 6 * v;
      by.block<6, 6>(row, kHandEyeAt).setIdentity();
      by.block<6, 6>(row, kRobotAt + 6 * v).setIdentity();
      const RigidTransform& pose = views_[static_cast<std::size_t>(v)].camera_from_scene;
      by.block<3, 3>(row, kPartAt) = -pose.rotation;
      by.block<3, 3>(row + 3, kPartAt) = -cross_of(pose * budget_.middle_mm) * pose.rotation;
      by.block<3, 3>(row + 3, kPartAt + 3) = -pose.rotation;
    }
    return by;
  }

  double rms(const VectorXd& values) const {
    return std::sqrt(values.squaredNorm() / static_cast<double>(std::max<Index>(1, values.size())));
  }

  /// Root mean square over the edges of what a covariance of some numbers predicts.
  double spread_px(const MatrixXd& columns, const MatrixXd& covariance) const {
    const double sum = (columns * covariance).cwiseProduct(columns).sum();
    return std::sqrt(std::max(0.0, sum / static_cast<double>(columns.rows())));
  }

  void tell(GeometryFit& fit) const {
    const VectorXd& values = solution_.values;
    fit.lens = values.head<9>();
    fit.hand_eye = values.segment<6>(kHandEyeAt);
    fit.part = values.segment<6>(kPartAt);
    fit.sigma = solution_.covariance.diagonal().head<kRobotAt>().cwiseMax(0.0).cwiseSqrt();
    for (std::size_t v = 0; v < views_.size(); ++v) {
      fit.robot.emplace_back(values.segment<6>(kRobotAt + 6 * static_cast<Index>(v)));
    }
    const Index others = columns_.cols() - 9;
    const VectorXd lens = columns_.leftCols<9>() * values.head<9>();
    const VectorXd pose = columns_.rightCols(others) * values.tail(others);
    fit.before_px = rms(offsets_);
    fit.after_px = rms(offsets_ - lens - pose);
    fit.lens_px = rms(lens);
    fit.pose_px = rms(pose);
    fit.noise_px = noise_px_;
    const MatrixXd motions = seen_motions();
    fit.covariance = motions * solution_.covariance * motions.transpose();
    MatrixXd budget = prior(0);
    budget.topLeftCorner<15, 15>() -= budget_.unseen * budget_.unseen.transpose();
    fit.lens_budget_px = spread_px(columns_.leftCols<9>(), budget.topLeftCorner<9, 9>());
    fit.pose_budget_px =
        spread_px(columns_.rightCols(others), budget.bottomRightCorner(others, others));
  }

  std::span<const ViewEdges> views_;
  LensVector lens_;
  const GeometryBudget& budget_;
  MatrixXd columns_;
  VectorXd offsets_;
  VectorXd weights_;
  MatrixXd squares_;
  VectorXd right_;
  double offset_squares_ = 0.0;
  Solution solution_;
  double noise_px_ = kMinNoisePx;
};

}  // namespace

std::string name_of(GeometryFault fault) {
  constexpr std::array<const char*, kGeometryFaults> kNames = {
      "focal_length", "centre", "distortion", "hand_eye", "part_pose"};
  return kNames[static_cast<std::size_t>(fault)];
}

GeometryFit fit_geometry(std::span<const ViewEdges> views,
                         const PinholeIntrinsics& camera,
                         const GeometryBudget& budget) {
  return Fitter(views, camera, budget).find();
}

RigidTransform moved_by(const Vector6& motion) {
  RigidTransform result;
  const Vector3d turn = motion.head<3>();
  if (turn.norm() > 0.0) {
    result.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  result.translation_mm = motion.tail<3>();
  return result;
}

RigidTransform refitted_view(const GeometryFit& fit,
                             const GeometryBudget& budget,
                             const RigidTransform& camera_from_scene,
                             std::size_t view) {
  RigidTransform part = moved_by(fit.part);
  part.translation_mm += budget.middle_mm - part.rotation * budget.middle_mm;
  Vector6 camera = fit.hand_eye;
  if (view < fit.robot.size()) {
    camera += fit.robot[view];
  }
  return inverse(moved_by(camera)) * camera_from_scene * part;
}

}  // namespace glint
