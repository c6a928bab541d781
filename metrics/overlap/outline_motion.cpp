// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reweighted least squares of offset = normal . (shift + linear (at - middle)).
//
// Noise e of a located edge is in its place along the normal and, with the other sign, in its
// offset. Where one straight side alone tells of a scale across it, that noise is all that differs
// in the scale's column: the fit answers with a scale of -1 and the edges lie well, nothing else
// does. So turn, scale, stretch and shear are fitted only where the edges' lever tells them.
//
// Along one straight side a shift moves no edge. Normals of a side that lies askew to the pixels
// scatter by up to 0.07 rad (rms) all the same, and by these the noise of the offsets would be
// taken for a shift, and a true one come out too small.
#include "metrics/overlap/outline_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/median.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Eigen::MatrixXd;

constexpr std::size_t kMinOffsets = 12;
constexpr int kRounds = 12;
constexpr double kTukey = 4.685;
constexpr double kFaint = 1e-6;      ///< pull to zero of what no edge tells of
constexpr double kNoisePx = 0.1;     ///< of a located edge
constexpr double kMaxBiasPx = 0.05;  ///< by that noise, at the farthest edge
constexpr double kMinLever = 1e-3;   ///< mean square, in extents
/// Mean square of the normals along a direction from which on they tell a shift along it: twice
/// what the scatter of a straight side's normals makes, an arc of 20 degrees.
constexpr double kMinAcross = 0.01;
constexpr double kSurelyAcross = 0.5;  ///< of a normal: no scatter makes it
constexpr double kMinEdgesAcross = 12.0;

/// About what a motion is fitted.
struct Frame {
  Vector2d middle_px;
  double extent_px = 1.0;

  /// Shift, then the columns of the linear part times the extent, so that all are pixels.
  Vector6 row_of(const EdgeOffset& edge) const {
    const Vector2d from = (edge.at_px - middle_px) / extent_px;
    Vector6 row;
    row << edge.normal, edge.normal * from.x(), edge.normal * from.y();
    return row;
  }
};

/// What the normal equations say once these directions have been fitted (Schur complement).
Matrix6 left_by(const MatrixXd& fitted, const Matrix6& normal) {
  const MatrixXd seen = normal * fitted;
  return normal - seen * (fitted.transpose() * seen).ldlt().solve(seen.transpose());
}

/// Shift, turn, scale, and stretch along two axes (shear is stretch along the diagonals), in
/// columns of length 1.
Matrix6 modes_of_motion() {
  constexpr double kHalf = 0.5 * std::numbers::sqrt2;
  Matrix6 modes = Matrix6::Zero();
  modes.topLeftCorner<2, 2>().setIdentity();
  modes.col(2).tail<4>() << 0.0, kHalf, -kHalf, 0.0;
  modes.col(3).tail<4>() << kHalf, 0.0, 0.0, kHalf;
  modes.col(4).tail<4>() << kHalf, 0.0, 0.0, -kHalf;
  modes.col(5).tail<4>() << 0.0, kHalf, kHalf, 0.0;
  return modes;
}

/// Directions of the values, in columns, that edges tell: the shift, and what they tell of each of
/// the others beyond those before it.
/// @param least  mean square of what is told, in pixels of offset to a pixel at the extent
/// @param has_stretch  whether the edges may tell a stretch: parallel sides tell a turn and a scale
MatrixXd told_directions(const Matrix6& normal, double least, bool has_stretch) {
  constexpr std::array<std::array<Eigen::Index, 2>, 3> kGroups = {{{2, 1}, {3, 1}, {4, 2}}};
  const Matrix6 modes = modes_of_motion();
  const double weight = normal.topLeftCorner<2, 2>().trace();
  MatrixXd told = modes.leftCols<2>();
  for (const auto& [first, count] : std::span(kGroups).first(has_stretch ? 3 : 2)) {
    const MatrixXd group = modes.middleCols(first, count);
    const MatrixXd beyond = group.transpose() * left_by(told, normal) * group;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(beyond);
    for (Eigen::Index i = 0; i < count; ++i) {
      if (axes.eigenvalues()(i) >= least * weight) {
        told.conservativeResize(Eigen::NoChange, told.cols() + 1);
        told.rightCols<1>() = group * axes.eigenvectors().col(i);
      }
    }
  }
  return told;
}

/// Sums of a round's least squares.
struct Sums {
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  std::vector<double> weights;  ///< of the edges, in [0, 1]
};

/// Edges weighted by what values leave of their offsets.
Sums weighted_sums(std::span<const EdgeOffset> offsets,
                   const Frame& frame,
                   double min_scale_px,
                   const Vector6& values) {
  std::vector<double> sizes;
  for (const EdgeOffset& edge : offsets) {
    sizes.push_back(std::abs(edge.offset_px - frame.row_of(edge).dot(values)));
  }
  const double reach = kTukey * std::max(1.4826 * median(sizes), min_scale_px);
  Sums sums = {.weights = std::vector<double>(offsets.size())};
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double ratio = sizes[i] / reach;
    if (ratio >= 1.0) {
      continue;
    }
    const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
    sums.weights[i] = weight;
    const Vector6 row = frame.row_of(offsets[i]);
    sums.normal += weight * row * row.transpose();
    sums.right += weight * offsets[i].offset_px * row;
  }
  sums.normal.diagonal().array() += kFaint * std::max(sums.normal.diagonal().maxCoeff(), 1e-12);
  return sums;
}

/// Whether edges run across a direction: by their normals' mean square along it, or a few that do
/// so plainly, like the ends of a thin bar.
bool run_across(const Vector2d& along, std::span<const EdgeOffset> offsets, const Sums& sums) {
  double all = 0.0;
  double squares = 0.0;
  double plainly = 0.0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double share = offsets[i].normal.dot(along);
    all += sums.weights[i];
    squares += sums.weights[i] * share * share;
    plainly += std::abs(share) > kSurelyAcross ? sums.weights[i] : 0.0;
  }
  return squares >= kMinAcross * all || plainly >= kMinEdgesAcross;
}

/// The direction along which edges tell no shift; zero: they tell both.
Vector2d untold_shift(std::span<const EdgeOffset> offsets, const Sums& sums) {
  const Eigen::Matrix2d normals = sums.normal.topLeftCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(normals);
  const Vector2d weakest = axes.eigenvectors().col(0);
  if (run_across(weakest, offsets, sums)) {
    return Vector2d::Zero();
  }
  return weakest.x() < 0.0 ? Vector2d(-weakest) : weakest;
}

/// One round of the robust fit.
/// @param untold  untold_shift()
Vector6 refitted(const Sums& sums, const Frame& frame, const Vector2d& untold, bool is_shift_only) {
  const double least = std::max(kMinLever, kNoisePx * kNoisePx / (kMaxBiasPx * frame.extent_px));
  const bool is_all_told = untold.isZero(0.0);
  MatrixXd told = is_shift_only ? MatrixXd(MatrixXd::Identity(6, 2))
                                : told_directions(sums.normal, least, is_all_told);
  if (!is_all_told) {  // what is beyond the whole shift, and of that the part across
    told.col(1).head<2>() << -untold.y(), untold.x();
    told = MatrixXd(told.rightCols(told.cols() - 1));
  }
  const MatrixXd inner = told.transpose() * sums.normal * told;
  return told * inner.ldlt().solve(told.transpose() * sums.right);
}

}  // namespace

OutlineMotion fit_outline_motion(std::span<const EdgeOffset> offsets,
                                 double min_scale_px,
                                 bool is_shift_only) {
  OutlineMotion motion;
  if (offsets.empty()) {
    return motion;
  }
  for (const EdgeOffset& edge : offsets) {
    motion.middle_px += edge.at_px / static_cast<double>(offsets.size());
  }
  double extent = 1.0;
  for (const EdgeOffset& edge : offsets) {
    extent = std::max(extent, (edge.at_px - motion.middle_px).norm());
  }
  const Frame frame = {.middle_px = motion.middle_px, .extent_px = extent};
  const bool is_shifted_only = is_shift_only || offsets.size() < kMinOffsets;
  Vector6 values = Vector6::Zero();
  for (int round = 0; round < kRounds; ++round) {
    const Sums sums = weighted_sums(offsets, frame, min_scale_px, values);
    motion.untold = untold_shift(offsets, sums);
    values = refitted(sums, frame, motion.untold, is_shifted_only);
  }
  motion.shift_px = values.head<2>();
  motion.linear.col(0) = values.segment<2>(2) / extent;
  motion.linear.col(1) = values.segment<2>(4) / extent;
  return motion;
}

std::vector<Boundary> moved_outlines(std::vector<Boundary> outlines, const OutlineMotion& motion) {
  for (Boundary& outline : outlines) {
    for (BoundaryPoint& point : outline.points) {
      point.at_px = motion.moved(point.at_px);
    }
  }
  return outlines;
}

}  // namespace glint
