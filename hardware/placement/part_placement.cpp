// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/placement/part_placement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "hardware/calibration/bundle.h"
#include "hardware/calibration/rotation.h"
#include "hardware/calibration/variance_components.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector15d = Eigen::Matrix<double, 15, 1>;

Vector3d mean_of(std::span<const Vector3d> points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) {
    mean += point / static_cast<double>(points.size());
  }
  return mean;
}

/// Information of points about the pose's increment, in units of 1 / sigma^2: a point moves by
/// R (t + r x p).
Matrix6d information_of(std::span<const Vector3d> part_mm) {
  Matrix6d information = Matrix6d::Zero();
  for (const Vector3d& point : part_mm) {
    Eigen::Matrix<double, 3, 6> by;
    by << -cross_matrix(point), Matrix3d::Identity();
    information += by.transpose() * by;
  }
  return information;
}

// --- Pictures ------------------------------------------------------------------------------------

/// Rows of one picture: distances and how they move, not weighted.
struct Rows {
  VectorXd residual;
  MatrixXd by_part;    ///< x 6
  MatrixXd by_camera;  ///< x 15
  MatrixXd by_error;   ///< x 6
};

/// The state of a refinement.
struct Refinement {
  const PlacingCamera& camera;
  double sigma_px;
  Bundle bundle;  ///< the part as its board; one view a picture
  std::vector<std::span<const Eigen::Vector2d>> normals;
  std::vector<VectorXd> weights;  ///< of each picture's rows
  MatrixXd root;                  ///< covariance of the camera = root root'
  VectorXd moved;                 ///< the camera, in units of root's columns
};

/// Takes of each point's two rows the part along its normal.
MatrixXd along(std::span<const Eigen::Vector2d> normals, const MatrixXd& rows) {
  if (normals.empty()) {
    return rows;
  }
  MatrixXd result(rows.rows() / 2, rows.cols());
  for (Index i = 0; i < result.rows(); ++i) {
    const Eigen::Vector2d& normal = normals[static_cast<std::size_t>(i)];
    result.row(i) = normal.x() * rows.row(2 * i) + normal.y() * rows.row(2 * i + 1);
  }
  return result;
}

std::optional<Rows> rows_of(const Refinement& work, std::size_t i) {
  const Vector15d camera = work.root * work.moved;
  const LensVector lens = work.camera.lens + camera.head<9>();
  ViewSystem system;
  if (!evaluate_view(
          work.bundle, work.bundle.views[i], lens, {.hand_eye = camera.tail<6>()}, true, system)) {
    return std::nullopt;
  }
  MatrixXd by_camera(system.residual_px.size(), 15);
  by_camera << system.by_lens, system.by_hand_eye;
  return Rows{.residual = along(work.normals[i], system.residual_px),
              .by_part = along(work.normals[i], system.by_board),
              .by_camera = along(work.normals[i], by_camera),
              .by_error = along(work.normals[i], system.by_error)};
}

/// Rows in units of their noise, the robot's error integrated out of the information.
struct Whitened {
  MatrixXd information;  ///< of part and camera
  VectorXd gradient;
  VectorXd clean;  ///< residual without the most likely error of the robot
};

Whitened whitened(const Refinement& work, const Rows& rows, const VectorXd& weights) {
  const VectorXd roots = weights.cwiseSqrt() / work.sigma_px;
  Vector6d robot;
  robot << Vector3d::Constant(work.camera.robot_rad), Vector3d::Constant(work.camera.robot_mm);
  MatrixXd by(rows.residual.size(), 6 + work.root.cols());
  by << rows.by_part, rows.by_camera * work.root;
  by = roots.asDiagonal() * by;
  const VectorXd residual = roots.cwiseProduct(rows.residual);
  // (I + A A')^-1 = I - A (I + A'A)^-1 A'.
  const MatrixXd a = roots.asDiagonal() * rows.by_error * robot.asDiagonal();
  const Eigen::LLT<MatrixXd> inner(Matrix6d::Identity() + a.transpose() * a);
  const MatrixXd solved = by - a * inner.solve(a.transpose() * by);
  const VectorXd error = robot.cwiseProduct(inner.solve(a.transpose() * residual));
  return {.information = by.transpose() * solved,
          .gradient = solved.transpose() * residual,
          .clean = rows.residual - rows.by_error * error};
}

/// Limits single wrong points to three sigma.
void weigh(Refinement& work, std::size_t i, const VectorXd& clean) {
  const Index together = work.normals[i].empty() ? 2 : 1;
  for (Index row = 0; row < clean.size(); row += together) {
    const double away = clean.segment(row, together).norm();
    const double ratio = 3.0 * work.sigma_px / std::max(away, 1e-12);
    work.weights[i].segment(row, together).setConstant(std::min(1.0, ratio * ratio));
  }
}

struct Normal {
  MatrixXd information;
  VectorXd gradient;
  double square_px2 = 0.0;  ///< of the clean residuals
  double count = 0.0;       ///< points
};

std::optional<Normal> normal_equations(Refinement& work, bool weighs) {
  const Index size = 6 + work.root.cols();
  Normal sum{.information = MatrixXd::Zero(size, size), .gradient = VectorXd::Zero(size)};
  for (std::size_t i = 0; i < work.bundle.views.size(); ++i) {
    const auto rows = rows_of(work, i);
    if (!rows.has_value()) {
      return std::nullopt;
    }
    Whitened one = whitened(work, *rows, work.weights[i]);
    if (weighs) {
      weigh(work, i, one.clean);
      one = whitened(work, *rows, work.weights[i]);
    }
    sum.information += one.information;
    sum.gradient += one.gradient;
    sum.square_px2 += one.clean.squaredNorm();
    sum.count += static_cast<double>(work.bundle.views[i].corners.board_mm.size());
  }
  // The camera is known beforehand: deviation one of each unit.
  sum.information.diagonal().tail(work.root.cols()).array() += 1.0;
  sum.gradient.tail(work.root.cols()) += work.moved;
  return sum;
}

/// Whether the pictures tell all six numbers of the part.
bool is_determined(const MatrixXd& information) {
  const Matrix6d part = information.topLeftCorner<6, 6>();
  const Vector6d scale = part.diagonal().array().max(1e-300).rsqrt();
  const Matrix6d scaled = scale.asDiagonal() * part * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  return part.diagonal().minCoeff() > 0.0 && eigen.eigenvalues().minCoeff() > 1e-9;
}

/// A root of a covariance that may have no spread in some directions.
MatrixXd root_of(const Eigen::Matrix<double, 15, 15>& covariance) {
  const Vector15d scale = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Vector15d back = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 15, 15>> eigen(
      back.asDiagonal() * covariance * back.asDiagonal());
  std::vector<Index> kept;
  for (Index i = 0; i < 15; ++i) {
    if (eigen.eigenvalues()[i] > 1e-12) {
      kept.push_back(i);
    }
  }
  MatrixXd root(15, static_cast<Index>(kept.size()));
  for (Index i = 0; i < root.cols(); ++i) {
    const Index from = kept[static_cast<std::size_t>(i)];
    root.col(i) = std::sqrt(eigen.eigenvalues()[from]) *
                  scale.cwiseProduct(Vector15d(eigen.eigenvectors().col(from)));
  }
  return root;
}

Refinement refinement_of(const PlacingCamera& camera,
                         std::span<const PartPicture> pictures,
                         const Isometry3d& start,
                         double sigma_px) {
  Refinement work{.camera = camera, .sigma_px = sigma_px, .root = root_of(camera.covariance)};
  work.moved = VectorXd::Zero(work.root.cols());
  // A part in the cell is seen as a board in the cell; without a robot between when the camera is
  // in the cell, too.
  work.bundle = {.lens = camera.lens, .poses = {.hand_eye = camera.hand_eye, .board = start}};
  for (const PartPicture& picture : pictures) {
    const bool is_in_hand = camera.mounting == Mounting::kEyeInHand;
    work.bundle.views.push_back(
        {.corners = {.board_mm = picture.part_mm, .picture_px = picture.picture_px},
         .base_from_flange = is_in_hand ? picture.base_from_flange : Isometry3d::Identity()});
    work.normals.emplace_back(picture.normals);
    const auto rows =
        static_cast<Index>(picture.part_mm.size() * (picture.normals.empty() ? 2 : 1));
    work.weights.emplace_back(VectorXd::Ones(rows));
  }
  return work;
}

bool has_matching_sizes(std::span<const PartPicture> pictures) {
  return std::ranges::all_of(pictures, [](const PartPicture& picture) {
    return picture.picture_px.size() == picture.part_mm.size() &&
           (picture.normals.empty() || picture.normals.size() == picture.part_mm.size());
  });
}

double sum_of_squares(const Isometry3d& base_from_part,
                      std::span<const Vector3d> part_mm,
                      std::span<const Vector3d> base_mm) {
  double squares = 0.0;
  for (std::size_t i = 0; i < part_mm.size(); ++i) {
    squares += (base_from_part * part_mm[i] - base_mm[i]).squaredNorm();
  }
  return squares;
}

}  // namespace

std::optional<PlacedPart> place_by_points(std::span<const Vector3d> part_mm,
                                          std::span<const Vector3d> base_mm,
                                          std::optional<double> sigma_mm) {
  const std::size_t count = part_mm.size();
  if (count < 3 || base_mm.size() != count || (!sigma_mm.has_value() && count < 4)) {
    return std::nullopt;
  }
  const Vector3d part_mean = mean_of(part_mm);
  const Vector3d base_mean = mean_of(base_mm);
  Matrix3d products = Matrix3d::Zero();
  Matrix3d spread = Matrix3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d part = part_mm[i] - part_mean;
    products += (base_mm[i] - base_mean) * part.transpose();
    spread += part * part.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(spread);
  if (!products.allFinite() || !(eigen.eigenvalues()[1] > 1e-9 * eigen.eigenvalues()[2])) {
    return std::nullopt;
  }
  PlacedPart placed;
  placed.base_from_part.linear() = nearest_rotation(products);
  placed.base_from_part.translation() = base_mean - placed.base_from_part.linear() * part_mean;
  const double squares = sum_of_squares(placed.base_from_part, part_mm, base_mm);
  placed.rms = std::sqrt(squares / static_cast<double>(count));
  const double variance = sigma_mm.has_value() ? *sigma_mm * *sigma_mm
                                               : squares / (3.0 * static_cast<double>(count) - 6.0);
  placed.covariance = variance * inverse_information(information_of(part_mm));
  return placed;
}

PlacedPart place_by_board(const Isometry3d& base_from_board,
                          const Matrix6d& board_covariance,
                          const Isometry3d& board_from_part,
                          const Matrix6d& offset_covariance) {
  // B motion(d) O = B O motion(A d) to first order.
  const Matrix3d back = board_from_part.linear().transpose();
  Matrix6d moves = Matrix6d::Zero();
  moves.topLeftCorner<3, 3>() = back;
  moves.bottomLeftCorner<3, 3>() = -back * cross_matrix(board_from_part.translation());
  moves.bottomRightCorner<3, 3>() = back;
  return {.base_from_part = base_from_board * board_from_part,
          .covariance = moves * board_covariance * moves.transpose() + offset_covariance};
}

std::optional<PlacedPart> place_by_pictures(const PlacingCamera& camera,
                                            std::span<const PartPicture> pictures,
                                            const Isometry3d& start,
                                            double sigma_px) {
  if (pictures.empty() || !(sigma_px > 0.0) || !has_matching_sizes(pictures)) {
    return std::nullopt;
  }
  PlacingCamera used = camera;
  if (camera.mounting == Mounting::kEyeToHand) {
    used.robot_rad = used.robot_mm = 0.0;
  }
  Refinement work = refinement_of(used, pictures, start, sigma_px);
  constexpr int kMaxSteps = 200;
  constexpr double kStandsSigmas =
      1e-4;  // weights change with each step, so that the last are slow
  for (int step = 0; step < kMaxSteps; ++step) {
    // Weights change the target; they come in when the start's error has gone.
    const auto normal = normal_equations(work, step >= 3);
    if (!normal.has_value() || !is_determined(normal->information)) {
      return std::nullopt;
    }
    const MatrixXd covariance = inverse_information(normal->information);
    const VectorXd move = -covariance * normal->gradient;
    work.bundle.poses.board = work.bundle.poses.board * motion_of(move.head<6>());
    work.moved += move.tail(work.root.cols());
    if (step >= 4 && move.dot(normal->information * move) < kStandsSigmas * kStandsSigmas) {
      return PlacedPart{.base_from_part = work.bundle.poses.board,
                        .covariance = covariance.topLeftCorner<6, 6>(),
                        .rms = std::sqrt(normal->square_px2 / normal->count)};
    }
  }
  return std::nullopt;
}

}  // namespace glint
