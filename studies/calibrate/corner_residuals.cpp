// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/corner_residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "hardware/upkeep/pixel_error.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Residuals = std::vector<std::vector<Vector2d>>;

constexpr int kRings = 5;

/// The joint solution as it is written; nullptr when a closed form, or no pose, was asked for.
const HandEyeCalibration* joint_of(const CalibrateInput& input, const SolvedCalibration& solved) {
  return solved.joint && !input.method ? &*solved.joint : nullptr;
}

/// Of one picture of the joint solution.
std::vector<Vector2d> joint_residuals(const Bundle& bundle, const BundleView& view) {
  ViewSystem system;
  std::vector<Vector2d> residuals;
  if (!evaluate_view(bundle, view, bundle.lens, {.error = view.error}, false, system)) {
    return residuals;
  }
  for (Eigen::Index i = 0; i + 1 < system.residual_px.size(); i += 2) {
    residuals.emplace_back(-system.residual_px.segment<2>(i));
  }
  return residuals;
}

/// Of one picture with a pose of its own.
std::vector<Vector2d> free_residuals(const CameraCalibration& camera,
                                     const CalibratedPicture& picture,
                                     const BoardCorners& corners) {
  std::vector<Vector2d> residuals;
  for (std::size_t i = 0; i < corners.board_mm.size() && std::isfinite(picture.rms_px); ++i) {
    const auto pixel =
        project_by_lens(camera.lens, picture.camera_from_board * corners.board_mm[i], nullptr);
    if (!pixel) {
      return {};
    }
    residuals.emplace_back(corners.picture_px[i] - *pixel);
  }
  return residuals;
}

/// Calls visit(pixel, residual) for every corner of the pictures used.
template <class Visit>
void for_each_residual(const CalibrateInput& input,
                       const SolvedCalibration& solved,
                       const Residuals& residuals_px,
                       const Visit& visit) {
  for (std::size_t i = 0; i < residuals_px.size(); ++i) {
    for (std::size_t k = 0; is_used(solved, i) && k < residuals_px[i].size(); ++k) {
      visit(input.corners[i].picture_px[k], residuals_px[i][k]);
    }
  }
}

/// Pixels of a ring that lie in the picture, from eight to the four corners alone.
std::vector<Vector2d> pixels_between(const Vector2d& size_px, double from_px, double to_px) {
  constexpr int kDirections = 48;
  std::vector<Vector2d> pixels;
  for (int step = 0; step < 3; ++step) {
    const double radius = from_px + (to_px - from_px) * (0.5 + step) / 3.0;
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / kDirections;
      const Vector2d pixel = 0.5 * size_px + radius * Vector2d(std::cos(angle), std::sin(angle));
      if ((pixel.array() >= 0.0).all() && (pixel.array() <= size_px.array()).all()) {
        pixels.push_back(pixel);
      }
    }
  }
  return pixels;
}

double rms_of(const std::vector<double>& values) {
  double square = 0.0;
  for (const double value : values) {
    square += value * value;
  }
  return values.empty() ? std::numeric_limits<double>::infinity()
                        : std::sqrt(square / static_cast<double>(values.size()));
}

std::vector<double> errors_px(const CalibrateInput& input,
                              const SolvedCalibration& solved,
                              const std::vector<Vector2d>& pixels_px) {
  const Eigen::Vector2i size(input.width_px, input.height_px);
  if (const HandEyeCalibration* joint = joint_of(input, solved)) {
    return point_errors_px(joint->bundle, joint->covariance, size, pixels_px);
  }
  return ray_errors_px(solved.camera.lens, solved.camera.covariance, size, pixels_px);
}

}  // namespace

bool is_used(const SolvedCalibration& solved, std::size_t picture) {
  return solved.joint ? solved.joint->pictures[picture].accepted
                      : solved.camera.pictures[picture].accepted;
}

Residuals corner_residuals_px(const CalibrateInput& input, const SolvedCalibration& solved) {
  const HandEyeCalibration* joint = joint_of(input, solved);
  Residuals residuals;
  std::size_t view = 0;
  for (std::size_t i = 0; i < input.corners.size(); ++i) {
    const bool is_joint = joint != nullptr && is_used(solved, i);
    residuals.push_back(
        is_joint ? joint_residuals(joint->bundle, joint->bundle.views[view])
                 : free_residuals(solved.camera, solved.camera.pictures[i], input.corners[i]));
    view += is_joint ? 1U : 0U;
    GLINT_CHECK(residuals[i].empty() || residuals[i].size() == input.corners[i].picture_px.size(),
                "a residual for each corner");
  }
  return residuals;
}

ResidualMap residual_map(const CalibrateInput& input,
                         const SolvedCalibration& solved,
                         const Residuals& residuals_px) {
  // Squares, about twelve along the longer side.
  const double side = std::max(input.width_px, input.height_px) / 12.0;
  ResidualMap map{.cols = std::max(1, static_cast<int>(std::lround(input.width_px / side))),
                  .rows = std::max(1, static_cast<int>(std::lround(input.height_px / side)))};
  map.cells.resize(static_cast<std::size_t>(map.cols) * static_cast<std::size_t>(map.rows));
  const auto place = [](double at_px, int size_px, int count) {
    return std::clamp(static_cast<int>(at_px * count / size_px), 0, count - 1);
  };
  for_each_residual(input, solved, residuals_px, [&](const Vector2d& at, const Vector2d& residual) {
    const int cell = place(at.y(), input.height_px, map.rows) * map.cols +
                     place(at.x(), input.width_px, map.cols);
    ResidualCell& sum = map.cells[static_cast<std::size_t>(cell)];
    ++sum.corners;
    sum.mean_px += residual;
    sum.rms_px += residual.squaredNorm();
  });
  for (ResidualCell& cell : map.cells) {
    const double count = std::max(1, cell.corners);
    cell.mean_px /= count;
    cell.rms_px = std::sqrt(cell.rms_px / count);
  }
  return map;
}

std::vector<ErrorRing> error_rings(const CalibrateInput& input,
                                   const SolvedCalibration& solved,
                                   const Residuals& residuals_px) {
  const Vector2d size(input.width_px, input.height_px);
  const double width_px = 0.5 * size.norm() / kRings;
  std::vector<ErrorRing> rings;
  for (int i = 0; i < kRings; ++i) {
    ErrorRing ring{.from_px = i * width_px, .to_px = (i + 1) * width_px};
    ring.error_px =
        rms_of(errors_px(input, solved, pixels_between(size, ring.from_px, ring.to_px)));
    rings.push_back(ring);
  }
  for_each_residual(input, solved, residuals_px, [&](const Vector2d& at, const Vector2d& residual) {
    const double radius = (at - 0.5 * size).norm();
    ErrorRing& ring = rings[static_cast<std::size_t>(
        std::clamp(static_cast<int>(radius / width_px), 0, kRings - 1))];
    ++ring.corners;
    ring.rms_px += residual.squaredNorm();
  });
  for (ErrorRing& ring : rings) {
    ring.rms_px = std::sqrt(ring.rms_px / std::max(1, ring.corners));
  }
  return rings;
}

}  // namespace glint
