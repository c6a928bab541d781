// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/board/board_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hardware/board/charuco.h"

namespace glint {
namespace {

constexpr int kRayGrid = 8;  ///< rays are exact at every eighth pixel, else interpolated

/// Directions x/z, y/z through pixels.
class Rays {
 public:
  explicit Rays(const PinholeIntrinsics& intrinsics) {
    const PinholeCamera camera(intrinsics);
    width_ = intrinsics.width_px / kRayGrid + 2;
    for (int y = 0; y <= intrinsics.height_px / kRayGrid + 1; ++y) {
      for (int x = 0; x < width_; ++x) {
        const auto ray = camera.ray_through(kRayGrid * Eigen::Vector2d(x, y));
        at_.emplace_back(ray.value().head<2>() / ray->z());
      }
    }
  }

  Eigen::Vector2d at(double x, double y) const {
    const double gx = x / kRayGrid;
    const double gy = y / kRayGrid;
    const int ix = static_cast<int>(gx);
    const int iy = static_cast<int>(gy);
    const auto* row = at_.data() + iy * width_ + ix;
    const Eigen::Vector2d above = row[0] + (gx - ix) * (row[1] - row[0]);
    const Eigen::Vector2d below = row[width_] + (gx - ix) * (row[width_ + 1] - row[width_]);
    return above + (gy - iy) * (below - above);
  }

 private:
  int width_ = 0;
  std::vector<Eigen::Vector2d> at_;
};

/// What is printed: 1 white, 0 black; empty places around the board are below 0.
class Print {
 public:
  explicit Print(const Board& board) : board_(board) {
    if (board.kind == BoardKind::kCharuco) {
      markers_ = charuco_markers(board);
    }
  }

  /// @param at  in squares, counted from the first inner corner
  double at(const Eigen::Vector2d& at) const {
    const double x = at.x() + 1.0;
    const double y = at.y() + 1.0;
    const int cols = board_.cols + 1;
    const int rows = board_.rows + 1;
    if (x < 0.0 || y < 0.0 || x >= cols || y >= rows) {
      return x < -1.0 || y < -1.0 || x >= cols + 1 || y >= rows + 1 ? -1.0 : 1.0;
    }
    const int col = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const Eigen::Vector2d inside(x - col, y - row);
    if ((col + row) % 2 == 0) {
      const bool is_dot = board_.mark && col == 0 && row == 0 &&
                          (inside - Eigen::Vector2d(0.5, 0.5)).norm() < 0.5 * kMarkSquares;
      return is_dot ? 1.0 : 0.0;
    }
    return markers_.empty() ? 1.0 : marker_at(row * cols + col, inside);
  }

 private:
  double marker_at(int square, const Eigen::Vector2d& inside) const {
    const CharucoMarker& marker = markers_[static_cast<std::size_t>(square / 2)];
    const double side = marker_side_mm(board_) / board_.square_mm;
    const Eigen::Vector2d module = (inside.array() - 0.5 * (1.0 - side)) / side * marker.side;
    if (module.minCoeff() < 0.0 || module.maxCoeff() >= marker.side) {
      return 1.0;
    }
    const int index = static_cast<int>(module.y()) * marker.side + static_cast<int>(module.x());
    return marker.is_dark[static_cast<std::size_t>(index)] ? 0.0 : 1.0;
  }

  const Board& board_;
  std::vector<CharucoMarker> markers_;
};

/// The plane of the board met by a ray.
struct Hit {
  Eigen::Vector2d squares;
  double depth_mm = 0.0;
};

Hit hit(const BoardScene& scene, const Eigen::Vector2d& ray) {
  const Eigen::Matrix3d rotation = scene.camera_from_board.linear();
  const Eigen::Vector3d origin = scene.camera_from_board.translation();
  const Eigen::Vector3d direction(ray.x(), ray.y(), 1.0);
  const double depth = rotation.col(2).dot(origin) / rotation.col(2).dot(direction);
  const Eigen::Vector3d at = rotation.transpose() * (depth * direction - origin);
  return {.squares = at.head<2>() / scene.board.square_mm, .depth_mm = depth};
}

/// Soft spots between 0.2 and 0.7.
double clutter(double x, double y) {
  return 0.45 + 0.12 * std::sin(0.031 * x + 1.3) * std::cos(0.027 * y) +
         0.12 * std::sin(0.017 * x - 0.023 * y);
}

ImageF gaussian(const ImageF& image, double sigma) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<float> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    sum += std::exp(-0.5 * k * k / (sigma * sigma));
  }
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma)) / sum));
  }
  const auto pass = [&](const ImageF& in, int dx, int dy) {
    ImageF out(in.width(), in.height());
    for (int k = -reach; k <= reach; ++k) {
      const float weight = weights[static_cast<std::size_t>(k + reach)];
      for (int y = 0; y < in.height(); ++y) {
        const float* row = in.row(std::clamp(y + k * dy, 0, in.height() - 1));
        float* to = out.row(y);
        if (dx == 0) {
          for (int x = 0; x < in.width(); ++x) {
            to[x] += weight * row[x];
          }
        } else {
          for (int x = 0; x < in.width(); ++x) {
            to[x] += weight * row[std::clamp(x + k, 0, in.width() - 1)];
          }
        }
      }
    }
    return out;
  };
  return pass(pass(image, 1, 0), 0, 1);
}

/// Blurred by a standard deviation that differs from pixel to pixel: between two of a row of blurs,
/// mixed so that the variance is right.
ImageF blurred(const ImageF& sharp, const ImageF& sigma) {
  constexpr std::array<double, 12> kSigmas = {
      0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.5, 7.0, 9.0, 12.0};
  const auto [low, high] = std::ranges::minmax(sigma.values());
  ImageF result = sharp;
  for (std::size_t i = 0; i + 1 < kSigmas.size(); ++i) {
    const double a = i == 0 ? 0.0 : kSigmas[i];
    const double b = kSigmas[i + 1];
    if (static_cast<double>(high) < a || static_cast<double>(low) > b) {
      continue;
    }
    const ImageF less = gaussian(sharp, kSigmas[i]);
    const ImageF more = gaussian(sharp, b);
    for (std::size_t k = 0; k < sharp.size(); ++k) {
      const auto s = static_cast<double>(sigma.values()[k]);
      if (s >= a && s <= b) {
        const double w = (s * s - kSigmas[i] * kSigmas[i]) / (b * b - kSigmas[i] * kSigmas[i]);
        const double mix = std::clamp(w, 0.0, 1.0);
        result.values()[k] =
            static_cast<float>((1.0 - mix) * static_cast<double>(less.values()[k]) +
                               mix * static_cast<double>(more.values()[k]));
      }
    }
  }
  return result;
}

}  // namespace

Image<std::uint8_t> photographed(const BoardScene& scene, Rng& rng) {
  constexpr int kSamples = 4;
  const int width = scene.camera.width_px;
  const int height = scene.camera.height_px;
  const Rays rays(scene.camera);
  const Print print(scene.board);
  ImageF sharp(width, height);
  ImageF sigma(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double px = x + (k % kSamples + 0.5) / kSamples;
        const double py = y + (k / kSamples + 0.5) / kSamples;
        const double ink = print.at(hit(scene, rays.at(px, py)).squares);
        sum += ink < 0.0 ? (scene.has_clutter ? clutter(px, py) : scene.white)
                         : scene.black + ink * (scene.white - scene.black);
      }
      sharp(x, y) = static_cast<float>(sum / (kSamples * kSamples));
      const double depth = hit(scene, rays.at(x + 0.5, y + 0.5)).depth_mm;
      sigma(x, y) = static_cast<float>(scene.blur_px_at ? scene.blur_px_at(depth) : 0.5);
    }
  }
  const ImageF soft = blurred(sharp, sigma);
  Image<std::uint8_t> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double light = 1.0 - scene.shading * (1.0 - static_cast<double>(x) / width);
      const double grey = static_cast<double>(soft(x, y)) * light + scene.noise * rng.normal();
      picture(x, y) = static_cast<std::uint8_t>(std::clamp(255.0 * grey + 0.5, 0.0, 255.0));
    }
  }
  return picture;
}

std::vector<Eigen::Vector2d> true_corners_px(const BoardScene& scene) {
  const PinholeCamera camera(scene.camera);
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& corner : corners_mm(scene.board)) {
    corners.push_back(camera.project(scene.camera_from_board * corner).value());
  }
  return corners;
}

double corners_inside_px(const BoardScene& scene) {
  double least = 1e9;
  for (const Eigen::Vector2d& p : true_corners_px(scene)) {
    least = std::min(
        {least, p.x(), p.y(), scene.camera.width_px - p.x(), scene.camera.height_px - p.y()});
  }
  return least;
}

double largest_blur_px(const BoardScene& scene) {
  double largest = 0.0;
  for (const Eigen::Vector3d& corner : corners_mm(scene.board)) {
    const double depth = (scene.camera_from_board * corner).z();
    const double blur = scene.blur_px_at ? scene.blur_px_at(depth) : 0.5;
    largest = std::max(largest, std::sqrt(blur * blur + 1.0 / 12.0));
  }
  return largest;
}

Eigen::Isometry3d random_pose(const Board& board,
                              double distance_mm,
                              double tilt_rad,
                              double roll_rad,
                              double shift_mm,
                              Rng& rng) {
  const Eigen::Vector3d middle = 0.5 * corner_mm(board, board.cols - 1, board.rows - 1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(
      rng.uniform(-shift_mm, shift_mm), rng.uniform(-shift_mm, shift_mm), distance_mm));
  pose.rotate(Eigen::AngleAxisd(rng.uniform(-roll_rad, roll_rad), Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(rng.uniform(-tilt_rad, tilt_rad), Eigen::Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(rng.uniform(-tilt_rad, tilt_rad), Eigen::Vector3d::UnitY()));
  pose.translate(-middle);
  return pose;
}

double rms_px(const Board& board,
              const std::vector<Eigen::Vector2d>& found,
              const std::vector<Eigen::Vector2d>& truth) {
  const auto rms = [&](bool is_turned) {
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      sum += (found[i] - truth[is_turned ? truth.size() - 1 - i : i]).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(found.size()));
  };
  return num_symmetries(board) == 1 ? rms(false) : std::min(rms(false), rms(true));
}

}  // namespace glint
