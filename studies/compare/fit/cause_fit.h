// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which changes of pose, lens and camera move edges as they are seen to have moved. Method, limits
// and sources: docs/theory/comparison.md.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/camera/pinhole_camera.h"

namespace glint {

/// An edge of the simulated part, and how far the real one lies along its normal.
struct SpaceEdge {
  Eigen::Vector3d in_camera_mm = Eigen::Vector3d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double offset_px = 0.0;
  /// Along the normal to the nearest other edge of the surface: one that the real edge may be taken
  /// for. Infinite: there is none near, or none was looked for.
  double free_px = std::numeric_limits<double>::infinity();
};

/// What may differ: turns of the part about the camera's axes through its middle, shifts along
/// them, and the camera's own numbers.
enum class CauseParameter : std::size_t {
  kTurnX,
  kTurnY,
  kTurnZ,
  kShiftX,
  kShiftY,
  kDistance,
  kFocalLength,
  kCentreX,
  kCentreY,
  kK1,
  kP1
};

inline constexpr std::size_t kCauseParameters = 11;

/// Changes of all parameters: rad, mm, px (focal length: of fx, fy in proportion), k1, p1.
using CauseVector = std::array<double, kCauseParameters>;

/// "turn_x", ... "k1", and the unit that values are told in ("deg", "mm", "px", "").
std::string name_of(CauseParameter parameter);
std::string unit_of(CauseParameter parameter);

/// Factor from the inner unit to the one that is told: degrees for turns.
double told_per_inner(CauseParameter parameter);

struct FoundCause {
  CauseParameter parameter = CauseParameter::kTurnX;
  double value = 0.0;
  double sigma = 0.0;
  double share = 0.0;  ///< of the sum of squared offsets, in [0, 1]
  /// Others that would move these edges alike (correlation beyond 0.99): which of them it is cannot
  /// be told.
  std::vector<CauseParameter> not_separable = {};
};

/// Share of the edges that one set of changes must explain; with less none is told.
inline constexpr double kMinAgreeing = 0.5;

struct CauseFit {
  std::vector<FoundCause> causes;  ///< the largest share first; empty: nothing beyond noise
  CauseVector changes = {};        ///< 0 but for the causes
  double before_px = 0.0;          ///< rms of the offsets
  double after_px = 0.0;           ///< of what the causes leave
  double noise_px = 0.0;           ///< of a single offset
  double agreeing = 0.0;           ///< share of the edges within 2 px of where all causes have them
};

/// The smallest set of causes that explains the offsets up to noise: of all sets of parameters the
/// one with the least sum of squares over noise plus a price for each parameter, no two of them
/// beyond a correlation of 0.99; then its values by a robust nonlinear fit (Ceres), without those
/// below 3.7 standard deviations. Where less than half of the edges agree none is told.
/// @param edges      in the order of their boundaries, so that the correlation of neighbours' noise
///                   is seen; fewer than 50: no cause is told
/// @param middle_mm      about which the part turns, in the camera's frame
/// @param min_agreeing   share of the edges that must agree
/// @param is_lens_known  only the part's pose may differ
/// @param about  changes that are known about: sets are compared by how edges move there
CauseFit fit_causes(std::span<const SpaceEdge> edges,
                    const PinholeIntrinsics& camera,
                    const Eigen::Vector3d& middle_mm,
                    bool is_lens_known = false,
                    double min_agreeing = kMinAgreeing,
                    const CauseVector& about = {});

/// Where a point would appear after the changes. @param point_mm  in the camera's frame, z > 0
Eigen::Vector2d changed_pixel(const PinholeIntrinsics& camera,
                              const Eigen::Vector3d& middle_mm,
                              const CauseVector& changes,
                              const Eigen::Vector3d& point_mm);

}  // namespace glint
