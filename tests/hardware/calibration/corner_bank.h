// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors of corners that were found in rendered pictures, whose true places are known, and corner
// noise drawn from them for simulated calibrations. `script/bench calibrate bank` makes such a
// bank.
//
// Two corners are alike when they are blurred alike and the board lies alike on the pixels: that is
// what the error of a corner's fit depends on, beside contrast and noise, which the pictures share.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/rng.h"

namespace glint {

/// A lens and a sensor, as far as they blur.
struct CornerBlur {
  double aperture_mm = 0.0;  ///< diameter of the pupil; 0: a pinhole
  double focus_mm = 0.0;     ///< the depth that is sharp, > 0
  double image_distance_mm = 0.0;
  double pixel_mm = 0.0;
  double sensor_px = 0.0;  ///< standard deviation of the sensor's own blur

  /// Standard deviation along an axis of the blur at a depth: the disc of confusion (a quarter of
  /// its diameter), the sensor's blur and the pixel's own (1 / sqrt(12)) together.
  double sigma_px(double depth_mm) const;
};

/// How a board's row lies on the pixels: its direction in [-45, 45) degrees, modulo a quarter turn,
/// after which the pixels look the same.
/// @param from_px, to_px  two corners of a row
double turn_on_pixels_deg(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px);

/// A corner of a picture.
struct BankCorner {
  Eigen::Vector2d error_px = {0.0, 0.0};  ///< found minus true
  double blur_px = 0.0;                   ///< CornerBlur::sigma_px() there
  double distance_mm = 0.0;               ///< along the optical axis
  double radius_px = 0.0;                 ///< from the middle of the picture
};

/// A rendered picture.
struct BankPicture {
  std::string outcome = "accepted";  ///< of find_board()
  double f_number = 0.0;
  double tilt_deg = 0.0;            ///< between the board's normal and the optical axis
  double turn_deg = 0.0;            ///< turn_on_pixels_deg() of the board's middle row
  std::vector<BankCorner> corners;  ///< of an accepted one

  bool is_accepted() const { return outcome == "accepted"; }
};

/// What a group of like corners says.
struct CornerErrors {
  int corners = 0;
  Eigen::Vector2d bias_px = {0.0, 0.0};                      ///< mean error
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Zero();  ///< about the bias

  /// Root mean square along one axis, with the bias.
  double rms_px() const;
};

/// @param errors_px  may be empty
CornerErrors corner_errors(std::span<const Eigen::Vector2d> errors_px);

/// Errors in groups of like corners.
class CornerBank {
 public:
  /// Groups begin at these blurs; the last one has no end.
  static constexpr std::array<double, 6> kBlurs_px = {0.0, 0.6, 0.8, 1.1, 1.6, 2.4};
  static constexpr int kTurns = 3;  ///< of 30 degrees each, from -45
  static constexpr int kGroups = static_cast<int>(kBlurs_px.size()) * kTurns;
  static constexpr std::size_t kMinCorners = 50;  ///< of a group that is drawn from

  /// @param pictures  those that were not accepted have no corners
  /// @throws ConfigError when no group has kMinCorners
  explicit CornerBank(std::span<const BankPicture> pictures);

  /// The error of one of the like corners, whole, so that bias, covariance and tails are theirs.
  /// A group of too few corners gives way to the next one: of the same turn, if there is one.
  Eigen::Vector2d draw(double blur_px, double turn_deg, Rng& rng) const;

  /// The errors that draw() draws from.
  std::span<const Eigen::Vector2d> like(double blur_px, double turn_deg) const;

  /// What the corners of one picture share beyond chance: standard deviation along an axis of the
  /// mean error of a picture, less what independent errors of its corners would leave. draw() knows
  /// nothing of it.
  double shared_px() const { return shared_px_; }

  /// Groups as a table in Markdown: blur, turn, corners, bias and covariance, in px and px^2.
  std::string table() const;

 private:
  std::array<std::vector<Eigen::Vector2d>, kGroups> errors_px_;
  std::array<int, kGroups> drawn_from_ = {};
  double shared_px_ = 0.0;
};

}  // namespace glint
