// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/causes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/image/exr_layers.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastGain = 0.002;  ///< smaller changes of exposure are nobody's concern
constexpr double kSurelySigmas = 4.0;

SceneSettings scene_of(const CompareSource& source) {
  std::vector<Problem> errors;
  SceneSettings scene = read_scene(load_toml(source.scene), errors);
  throw_if_any(errors);
  return scene;
}

/// Points of the part in the camera's frame, by pixel.
class Surface {
 public:
  Surface(const CompareSource& source, const RigidTransform& camera_from_world)
      : camera_from_world_(camera_from_world) {
    const std::array<std::string, 4> names = {
        "position_mm.x", "position_mm.y", "position_mm.z", "depth_mm"};
    channels_ = read_exr_channels(source.geometry, names);
  }

  int width() const { return channels_[0].width(); }

  int height() const { return channels_[0].height(); }

  /// The nearest pixel of the part within some pixels.
  std::optional<Vector3d> near(const Vector2d& at_px) const {
    constexpr int kReach = 2;
    const int x0 = static_cast<int>(std::floor(at_px.x()));
    const int y0 = static_cast<int>(std::floor(at_px.y()));
    std::optional<Vector3d> best;
    double best_distance = 1e9;
    for (int y = std::max(y0 - kReach, 0); y <= std::min(y0 + kReach, height() - 1); ++y) {
      for (int x = std::max(x0 - kReach, 0); x <= std::min(x0 + kReach, width() - 1); ++x) {
        const double distance = (Vector2d(x + 0.5, y + 0.5) - at_px).norm();
        if (channels_[3](x, y) > 0.0F && distance < best_distance) {
          best_distance = distance;
          best = at(x, y);
        }
      }
    }
    return best;
  }

  /// Mean of all its pixels.
  Vector3d middle_mm() const {
    Vector3d sum = Vector3d::Zero();
    double count = 0.0;
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(); ++x) {
        if (channels_[3](x, y) > 0.0F) {
          sum += at(x, y);
          count += 1.0;
        }
      }
    }
    return count > 0.0 ? Vector3d(sum / count) : Vector3d(0.0, 0.0, 1.0);
  }

 private:
  Vector3d at(int x, int y) const {
    return camera_from_world_ *
           vector_of(channels_[0](x, y), channels_[1](x, y), channels_[2](x, y));
  }

  RigidTransform camera_from_world_;
  std::vector<ImageF> channels_;
};

std::vector<SpaceEdge> edges_on(const Surface& surface, const PairGeometry& geometry) {
  std::vector<SpaceEdge> edges;
  for (const EdgeOffset& offset : geometry.offsets) {
    if (const auto point = surface.near(offset.at_px)) {
      edges.push_back(
          {.in_camera_mm = *point, .normal = offset.normal, .offset_px = offset.offset_px});
    }
  }
  return edges;
}

ToldCause told(const FoundCause& found) {
  const double per = told_per_inner(found.parameter);
  ToldCause cause = {.name = name_of(found.parameter),
                     .value = per * found.value,
                     .unit = unit_of(found.parameter),
                     .sigma = per * found.sigma,
                     .share = found.share,
                     .of = "edges"};
  if (!found.not_separable.empty()) {
    cause.group.push_back(cause.name);
    for (const CauseParameter partner : found.not_separable) {
      cause.group.push_back(name_of(partner));
    }
  }
  return cause;
}

/// The gain between both exposures, where it is beyond what noise makes of it.
std::optional<ToldCause> gain_cause(const ComparedPair& pair) {
  const ExposureMatch& match = pair.appearance.exposure;
  double squares = 0.0;
  double rest_before = 0.0;
  for (std::size_t i = 0; i < pair.simulated.grey.size(); ++i) {
    if (pair.region.empty() || pair.region.values()[i] != 0) {
      const auto simulated = static_cast<double>(pair.simulated.grey.values()[i]);
      const double difference = static_cast<double>(pair.real.grey.values()[i]) - simulated;
      squares += simulated * simulated;
      rest_before += difference * difference;
    }
  }
  if (match.pixels == 0 || squares <= 0.0 || rest_before <= 0.0) {
    return std::nullopt;
  }
  const double sigma = match.rms / std::sqrt(squares);
  if (std::abs(match.gain - 1.0) < std::max(kLeastGain, kSurelySigmas * sigma)) {
    return std::nullopt;
  }
  const double rest = match.rms * match.rms * static_cast<double>(match.pixels);
  return ToldCause{.name = "gain",
                   .value = match.gain,
                   .unit = "",
                   .sigma = sigma,
                   .share = std::clamp(1.0 - rest / rest_before, 0.0, 1.0),
                   .of = "grey"};
}

/// The viewpoint of a camera_from_world.
Viewpoint viewpoint_of(const RigidTransform& camera_from_world) {
  const RigidTransform world_from_camera = inverse(camera_from_world);
  const auto list = [](const Vector3d& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  return {.position_mm = list(world_from_camera.translation_mm),
          .direction = list(world_from_camera.rotation.col(2)),
          .up = list(-world_from_camera.rotation.col(1))};
}

}  // namespace

std::vector<SpaceEdge> space_edges(const ComparedPair& pair, const SceneSettings& scene) {
  const Surface surface(pair.simulated.source, camera_from_world(scene.viewpoint()));
  return edges_on(surface, pair.geometry);
}

PairCauses find_causes(const ComparedPair& pair, bool is_lens_known) {
  PairCauses causes;
  const CompareSource& source = pair.simulated.source;
  if (!source.scene.empty() && !source.geometry.empty()) {
    const SceneSettings scene = scene_of(source);
    const Surface surface(source, camera_from_world(scene.viewpoint()));
    causes.middle_mm = surface.middle_mm();
    causes.edges = fit_causes(
        edges_on(surface, pair.geometry), intrinsics_of(scene), causes.middle_mm, is_lens_known);
    for (const FoundCause& found : causes.edges->causes) {
      causes.told.push_back(told(found));
    }
  }
  if (const auto gain = gain_cause(pair)) {
    causes.gain = gain->value;
    causes.told.push_back(*gain);
  }
  return causes;
}

SceneSettings refined_scene(const SceneSettings& scene, const PairCauses& causes) {
  SceneSettings refined = scene;
  refined.sensor.gain *= causes.gain;
  if (!causes.edges || causes.edges->causes.empty()) {
    return refined;
  }
  const CauseVector& change = causes.edges->changes;
  const Vector3d turn(change[0], change[1], change[2]);
  const Eigen::Matrix3d rotation =
      turn.norm() > 0.0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                        : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  const Vector3d shift(change[3], change[4], change[5]);
  const RigidTransform moved = {
      .rotation = rotation,
      .translation_mm = causes.middle_mm + shift - rotation * causes.middle_mm};
  refined.viewpoint() = viewpoint_of(moved * camera_from_world(scene.viewpoint()));
  const PinholeIntrinsics camera = intrinsics_of(scene);
  const double focal = 1.0 + change[6] / camera.focal_px.x();
  refined.camera.focal_x_px = focal * camera.focal_px.x();
  refined.camera.focal_y_px = focal * camera.focal_px.y();
  refined.camera.center_x_px = camera.center_px.x() + change[7];
  refined.camera.center_y_px = camera.center_px.y() + change[8];
  refined.camera.k1 = camera.radial[0] + change[9];
  refined.camera.p1 = camera.tangential[0] + change[10];
  return refined;
}

std::string refined_toml(const CompareSource& source, const PairCauses& causes) {
  return to_toml(write_scene(refined_scene(scene_of(source), causes)));
}

}  // namespace glint
