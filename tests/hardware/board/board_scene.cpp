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

  /// Whether the print is the same all over the square that the point lies in.
  /// @param at  in squares, counted from the first inner corner
  bool is_plain(const Eigen::Vector2d& at) const {
    const double x = at.x() + 1.0;
    const double y = at.y() + 1.0;
    if (x < -1.0 || y < -1.0 || x >= board_.cols + 2 || y >= board_.rows + 2) {
      return true;
    }
    const bool is_white =
        (static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) % 2 != 0;
    const bool has_mark = board_.mark && x >= 0.0 && y >= 0.0 && x < 1.0 && y < 1.0;
    return !has_mark && (markers_.empty() || !is_white);
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
  const int width = image.width();
  const int height = image.height();
  const auto add = [width](float weight, const float* from, float* to) {
    for (int x = 0; x < width; ++x) {
      to[x] += weight * from[x];
    }
  };
  ImageF across(width, height);
  std::vector<float> padded(static_cast<std::size_t>(width + 2 * reach));
  for (int y = 0; y < height; ++y) {
    const float* row = image.row(y);
    std::fill_n(padded.begin(), reach, row[0]);
    std::copy_n(row, width, padded.begin() + reach);
    std::fill_n(padded.end() - reach, reach, row[width - 1]);
    for (int k = 0; k <= 2 * reach; ++k) {
      add(weights[static_cast<std::size_t>(k)], padded.data() + k, across.row(y));
    }
  }
  ImageF result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int k = 0; k <= 2 * reach; ++k) {
      const int from = std::clamp(y + k - reach, 0, height - 1);
      add(weights[static_cast<std::size_t>(k)], across.row(from), result.row(y));
    }
  }
  return result;
}

/// Blurred by a standard deviation that differs from pixel to pixel: between two of a row of blurs,
/// mixed so that the variance is right.
ImageF blurred(const ImageF& sharp, const ImageF& sigma) {
  constexpr std::array<double, 12> kSigmas = {
      0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.5, 7.0, 9.0, 12.0};
  const auto [low, high] = std::ranges::minmax(sigma.values());
  ImageF result = sharp;
  ImageF more;  // of the step before, less of this one
  for (std::size_t i = 0; i + 1 < kSigmas.size(); ++i) {
    const double a = i == 0 ? 0.0 : kSigmas[i];
    const double b = kSigmas[i + 1];
    if (static_cast<double>(high) < a || static_cast<double>(low) > b) {
      continue;
    }
    const ImageF less = more.size() > 0 ? std::move(more) : gaussian(sharp, kSigmas[i]);
    more = gaussian(sharp, b);
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

/// The share of full scale that a pixel has before blur: the mean of 4 x 4 points, or of one where
/// all are alike.
class PixelInk {
 public:
  explicit PixelInk(const BoardScene& scene)
      : scene_(scene), rays_(scene.camera), print_(scene.board) {}

  Hit hit_at(double x_px, double y_px) const { return hit(scene_, rays_.at(x_px, y_px)); }

  /// @param corners  of the pixel, in squares
  double at(int x, int y, const std::array<Eigen::Vector2d, 4>& corners) const {
    constexpr int kSamples = 4;
    if (print_.is_plain(corners[0]) && are_in_one_square(corners)) {
      return grey(print_.at(corners[0]), x + 0.5, y + 0.5);
    }
    double sum = 0.0;
    for (int k = 0; k < kSamples * kSamples; ++k) {
      const double px = x + (k % kSamples + 0.5) / kSamples;
      const int row = k / kSamples;
      const double py = y + (row + 0.5) / kSamples;
      sum += grey(print_.at(hit_at(px, py).squares), px, py);
    }
    return sum / (kSamples * kSamples);
  }

 private:
  static bool are_in_one_square(const std::array<Eigen::Vector2d, 4>& corners) {
    return std::ranges::all_of(corners, [&corners](const Eigen::Vector2d& corner) {
      return std::abs(std::floor(corner.x()) - std::floor(corners[0].x())) < 0.5 &&
             std::abs(std::floor(corner.y()) - std::floor(corners[0].y())) < 0.5;
    });
  }

  double grey(double ink, double x_px, double y_px) const {
    if (ink < 0.0) {
      return scene_.has_clutter ? clutter(x_px, y_px) : scene_.white;
    }
    return scene_.black + ink * (scene_.white - scene_.black);
  }

  const BoardScene& scene_;
  Rays rays_;
  Print print_;
};

}  // namespace

Image<std::uint8_t> photographed(const BoardScene& scene, Rng& rng) {
  const int width = scene.camera.width_px;
  const int height = scene.camera.height_px;
  const PixelInk ink(scene);
  ImageF sharp(width, height);
  ImageF sigma(width, height);
  std::vector<Eigen::Vector2d> above;
  std::vector<Eigen::Vector2d> below;
  for (int y = -1; y < height; ++y) {
    std::swap(above, below);
    below.clear();
    for (int x = 0; x <= width; ++x) {
      below.push_back(ink.hit_at(x, y + 1).squares);
    }
    for (int x = 0; x < width && y >= 0; ++x) {
      const auto i = static_cast<std::size_t>(x);
      sharp(x, y) =
          static_cast<float>(ink.at(x, y, {above[i], above[i + 1], below[i], below[i + 1]}));
      const double depth = ink.hit_at(x + 0.5, y + 0.5).depth_mm;
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
