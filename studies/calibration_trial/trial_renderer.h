// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of a trial: its board as the scene's part, seen from poses of the robot.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "studies/calibrate/board_target.h"
#include "studies/calibration_trial/trial_poses.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// Renders a study's board. The study must outlive it.
class TrialRenderer {
 public:
  /// @param study     with a [calibration_trial]
  /// @param ink_file  where write_ink() puts what render() reads
  /// @throws ConfigError, IoError: the board's file
  TrialRenderer(const Study& study, const std::filesystem::path& ink_file, int threads);

  const Board& board() const { return board_; }

  const CameraOnRobot& truth() const { return truth_; }

  /// @throws IoError
  void write_ink() const;

  /// As draw_pose(). @throws ConfigError with the place of the key at fault in the study's file
  TrialPose pose(std::uint64_t index) const;

  /// Grey values of the sensor, share of full scale; the same seed and index give the same bytes
  /// for any number of threads.
  /// @param base_from_flange  where the robot is
  /// @param index             of the picture: of its noise
  /// @param go_on             asked now and then; empty: to the end
  /// @return empty when go_on said no
  /// @throws ConfigError, IoError
  std::optional<ImageF> render(const RigidTransform& base_from_flange,
                               int index,
                               const std::function<bool()>& go_on = {});

 private:
  SceneSettings scene_at(const RigidTransform& base_from_flange, int index) const;

  const Study& study_;
  std::filesystem::path ink_file_;
  Board board_;
  BoardTarget target_;
  CameraOnRobot truth_;
  ThreadPool pool_;
  SceneStore store_;
};

}  // namespace glint
