// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board_plane.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace glint {
namespace {

using Vector10 = Eigen::Matrix<double, 10, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;

constexpr std::size_t kMin = 4;
const Eigen::Array2d usual_radial = {0.15, 0.05};

/// Takes points to a mean of 0 and a mean distance of sqrt(2).
Eigen::Matrix3d normalising(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : points) {
    mean += point;
  }
  mean /= static_cast<double>(points.size());
  double distance = 0.0;
  for (const Eigen::Vector2d& point : points) {
    distance += (point - mean).norm();
  }
  const double scale = std::sqrt(2.0) * static_cast<double>(points.size()) / distance;
  Eigen::Matrix3d result;
  result << scale, 0.0, -scale * mean.x(), 0.0, scale, -scale * mean.y(), 0.0, 0.0, 1.0;
  return result;
}

/// Source: R. Hartley, A. Zisserman, "Multiple view geometry", algorithm 4.2.
Eigen::Matrix3d linear_homography(std::span<const Eigen::Vector2d> from,
                                  std::span<const Eigen::Vector2d> to) {
  const Eigen::Matrix3d from_unit = normalising(from);
  const Eigen::Matrix3d to_unit = normalising(to);
  Eigen::Matrix<double, 9, 9> sums = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d a = from_unit * from[i].homogeneous();
    const Eigen::Vector3d b = to_unit * to[i].homogeneous();
    Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
    rows.block<1, 3>(0, 0) = a.transpose();
    rows.block<1, 3>(0, 6) = -b.x() * a.transpose();
    rows.block<1, 3>(1, 3) = a.transpose();
    rows.block<1, 3>(1, 6) = -b.y() * a.transpose();
    sums += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(sums);
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d unit;
  unit << h.head<3>().transpose(), h.segment<3>(3).transpose(), h.tail<3>().transpose();
  return to_unit.inverse() * unit * from_unit;
}

Eigen::Vector2d projected(const Vector10& u,
                          const Eigen::Vector2d& p,
                          Eigen::Matrix<double, 2, 10>* by) {
  const double w = u[6] * p.x() + u[7] * p.y() + 1.0;
  const Eigen::Vector2d q((u[0] * p.x() + u[1] * p.y() + u[2]) / w,
                          (u[3] * p.x() + u[4] * p.y() + u[5]) / w);
  const double r2 = q.squaredNorm();
  const double factor = 1.0 + r2 * (u[8] + u[9] * r2);
  if (by != nullptr) {
    Eigen::Matrix<double, 2, 8> q_by = Eigen::Matrix<double, 2, 8>::Zero();
    const Eigen::RowVector3d row(p.x() / w, p.y() / w, 1.0 / w);
    q_by.block<1, 3>(0, 0) = row;
    q_by.block<1, 3>(1, 3) = row;
    q_by.col(6) = -q * p.x() / w;
    q_by.col(7) = -q * p.y() / w;
    const Eigen::Matrix2d bend =
        factor * Eigen::Matrix2d::Identity() + (2.0 * u[8] + 4.0 * u[9] * r2) * q * q.transpose();
    by->leftCols<8>() = bend * q_by;
    by->col(8) = q * r2;
    by->col(9) = q * r2 * r2;
  }
  return factor * q;
}

/// The unknowns of a homography, which bends no line.
Vector10 unknowns_of(const Eigen::Matrix3d& linear) {
  Vector10 u = Vector10::Zero();
  u.head<3>() = linear.row(0).transpose() / linear(2, 2);
  u.segment<3>(3) = linear.row(1).transpose() / linear(2, 2);
  u.segment<2>(6) = linear.row(2).head<2>().transpose() / linear(2, 2);
  return u;
}

/// One Gauss-Newton step. @param pull  weight that draws the radial terms to 0
void refine(std::span<const Eigen::Vector2d> board,
            std::span<const Eigen::Vector2d> targets,
            const Eigen::Array2d& pull,
            Vector10& u) {
  Matrix10 normal = Matrix10::Zero();
  Vector10 right = Vector10::Zero();
  Eigen::Matrix<double, 2, 10> by;
  for (std::size_t i = 0; i < board.size(); ++i) {
    const Eigen::Vector2d left = targets[i] - projected(u, board[i], &by);
    normal += by.transpose() * by;
    right += by.transpose() * left;
  }
  normal.diagonal().tail<2>().array() += pull;
  right.tail<2>().array() -= pull * u.tail<2>().array();
  u += normal.ldlt().solve(right);
}

double root_mean_square_px(const BoardPlane& plane,
                           std::span<const Eigen::Vector2d> board,
                           std::span<const Eigen::Vector2d> picture_px) {
  double squares = 0.0;
  for (std::size_t i = 0; i < board.size(); ++i) {
    squares += (plane(board[i]) - picture_px[i]).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(board.size()));
}

}  // namespace

std::optional<BoardPlane> BoardPlane::fitted(std::span<const Eigen::Vector2d> board,
                                             std::span<const Eigen::Vector2d> picture_px,
                                             const Eigen::Vector2d& picture_size_px,
                                             double accuracy_px) {
  if (board.size() < kMin) {
    return std::nullopt;
  }
  BoardPlane plane;
  plane.center_px_ = 0.5 * picture_size_px;
  plane.size_px_ = 0.5 * picture_size_px.norm();
  std::vector<Eigen::Vector2d> targets;
  for (const Eigen::Vector2d& point : picture_px) {
    targets.emplace_back((point - plane.center_px_) / plane.size_px_);
  }
  const Eigen::Matrix3d linear = linear_homography(board, targets);
  if (!linear.allFinite() || std::abs(linear(2, 2)) < 1e-12 * linear.norm()) {
    return std::nullopt;
  }
  Vector10 u = unknowns_of(linear);
  const double accuracy = accuracy_px / plane.size_px_;
  const Eigen::Array2d pull = (accuracy / usual_radial).square();
  for (int step = 0; step < 8; ++step) {
    refine(board, targets, pull, u);
  }
  if (!u.allFinite()) {
    return std::nullopt;
  }
  plane.homography_ << u[0], u[1], u[2], u[3], u[4], u[5], u[6], u[7], 1.0;
  plane.radial_ = u.tail<2>();
  plane.rms_px_ = root_mean_square_px(plane, board, picture_px);
  return plane;
}

Eigen::Vector2d BoardPlane::operator()(const Eigen::Vector2d& board) const {
  const Eigen::Vector3d h = homography_ * board.homogeneous();
  const Eigen::Vector2d q = h.head<2>() / h.z();
  const double r2 = q.squaredNorm();
  return center_px_ + size_px_ * (1.0 + r2 * (radial_.x() + radial_.y() * r2)) * q;
}

}  // namespace glint
