// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/calibration/corner_bank.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"
#include "simulator/camera/thin_lens_camera.h"

namespace glint {
namespace {

constexpr double kTurnWidth_deg = 90.0 / CornerBank::kTurns;

int blur_group(double blur_px) {
  const auto above = std::ranges::upper_bound(CornerBank::kBlurs_px, blur_px);
  return std::max(0, static_cast<int>(above - CornerBank::kBlurs_px.begin()) - 1);
}

int turn_group(double turn_deg) {
  const int group = static_cast<int>(std::floor((turn_deg + 45.0) / kTurnWidth_deg));
  return std::clamp(group, 0, CornerBank::kTurns - 1);
}

/// Groups of one turn stand side by side.
int group_of(double blur_px, double turn_deg) {
  return turn_group(turn_deg) * static_cast<int>(CornerBank::kBlurs_px.size()) +
         blur_group(blur_px);
}

/// How unlike two groups are: another turn counts more than any other blur.
int unlikeness(int a, int b) {
  constexpr int kBlurs = static_cast<int>(CornerBank::kBlurs_px.size());
  return kBlurs * std::abs(a / kBlurs - b / kBlurs) + std::abs(a % kBlurs - b % kBlurs);
}

/// Sums over pictures for what their corners share.
struct SharedErrors {
  void add(const CornerErrors& picture) {
    if (picture.corners > 1) {
      means_px.push_back(picture.bias_px);
      chance_px2 += picture.covariance_px2.trace() / (2.0 * picture.corners);
    }
  }

  double sigma_px() const {
    if (means_px.size() < 2) {
      return 0.0;
    }
    const CornerErrors means = corner_errors(means_px);
    const double beyond =
        0.5 * means.covariance_px2.trace() - chance_px2 / static_cast<double>(means_px.size());
    return std::sqrt(std::max(0.0, beyond));
  }

  std::vector<Eigen::Vector2d> means_px;
  double chance_px2 = 0.0;  ///< variance along an axis of a mean of independent errors, summed
};

}  // namespace

double CornerBlur::sigma_px(double depth_mm) const {
  const double disc_px =
      circle_of_confusion_mm(aperture_mm, focus_mm, image_distance_mm, depth_mm) / pixel_mm;
  return std::sqrt(disc_px * disc_px / 16.0 + sensor_px * sensor_px + 1.0 / 12.0);
}

double turn_on_pixels_deg(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px) {
  const Eigen::Vector2d along = to_px - from_px;
  const double turn_deg = std::atan2(along.y(), along.x()) * kDegPerRad;
  return turn_deg - 90.0 * std::floor((turn_deg + 45.0) / 90.0);
}

double CornerErrors::rms_px() const {
  return std::sqrt(0.5 * (covariance_px2.trace() + bias_px.squaredNorm()));
}

CornerErrors corner_errors(std::span<const Eigen::Vector2d> errors_px) {
  CornerErrors result{.corners = static_cast<int>(errors_px.size())};
  const auto count = static_cast<double>(errors_px.size());
  for (const Eigen::Vector2d& error : errors_px) {
    result.bias_px += error / count;
  }
  for (const Eigen::Vector2d& error : errors_px) {
    const Eigen::Vector2d off = error - result.bias_px;
    result.covariance_px2 += off * off.transpose() / count;
  }
  return result;
}

CornerBank::CornerBank(std::span<const BankPicture> pictures) {
  SharedErrors shared;
  for (const BankPicture& picture : pictures) {
    std::vector<Eigen::Vector2d> of_picture;
    for (const BankCorner& corner : picture.corners) {
      of_picture.push_back(corner.error_px);
      const int group = group_of(corner.blur_px, picture.turn_deg);
      errors_px_[static_cast<std::size_t>(group)].push_back(corner.error_px);
    }
    shared.add(corner_errors(of_picture));
  }
  shared_px_ = shared.sigma_px();
  for (int group = 0; group < kGroups; ++group) {
    int least = std::numeric_limits<int>::max();
    for (int other = 0; other < kGroups; ++other) {
      const bool suffices = errors_px_[static_cast<std::size_t>(other)].size() >= kMinCorners;
      if (suffices && unlikeness(group, other) < least) {
        least = unlikeness(group, other);
        drawn_from_[static_cast<std::size_t>(group)] = other;
      }
    }
    if (least == std::numeric_limits<int>::max()) {
      throw ConfigError(fmt::format(
          "corner bank: no group has {} like corners; more pictures are needed", kMinCorners));
    }
  }
}

std::span<const Eigen::Vector2d> CornerBank::like(double blur_px, double turn_deg) const {
  const auto group = static_cast<std::size_t>(group_of(blur_px, turn_deg));
  return errors_px_[static_cast<std::size_t>(drawn_from_[group])];
}

Eigen::Vector2d CornerBank::draw(double blur_px, double turn_deg, Rng& rng) const {
  const std::span<const Eigen::Vector2d> errors = like(blur_px, turn_deg);
  return errors[static_cast<std::size_t>(rng.uniform() * static_cast<double>(errors.size()))];
}

std::string CornerBank::table() const {
  std::string text =
      "| blur [px] | rows on the pixels [deg] | corners | bias x, y [px] | rms [px] | covariance "
      "xx, xy, yy [px^2] |\n|---|---|---|---|---|---|\n";
  for (int group = 0; group < kGroups; ++group) {
    const CornerErrors errors = corner_errors(errors_px_[static_cast<std::size_t>(group)]);
    const std::size_t blur = static_cast<std::size_t>(group) % kBlurs_px.size();
    const int turn = group / static_cast<int>(kBlurs_px.size());
    const double turn_deg = -45.0 + kTurnWidth_deg * turn;
    const std::string end =
        blur + 1 < kBlurs_px.size() ? fmt::format("{:g}", kBlurs_px[blur + 1]) : std::string("...");
    text += fmt::format(
        "| {:g} to {} | {:g} to {:g} | {} | {:.4f}, {:.4f} | {:.4f} | {:.3g}, {:.3g}, {:.3g} |\n",
        kBlurs_px[blur],
        end,
        turn_deg,
        turn_deg + kTurnWidth_deg,
        errors.corners,
        errors.bias_px.x(),
        errors.bias_px.y(),
        errors.rms_px(),
        errors.covariance_px2(0, 0),
        errors.covariance_px2(0, 1),
        errors.covariance_px2(1, 1));
  }
  return text;
}

}  // namespace glint
