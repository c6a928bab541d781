// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/calibration/simulated_cell.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rng.h"
#include "hardware/calibration/joint_fit.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
const Vector3d kMiddle(29.7, 23.1, 0.0);

LensVector cell_lens() {
  const double focal = kCellImageDistanceMm / kCellPixelMm;
  LensVector lens;
  lens << 1.002 * focal, 0.999 * focal, 1240.3, 1009.8, -0.11, 0.16, 0.0, 1.0e-3, -8e-4;
  return lens;
}

Vector3d normal3(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  return {x, y, rng.normal()};
}

HandEye cell_poses(Rng& rng) {
  Vector6d hand_eye;
  hand_eye << Vector3d(2.0, -3.0, 88.0) * kDegree, 4.0, -58.0, 92.0;
  Vector6d board;
  board << 0.2 * normal3(rng), 350.0, -120.0, 40.0;
  return {.hand_eye = motion_of(hand_eye), .board = motion_of(board)};
}

/// A camera pose that looks at the board.
Isometry3d random_view(const CellSettings& s, Rng& rng) {
  const double tilt_x = s.tilt_x_deg * kDegree * rng.uniform(-1.0, 1.0);
  const double tilt_y = s.tilt_y_deg * kDegree * rng.uniform(-1.0, 1.0);
  const double roll = s.roll_deg * kDegree * rng.uniform(-1.0, 1.0);
  const double distance = kCellFocusMm + s.distance_mm * rng.uniform(-1.0, 1.0);
  const double x = s.spread_mm * rng.uniform(-1.0, 1.0);
  const Vector3d target = kMiddle + Vector3d(x, s.spread_mm * rng.uniform(-1.0, 1.0), 0.0);
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() =
      rotation_of(Vector3d(tilt_x, tilt_y, 0.0)) * rotation_of(roll * Vector3d::UnitZ());
  pose.translation() = Vector3d(0.0, 0.0, distance) - pose.linear() * target;
  return pose;
}

/// Exact corners; empty when one is too near to the border.
BoardCorners project_board(const LensVector& lens, const Isometry3d& camera_from_board) {
  BoardCorners corners;
  for (const Vector3d& point : cell_board()) {
    const auto pixel = project_by_lens(lens, camera_from_board * point, nullptr);
    if (!pixel.has_value() || pixel->minCoeff() < 20.0 || pixel->x() > kCellWidth - 20.0 ||
        pixel->y() > kCellHeight - 20.0) {
      return {};
    }
    corners.board_mm.push_back(point);
    corners.picture_px.push_back(*pixel);
  }
  return corners;
}

Isometry3d flange_of(Mounting mounting, const HandEye& poses, const Isometry3d& camera_from_board) {
  return mounting == Mounting::kEyeInHand
             ? poses.board * camera_from_board.inverse() * poses.hand_eye.inverse()
             : poses.hand_eye * camera_from_board * poses.board.inverse();
}

/// Moves the corners of a picture. @return sum of the squared distances
double add_errors(const CornerError& error_at,
                  const Isometry3d& camera_from_board,
                  BoardCorners& corners,
                  Rng& rng) {
  const Vector2d row = corners.picture_px[39] - corners.picture_px[30];  // the fourth of eight
  double squares = 0.0;
  for (std::size_t i = 0; i < corners.board_mm.size(); ++i) {
    const double depth = (camera_from_board * corners.board_mm[i]).z();
    const Vector2d error = error_at(depth, row, rng);
    corners.picture_px[i] += error;
    squares += error.squaredNorm();
  }
  return squares;
}

/// Errors of CellSettings::corner_error, whose size the cell is told.
void add_given_errors(SimulatedCell& cell, Rng& rng) {
  double squares = 0.0;
  std::size_t corners = 0;
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    const Isometry3d seen =
        camera_from_board(cell.settings.mounting, cell.poses, cell.true_base_from_flange[i]);
    squares += add_errors(cell.settings.corner_error, seen, cell.pictures[i], rng);
    corners += cell.pictures[i].board_mm.size();
  }
  cell.settings.noise.corner_px = std::sqrt(squares / (2.0 * static_cast<double>(corners)));
}

void add_noise(SimulatedCell& cell, Rng& rng) {
  const NoiseSizes& noise = cell.settings.noise;
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    Vector6d error;
    error << noise.robot_rad * normal3(rng), noise.robot_mm * normal3(rng);
    cell.base_from_flange.push_back(cell.true_base_from_flange[i] * motion_of(error).inverse());
    if (cell.settings.corner_error) {
      continue;
    }
    for (Vector2d& pixel : cell.pictures[i].picture_px) {
      const double x = noise.corner_px * rng.normal();
      pixel += Vector2d(x, noise.corner_px * rng.normal());
    }
  }
}

/// The same random bend in all corners of a picture.
void add_shared_errors(SimulatedCell& cell, Rng& rng) {
  for (BoardCorners& corners : cell.pictures) {
    Eigen::Matrix<double, 2, 6> factors;
    for (Eigen::Index i = 0; i < 12; ++i) {
      factors(i % 2, i / 2) = cell.settings.shared_px * rng.normal();
    }
    for (std::size_t i = 0; i < corners.board_mm.size(); ++i) {
      const double x = corners.board_mm[i].x() / kMiddle.x() - 1.0;
      const double y = corners.board_mm[i].y() / kMiddle.y() - 1.0;
      corners.picture_px[i] += factors * Vector6d{1.0, x, y, x * x, x * y, y * y};
    }
  }
}

/// Different pictures, never those below `first` nor the last one.
std::vector<std::size_t> draw(double share, std::size_t first, std::size_t size, Rng& rng) {
  std::vector<std::size_t> all;
  for (std::size_t i = first; i + 1 < size; ++i) {
    all.push_back(i);
  }
  const auto count = static_cast<std::size_t>(std::lround(share * static_cast<double>(size)));
  for (std::size_t i = 0; i < count; ++i) {
    const auto left = static_cast<double>(all.size() - i);
    std::swap(all[i], all[i + static_cast<std::size_t>(rng.uniform() * left)]);
  }
  all.resize(count);
  return all;
}

void spoil(SimulatedCell& cell, Rng& rng) {
  const std::size_t size = cell.pictures.size();
  cell.is_flipped.assign(size, false);
  cell.is_wrong.assign(size, false);
  for (const std::size_t i : draw(cell.settings.flipped_share, 1, size, rng)) {
    std::ranges::reverse(cell.pictures[i].picture_px);
    cell.is_flipped[i] = true;
  }
  for (const std::size_t i : draw(cell.settings.wrong_share, 0, size, rng)) {
    cell.base_from_flange[i] = cell.true_base_from_flange[i + 1];
    cell.is_wrong[i] = true;
  }
}

}  // namespace

std::vector<Vector3d> cell_board() {
  std::vector<Vector3d> points;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 10; ++x) {
      points.emplace_back(6.6 * x, 6.6 * y, 0.0);
    }
  }
  return points;
}

SimulatedCell simulate_cell(const CellSettings& settings, std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 0);
  SimulatedCell cell{.settings = settings, .lens = cell_lens(), .poses = cell_poses(rng)};
  while (static_cast<int>(cell.pictures.size()) < settings.num_poses) {
    const Isometry3d view = random_view(settings, rng);
    BoardCorners corners = project_board(cell.lens, view);
    if (!corners.board_mm.empty()) {
      cell.pictures.push_back(std::move(corners));
      cell.true_base_from_flange.push_back(flange_of(settings.mounting, cell.poses, view));
    }
  }
  add_noise(cell, rng);
  if (settings.corner_error) {
    add_given_errors(cell, rng);
  }
  if (settings.shared_px > 0.0) {
    add_shared_errors(cell, rng);
  }
  spoil(cell, rng);
  return cell;
}

HandEyeOptions cell_options(const CellSettings& settings) {
  return {.mounting = settings.mounting,
          .camera = {.width_px = kCellWidth, .height_px = kCellHeight},
          .board_turns = 2};
}

Bundle bundle_at_truth(const SimulatedCell& cell) {
  Bundle bundle{.mounting = cell.settings.mounting,
                .lens = cell.lens,
                .is_free = {true, true, true, true, true, true, false, true, true},
                .poses = cell.poses,
                .are_poses_free = true,
                .noise = cell.settings.noise};
  for (const Isometry3d& pose : cell.true_base_from_flange) {
    const Isometry3d seen = camera_from_board(cell.settings.mounting, cell.poses, pose);
    bundle.views.push_back(joint_view(project_board(cell.lens, seen), pose));
  }
  return bundle;
}

Eigen::Matrix<double, 21, 1> miss_of(const SimulatedCell& cell,
                                     const LensVector& lens,
                                     const HandEye& poses) {
  Eigen::Matrix<double, 21, 1> miss;
  miss << cell.lens - lens, six_of(poses.hand_eye.inverse() * cell.poses.hand_eye),
      six_of(poses.board.inverse() * cell.poses.board);
  return miss;
}

PointError overlap_error(const SimulatedCell& cell, const LensVector& lens, const HandEye& poses) {
  double all = 0.0;
  double middle = 0.0;
  double outer = 0.0;
  int counts[3] = {0, 0, 0};
  for (const Isometry3d& pose : cell.true_base_from_flange) {
    const Isometry3d truth = camera_from_board(cell.settings.mounting, cell.poses, pose);
    const Isometry3d estimate = camera_from_board(cell.settings.mounting, poses, pose);
    for (int i = 0; i < 25 * 21; ++i) {
      const int row = i / 25;
      const Vector3d point =
          kMiddle + Vector3d(110.0 * (i % 25 / 24.0 - 0.5), 92.0 * (row / 20.0 - 0.5), 0.0);
      const auto a = project_by_lens(cell.lens, truth * point, nullptr);
      const auto b = project_by_lens(lens, estimate * point, nullptr);
      if (!a.has_value() || !b.has_value() || a->minCoeff() < 0.0 || a->x() > kCellWidth ||
          a->y() > kCellHeight) {
        continue;
      }
      const double radius = (*a - 0.5 * Vector2d(kCellWidth, kCellHeight)).norm();
      const double square = (*a - *b).squaredNorm();
      all += square;
      ++counts[0];
      if (radius < 400.0) {
        middle += square;
        ++counts[1];
      } else if (radius > 1000.0) {
        outer += square;
        ++counts[2];
      }
    }
  }
  return {.rms_px = std::sqrt(all / std::max(1, counts[0])),
          .center_px = std::sqrt(middle / std::max(1, counts[1])),
          .edge_px = std::sqrt(outer / std::max(1, counts[2]))};
}

}  // namespace glint
