// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that a camera on a simulated robot takes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "hardware/robot/kinematics/arm.h"
#include "hardware/twin/camera/picture_source.h"
#include "studies/imaging/scene_store.h"
#include "studies/twin_cell/truth.h"

namespace glint {

/// What of a cell changes a picture, beside the camera's settings.
struct TwinCellState {
  RigidTransform base_from_flange;  ///< as the robot tells it
  std::vector<std::string> lights;  ///< that are on
  int stage_position = 0;           ///< of a tunnel's scan: its frame
  double stage_shift_mm = 0.0;      ///< how far beyond that the stripes stand along the scan
  int placement = 1;                ///< how many times the part has been put down
  /// What errors of the joints make of the flange: base_from_flange * joint_error is where they
  /// take it. Belongs to pose and lights, so that it is no part of key_of().
  RigidTransform joint_error = {};

  bool is_dark() const { return lights.size() == 0; }  // NOLINT(readability-container-size-empty)
};

/// Equal for states whose pictures are equal: poses to a nanometre and a nanoradian.
std::string key_of(const TwinCellState& state);

/// The joint_error of an arm that stands there: each joint off by a normal number with the standard
/// deviation of [truth]. Drawn by pose and lights that are on, so that it is the same each time.
RigidTransform joint_error_of(const TruthSettings& truth,
                              const Arm& arm,
                              const JointVector& joints_rad,
                              const std::vector<std::string>& lights);

/// Where the camera is in truth when the robot says that its flange is there: with the hidden
/// hand-eye, and the error that the arm has at this pose, which is the same each time.
RigidTransform scene_from_camera(const Truth& truth, const TwinCellState& state);

/// Renders. Keeps what lights and exposure do not change.
class CellRenderer {
 public:
  CellRenderer(const Truth& truth, ThreadPool& pool);

  /// The same with a store that others use, too: views that truths of other exposures or powers of
  /// lights have in common are rendered once. The store must live longer; it leaves scores out.
  CellRenderer(const Truth& truth, SceneStore& store);

  int width_px() const { return width_px_; }

  int height_px() const { return height_px_; }

  /// Codes as a camera with these settings has them, of darkness where it does not see the part:
  /// the scene's radiance times the exposure over that of the truth, noise of the scene's sensor
  /// seeded by pose and lights, gain, black level. The same bytes for the same arguments.
  /// @throws ConfigError beginning with the key at fault, IoError
  Image<std::uint16_t> render(const TwinCellState& state, const CaptureSettings& settings);

  /// The same for all positions of the stage, which cost hardly more than one: as many as the
  /// scene's scan has; one where no tunnel is on.
  std::vector<Image<std::uint16_t>> render_all(const TwinCellState& state,
                                               const CaptureSettings& settings);

  /// Of the scene's scan; 1 without a tunnel.
  int num_positions() const;

  /// Between two of them [mm]; 0 without a tunnel.
  double step_mm() const;

  /// From where the stripes would stand without an offset to the first of them [mm].
  double offset_mm() const;

  /// After which way along the scan the stripes stand as before [mm]; 0 without a tunnel.
  double period_mm() const;

 private:
  void begin();
  SceneSettings scene_of(const TwinCellState& state, const CaptureSettings& settings) const;
  std::vector<Image<std::uint16_t>> render_lit(const SceneSettings& scene,
                                               const CaptureSettings& settings);

  Truth truth_;
  std::unique_ptr<SceneStore> own_store_;  ///< empty: another's is used
  SceneStore& store_;
  int width_px_ = 0;
  int height_px_ = 0;
};

}  // namespace glint
