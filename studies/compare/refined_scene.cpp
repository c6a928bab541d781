// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/refined_scene.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/config/toml.h"
#include "core/median.h"
#include "simulator/camera/viewpoint_file.h"
#include "simulator/sensor/sensor.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/compare/fit/joint_lens.h"
#include "studies/definition/scene_file.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// sensor.expose_to for so many times the light: the dark signal stays as it is.
double exposed_by(const SceneSettings& scene, double gain) {
  const double dark = dark_grey(scene.sensor);
  return dark + gain * (scene.expose_to - dark);
}

/// So many times the light; the dark signal, which sensor.gain would multiply too, stays as it is.
void put_gain(double gain, SceneSettings& refined) {
  if (refined.expose_to > 0.0) {  // a gain would be exposed away
    refined.expose_to = std::min(exposed_by(refined, gain), 1.0);
  } else if (dark_grey(refined.sensor) > 0.0) {
    refined.sensor.exposure *= gain;
  } else {
    refined.sensor.gain *= gain;
  }
}

/// Moves the camera against the part as the part is moved against it, and changes its lens.
void put_changes(const CauseVector& change, const Vector3d& middle_mm, SceneSettings& refined) {
  const Vector3d turn(change[0], change[1], change[2]);
  const Eigen::Matrix3d rotation =
      turn.norm() > 0.0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                        : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  const Vector3d shift(change[3], change[4], change[5]);
  const RigidTransform moved = {.rotation = rotation,
                                .translation_mm = middle_mm + shift - rotation * middle_mm};
  refined.viewpoint() = viewpoint_of_pose(moved * camera_from_world(refined.viewpoint()));
  const PinholeIntrinsics camera = intrinsics_of(refined);
  const double focal = 1.0 + change[6] / camera.focal_px.x();
  refined.camera.focal_x_px = focal * camera.focal_px.x();
  refined.camera.focal_y_px = focal * camera.focal_px.y();
  refined.camera.center_x_px = camera.center_px.x() + change[7];
  refined.camera.center_y_px = camera.center_px.y() + change[8];
  refined.camera.k1 = camera.radial[0] + change[9];
  refined.camera.p1 = camera.tangential[0] + change[10];
}

/// All of a scene but where it is looked at from.
std::string text_without_view(SceneSettings scene) {
  scene.viewpoints = {Viewpoint{}};
  return to_toml(write_scene(scene));
}

bool are_of_one_scene(std::span<const RefinedView> views) {
  std::set<ViewpointVector> poses;
  for (const RefinedView& view : views) {
    poses.insert(vector_of(view.scene.viewpoint()));
  }
  return views.size() >= 2 && poses.size() == views.size() &&
         allows_many_viewpoints(views.front().scene) &&
         std::ranges::all_of(views, [&](const RefinedView& view) {
           return view.causes.edges && !view.causes.space_edges.empty() &&
                  !view.causes.calibrated &&
                  text_without_view(view.scene) == text_without_view(views.front().scene);
         });
}

/// Parameters of the camera that some view holds for a cause, or cannot tell from one.
std::vector<CauseParameter> lens_causes(std::span<const RefinedView> views) {
  std::set<CauseParameter> lens;
  const auto add = [&](CauseParameter parameter) {
    if (parameter >= CauseParameter::kFocalLength) {
      lens.insert(parameter);
    }
  };
  for (const RefinedView& view : views) {
    for (const FoundCause& cause : view.causes.edges->causes) {
      add(cause.parameter);
      std::ranges::for_each(cause.not_separable, add);
    }
  }
  return {lens.begin(), lens.end()};
}

std::vector<LensView> lens_views(std::span<const RefinedView> views) {
  std::vector<LensView> list;
  for (const RefinedView& view : views) {
    list.push_back({.edges = view.causes.space_edges,
                    .middle_mm = view.causes.middle_mm,
                    .changes = view.causes.edges->changes,
                    .noise_px = view.causes.edges->noise_px});
  }
  return list;
}

/// Gains were fitted beside the roughness where a view tells it: both of these views alone, where
/// there are any. Views that leave both open say nothing.
PairCauses joint_greys(std::span<const RefinedView> views) {
  const auto tells = [](const RefinedView& view) { return view.causes.roughness_change != 0.0; };
  const bool is_told = std::ranges::any_of(views, tells);
  std::vector<double> gains;
  std::vector<double> rougher;
  for (const RefinedView& view : views) {
    if (!view.causes.is_roughness_open && (!is_told || tells(view))) {
      gains.push_back(view.causes.gain);
      rougher.push_back(view.causes.roughness_change);
    }
  }
  PairCauses greys;
  if (!gains.empty()) {
    greys.gain = median(gains);
    greys.roughness_change = median(rougher);
  }
  return greys;
}

}  // namespace

SceneSettings read_exposed_scene(const CompareSource& source) {
  SceneSettings scene = load_scene(source.scene);
  if (source.picture.stem() == "image") {
    scene.expose_to = 0.0;
  }
  return scene;
}

SceneSettings refined_scene(const SceneSettings& scene, const PairCauses& causes) {
  SceneSettings refined = scene;
  put_gain(causes.gain, refined);
  refined.material.roughness += causes.roughness_change;
  if (causes.calibrated) {
    put_intrinsics(*causes.calibrated, refined);
  }
  if (causes.edges && !causes.edges->causes.empty()) {
    put_changes(causes.edges->changes, causes.middle_mm, refined);
  }
  return refined;
}

SceneSettings refinable_scene(const CompareSource& source,
                              const PairCauses& causes,
                              SceneStore& store) {
  const SceneSettings scene = read_exposed_scene(source);
  const bool is_level_lost = scene.expose_to > 0.0 && (causes.roughness_change != 0.0 ||
                                                       exposed_by(scene, causes.gain) > 1.0);
  return is_level_lost ? with_equal_exposure(store, scene) : scene;
}

std::string refined_toml(const CompareSource& source, const PairCauses& causes, SceneStore& store) {
  return to_toml(write_scene(refined_scene(refinable_scene(source, causes, store), causes)));
}

std::optional<SceneSettings> jointly_refined(std::span<const RefinedView> views) {
  if (!are_of_one_scene(views)) {
    return std::nullopt;
  }
  const std::vector<CauseVector> changes =
      fit_joint_lens(lens_views(views), intrinsics_of(views.front().scene), lens_causes(views));
  std::vector<Viewpoint> viewpoints;
  SceneSettings joint;
  for (std::size_t i = 0; i < views.size(); ++i) {
    joint = views[i].scene;
    put_changes(changes[i], views[i].causes.middle_mm, joint);
    viewpoints.push_back(joint.viewpoint());
  }
  joint = refined_scene(joint, joint_greys(views));
  joint.viewpoints = std::move(viewpoints);
  return joint;
}

}  // namespace glint
