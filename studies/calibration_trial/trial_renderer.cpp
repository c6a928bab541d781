// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_renderer.h"

#include <utility>
#include <vector>

#include "core/config/pose_keys.h"
#include "core/image/image_io.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/imaging/frame_exposure.h"

namespace glint {
namespace {

CameraOnRobot truth_of(const SceneSettings& scene, const RigidTransform& part_from_board) {
  const bool in_hand = scene.calibration->setup == CalibrationSetup::kEyeInHand;
  const MeasuredPoseSettings& camera =
      in_hand ? *scene.calibration->flange_from_camera : *scene.calibration->base_from_camera;
  const MeasuredPoseSettings& part =
      in_hand ? *scene.cell->base_from_part : *scene.cell->flange_from_part;
  return {.intrinsics = intrinsics_of(scene),
          .setup = scene.calibration->setup,
          .hand_eye = transform_of(camera.pose),
          .board = transform_of(part.pose) * part_from_board};
}

}  // namespace

TrialRenderer::TrialRenderer(const Study& study, const std::filesystem::path& ink_file, int threads)
    : study_(study),
      ink_file_(ink_file),
      board_(read_board(study.calibration_trial->board)),
      target_(board_target(board_, ink_file, study.calibration_trial->paper)),
      truth_(truth_of(study.scene, target_.part_from_board)),
      pool_(threads),
      store_(pool_) {}

void TrialRenderer::write_ink() const {
  const CalibrationTrialSettings& settings = *study_.calibration_trial;
  write_png(ink_file_, ink_picture(board_, settings.ink / settings.paper), PixelDepth::k8Bit);
}

TrialPose TrialRenderer::pose(std::uint64_t index) const {
  try {
    return draw_pose(truth_, board_, *study_.calibration_trial, index);
  } catch (const ConfigError& error) {
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      const ConfigNode* node = study_.root.at_path(problem.key);
      problem.place = (node != nullptr ? *node : *study_.root.find("calibration_trial")).place;
    }
    throw ConfigError(std::move(problems));
  }
}

SceneSettings TrialRenderer::scene_at(const RigidTransform& base_from_flange, int index) const {
  SceneSettings scene = study_.scene;
  scene.part = target_.part;
  scene.material = target_.material;
  const RigidTransform camera = scene_from_camera(scene, pose_settings(base_from_flange));
  const auto numbers = [](const Eigen::Vector3d& v) { return std::vector{v.x(), v.y(), v.z()}; };
  scene.viewpoint_set = {};
  scene.viewpoints = {{.position_mm = numbers(camera.translation_mm),
                       .direction = numbers(camera.rotation.col(2)),
                       .up = numbers(-camera.rotation.col(1))}};
  scene.paths.seed += index;
  scene.paths.batches = 1;
  return scene;
}

std::optional<ImageF> TrialRenderer::render(const RigidTransform& base_from_flange,
                                            int index,
                                            const std::function<bool()>& go_on) {
  const SceneSettings scene = scene_at(base_from_flange, index);
  const PathView view(scene, store_.build_defects(scene), scene.viewpoint());
  const PathPreview preview = [&](const PathProgress&) { return !go_on || go_on(); };
  const PathPicture picture = render_view(view, path_settings(scene), pool_, {}, preview);
  if (go_on && !go_on()) {
    return std::nullopt;
  }
  const Sensor sensor(scene.sensor, scene.camera.width_px, scene.camera.height_px);
  const std::vector<ImageF> radiance = channel_radiances(picture, view.frames().front());
  return mean_of_channels(expose_channels(sensor, radiance, index));
}

}  // namespace glint
