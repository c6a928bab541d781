// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/saddle_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/units.h"

namespace glint {
namespace {

constexpr int kBorder = 7;          ///< room for a circle and its interpolation, px
constexpr int kCircle = 32;         ///< samples
constexpr double kMinStep = 0.005;  ///< bright minus dark: less is noise of any camera

/// A pixel whose determinant is the largest nearby.
struct Peak {
  int x = 0;
  int y = 0;
  float strength = 0.0F;
};

/// One row blurred by (1 4 6 4 1) / 16; two pixels at each end are copied.
void blur_row(const float* in, float* out, int width) {
  std::copy_n(in, 2, out);
  for (int x = 2; x < width - 2; ++x) {
    out[x] = (in[x - 2] + in[x + 2] + 4.0F * (in[x - 1] + in[x + 1]) + 6.0F * in[x]) * 0.0625F;
  }
  std::copy_n(in + width - 2, 2, out + width - 2);
}

ImageF blurred(const ImageF& picture) {
  const int width = picture.width();
  const int height = picture.height();
  ImageF across = ImageF::uninitialized(width, height);
  for (int y = 0; y < height; ++y) {
    blur_row(picture.row(y), across.row(y), width);
  }
  ImageF result = across;
  for (int y = 2; y < height - 2; ++y) {
    const float* rows[] = {
        across.row(y - 2), across.row(y - 1), across.row(y), across.row(y + 1), across.row(y + 2)};
    float* out = result.row(y);
    for (int x = 0; x < width; ++x) {
      out[x] = (rows[0][x] + rows[4][x] + 4.0F * (rows[1][x] + rows[3][x]) + 6.0F * rows[2][x]) *
               0.0625F;
    }
  }
  return result;
}

/// Minus the determinant of the Hessian, 0 at the border.
ImageF saddle_strength(const ImageF& smooth) {
  const int width = smooth.width();
  ImageF strength(width, smooth.height(), 0.0F);
  for (int y = 1; y < smooth.height() - 1; ++y) {
    const float* above = smooth.row(y - 1);
    const float* row = smooth.row(y);
    const float* below = smooth.row(y + 1);
    float* out = strength.row(y);
    for (int x = 1; x < width - 1; ++x) {
      const float xx = row[x - 1] - 2.0F * row[x] + row[x + 1];
      const float yy = above[x] - 2.0F * row[x] + below[x];
      const float xy = 0.25F * (below[x + 1] - below[x - 1] - above[x + 1] + above[x - 1]);
      out[x] = xy * xy - xx * yy;
    }
  }
  return strength;
}

bool is_peak(const ImageF& strength, int x, int y) {
  const float value = strength(x, y);
  for (int j = -2; j <= 2; ++j) {
    const float* row = strength.row(y + j) + x;
    for (int i = -2; i <= 2; ++i) {
      const bool is_before = j < 0 || (j == 0 && i < 0);  // of two equal ones the first counts
      if (is_before ? row[i] >= value : row[i] > value) {
        return false;
      }
    }
  }
  return true;
}

std::vector<Peak> strongest_peaks(const ImageF& strength, std::size_t most) {
  constexpr float kMin = 2e-7F;
  std::vector<Peak> peaks;
  for (int y = kBorder; y < strength.height() - kBorder; ++y) {
    const float* row = strength.row(y);
    for (int x = kBorder; x < strength.width() - kBorder; ++x) {
      if (row[x] > kMin && row[x] >= row[x - 1] && row[x] >= row[x + 1] &&
          is_peak(strength, x, y)) {
        peaks.push_back({.x = x, .y = y, .strength = row[x]});
      }
    }
  }
  const auto is_stronger = [](const Peak& a, const Peak& b) {
    return a.strength != b.strength ? a.strength > b.strength
                                    : (a.y != b.y ? a.y < b.y : a.x < b.x);
  };
  const std::size_t kept = std::min(peaks.size(), most);
  std::ranges::partial_sort(peaks, peaks.begin() + static_cast<std::ptrdiff_t>(kept), is_stronger);
  peaks.resize(kept);
  return peaks;
}

float interpolated(const ImageF& image, const Eigen::Vector2d& at_px) {
  const auto x = static_cast<float>(at_px.x() - 0.5);
  const auto y = static_cast<float>(at_px.y() - 0.5);
  const int ix = static_cast<int>(x);  // positions are inside
  const int iy = static_cast<int>(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float* above = image.row(iy) + ix;
  const float* below = image.row(iy + 1) + ix;
  return (1.0F - fy) * ((1.0F - fx) * above[0] + fx * above[1]) +
         fy * ((1.0F - fx) * below[0] + fx * below[1]);
}

/// The saddle of the paraboloid through a pixel and its neighbours.
Eigen::Vector2d refined(const ImageF& smooth, const Peak& peak) {
  const int x = peak.x;
  const int y = peak.y;
  const auto at = [&](int i, int j) { return static_cast<double>(smooth(x + i, y + j)); };
  const double gx = 0.5 * (at(1, 0) - at(-1, 0));
  const double gy = 0.5 * (at(0, 1) - at(0, -1));
  const double xx = at(-1, 0) - 2.0 * at(0, 0) + at(1, 0);
  const double yy = at(0, -1) - 2.0 * at(0, 0) + at(0, 1);
  const double xy = 0.25 * (at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1));
  const double determinant = xx * yy - xy * xy;  // < 0 at a peak
  const Eigen::Vector2d step((xy * gy - yy * gx) / determinant, (xy * gx - xx * gy) / determinant);
  const double longest = std::max(1.0, step.cwiseAbs().maxCoeff());
  return Eigen::Vector2d(x + 0.5, y + 0.5) + step / longest;
}

/// Where a circle crosses the middle grey value, as angles, the first one towards bright.
std::optional<std::array<double, 4>> crossings(const std::array<double, kCircle>& values,
                                               double middle) {
  std::array<double, 4> angles = {};
  std::size_t found = 0;
  bool is_first_rising = false;
  for (std::size_t k = 0; k < kCircle; ++k) {
    const double a = values[k] - middle;
    const double b = values[(k + 1) % kCircle] - middle;
    if ((a < 0.0) == (b < 0.0)) {
      continue;
    }
    if (found == angles.size()) {
      return std::nullopt;
    }
    is_first_rising = found == 0 ? b > a : is_first_rising;
    angles[found++] = 2.0 * kPi * (static_cast<double>(k) + a / (a - b)) / kCircle;
  }
  if (found != angles.size()) {
    return std::nullopt;
  }
  if (!is_first_rising) {
    std::rotate(angles.begin(), angles.begin() + 1, angles.end());
    angles[3] += 2.0 * kPi;
  }
  return angles;
}

/// Two bright and two dark arcs, each of at least 20 degrees and clearly so, opposite crossings in
/// line.
bool is_corner(const std::array<double, kCircle>& values,
               const std::array<double, 4>& angles,
               double middle,
               double contrast) {
  constexpr double kMinArc = 20.0 * kRadPerDeg;
  constexpr double kMaxBend = 25.0 * kRadPerDeg;
  for (std::size_t k = 0; k < 4; ++k) {
    const double begin = angles[k];
    const double end = k == 3 ? angles[0] + 2.0 * kPi : angles[k + 1];
    if (end - begin < kMinArc) {
      return false;
    }
    const double centre = 0.5 * (begin + end) / (2.0 * kPi) * kCircle;
    const auto sample = static_cast<std::size_t>(std::lround(centre)) % kCircle;
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    if (sign * (values[sample] - middle) < 0.2 * contrast) {
      return false;
    }
  }
  return std::abs(angles[2] - angles[0] - kPi) < kMaxBend &&
         std::abs(angles[3] - angles[1] - kPi) < kMaxBend;
}

using Circle = std::array<Eigen::Vector2d, kCircle>;

Circle unit_circle() {
  Circle circle;
  for (std::size_t k = 0; k < kCircle; ++k) {
    const double angle = 2.0 * kPi * static_cast<double>(k) / kCircle;
    circle[k] = {std::cos(angle), std::sin(angle)};
  }
  return circle;
}

std::optional<SaddlePoint> tested(const ImageF& smooth,
                                  const Circle& circle,
                                  const Eigen::Vector2d& at_px,
                                  double radius) {
  std::array<double, kCircle> values = {};
  for (std::size_t k = 0; k < kCircle; ++k) {
    values[k] = static_cast<double>(interpolated(smooth, at_px + radius * circle[k]));
  }
  const auto [low, high] = std::ranges::minmax(values);
  const double middle = 0.5 * (low + high);
  const auto angles = crossings(values, middle);
  if (high - low < kMinStep || !angles || !is_corner(values, *angles, middle, high - low)) {
    return std::nullopt;
  }
  const double rising = 0.5 * ((*angles)[0] + (*angles)[2] - kPi);
  const double falling = 0.5 * ((*angles)[1] + (*angles)[3] - kPi);
  const Eigen::Vector2d up(std::cos(rising), std::sin(rising));
  const Eigen::Vector2d down(std::cos(falling), std::sin(falling));
  return SaddlePoint{.at_px = at_px, .contrast = high - low, .edges = {up, down, -up, -down}};
}

}  // namespace

std::vector<SaddlePoint> find_saddle_points(const ImageF& picture, int most) {
  std::vector<SaddlePoint> points;
  if (std::min(picture.width(), picture.height()) <= 2 * kBorder) {
    return points;
  }
  const ImageF smooth = blurred(picture);
  const auto wanted = static_cast<std::size_t>(most);
  const Circle circle = unit_circle();
  for (const Peak& peak : strongest_peaks(saddle_strength(smooth), 8 * wanted)) {
    const Eigen::Vector2d at_px = refined(smooth, peak);
    auto point = tested(smooth, circle, at_px, 5.0);
    point = point ? point : tested(smooth, circle, at_px, 3.0);
    if (point) {
      points.push_back(*point);
      if (points.size() == wanted) {
        break;
      }
    }
  }
  return points;
}

}  // namespace glint
