// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/scene_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/config/key_writer.h"
#include "core/text.h"
#include "core/units.h"
#include "metrics/aspect_image/score_gradient.h"
#include "simulator/render/derivative/ray_derivative.h"
#include "simulator/render/derivative/scan_gradient.h"

namespace glint {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::string_view kPose = "viewpoint.0.";

/// A share of scatter in the unevenness (squares) that is worth a remark.
constexpr double kLargeNoise = 1e-3;

/// The key of the tunnel that a path names; empty for another path.
std::string tunnel_key(const SceneSettings& scene, const std::string& path) {
  const std::string prefix = "lighting." + scene.tunnel_name + ".";
  return path.starts_with(prefix) ? path.substr(prefix.size()) : "";
}

/// Internal units per written one of a key like "opening_deg" or "control_mm.2".
double unit_of(const std::string& key) {
  const auto dot = key.rfind('.');
  const bool has_index =
      dot != std::string::npos && key.find_first_not_of("0123456789", dot + 1) == std::string::npos;
  return internal_per_written(has_index ? std::string_view(key).substr(0, dot) : key);
}

/// What a key changes by the radiance of the dark stripes at fixed places: this is a matter of the
/// wall alone, so by differences.
double by_dark(const SceneSettings& scene, const std::string& key, const ScanGradient& gradient) {
  constexpr double kStep = 1e-4;
  if (scene.tunnel.dark_reflectance == 0.0) {
    return 0.0;
  }
  const auto dark_at = [&](double change) {
    TunnelSettings tunnel = scene.tunnel;
    ConfigNode table = ConfigNode::table();
    KeyWriter writer(table);
    visit_keys(writer, tunnel);
    set_path(table, key, ConfigNode::from_number(table.at_path(key)->number + change));
    std::vector<Problem> errors;
    KeyReader reader(&table, "", errors);
    visit_keys(reader, tunnel);
    return Tunnel(tunnel).dark();
  };
  const DarkRadiance here = dark_at(0.0);
  const DarkRadiance high = dark_at(kStep);
  const DarkRadiance low = dark_at(-kStep);
  double sum = gradient.dark * (high.mean() - low.mean());
  for (std::size_t i = 0; i < gradient.dark_nodes.size(); ++i) {
    const auto node = static_cast<int>(i);
    sum += gradient.dark_nodes[i] * (high.at_node_of(here, node) - low.at_node_of(here, node));
  }
  return sum / (2.0 * kStep);
}

/// How the camera moves when a number of its viewpoint changes.
CameraTwist twist_by(const Viewpoint& viewpoint, const std::string& key) {
  constexpr double kStep = 1e-5;
  const auto camera_at = [&](double change) {
    Viewpoint moved = viewpoint;
    const auto index = static_cast<std::size_t>(key.back() - '0');
    std::vector<double>& numbers = key.starts_with("position_mm") ? moved.position_mm
                                   : key.starts_with("direction") ? moved.direction
                                                                  : moved.up;
    numbers.at(index) += change;
    return inverse(camera_from_world(moved));
  };
  const RigidTransform high = camera_at(kStep);
  const RigidTransform low = camera_at(-kStep);
  const Matrix3d turn = high.rotation * low.rotation.transpose();
  const Vector3d axis(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  return {.translation_mm = (high.translation_mm - low.translation_mm) / (2.0 * kStep),
          .rotation_rad = 0.5 * axis / (2.0 * kStep)};
}

bool is_pose(const std::string& path) {
  constexpr std::array<std::string_view, 3> kVectors = {"position_mm", "direction", "up"};
  return std::ranges::any_of(kVectors, [&](std::string_view vector) {
    const std::string begin = fmt::format("{}{}.", kPose, vector);
    return path.starts_with(begin) && path.size() == begin.size() + 1 && path.back() >= '0' &&
           path.back() <= '2';
  });
}

constexpr std::array<std::string_view, 8> kShapeKeys = {"base_mm",
                                                        "radius_mm",
                                                        "half_width_mm",
                                                        "height_mm",
                                                        "exponent",
                                                        "distance_mm",
                                                        "opening_deg",
                                                        "panel_height_mm"};
constexpr std::array<std::string_view, 4> kStripeKeys = {
    "slot_mm", "period_mm", "duty", "offset_mm"};
constexpr std::array<std::string_view, 3> kSensorKeys = {
    "sensor.gain", "sensor.exposure", "sensor.blur_px"};

std::array<float, 3> components(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

HitBlock hits_from(const WallHits& hits, std::size_t ray) {
  return {.x_mm = hits.x_mm.data() + ray,
          .y_mm = hits.y_mm.data() + ray,
          .margin_mm = hits.margin_mm.data() + ray};
}

template <class List>
bool is_one_of(const List& list, std::string_view key) {
  return std::ranges::find(list, key) != list.end();
}

/// How rays move with each pose path, traced once for all scores.
struct PoseMotions {
  std::vector<RayDerivative> corners;               ///< one for each pose path
  std::vector<std::vector<RayDerivative>> refined;  ///< for each group
};

class SceneGradients {
 public:
  SceneGradients(const SceneSettings& scene,
                 const ScanState& scan,
                 const WantedGradients& wanted,
                 ThreadPool& pool)
      : scene_(scene), scan_(scan), wanted_(wanted), pool_(pool) {}

  Gradients run() {
    for (const std::string& score : wanted_.scores) {
      if (score == "view.slot_margin_mm") {
        result_.by_score[score] = gradient_of_slot();
        continue;
      }
      const std::optional<ImageF> by_aspect = gradient_by_aspect(score, scored_image());
      if (by_aspect) {
        result_.by_score[score] = gradient_of(*by_aspect);
      }
    }
    add_remarks();
    return result_;
  }

 private:
  ScoredImage scored_image() const {
    return {.aspect = scan_.aspect,
            .region = scan_.traced.region.mask,
            .defects = scan_.traced.defects,
            .sigma_floor = scan_.sigma_floor,
            .deviation = scan_.deviation};
  }

  std::vector<double> gradient_of(const ImageF& by_aspect) {
    const auto wants = [&](std::string_view path) { return is_one_of(wanted_.paths, path); };
    const bool has_dark = scene_.tunnel.dark_reflectance > 0.0;
    const std::string tunnel = "lighting." + scene_.tunnel_name + ".";
    const ScanGradient gradient = gradient_of_scan(scan_.footprints,
                                                   scan_.sensor,
                                                   scan_.plan,
                                                   scene_.render.reflectance,
                                                   by_aspect,
                                                   {.duty = wants(tunnel + "duty"),
                                                    .dark = has_dark,
                                                    .gain = wants("sensor.gain"),
                                                    .exposure = wants("sensor.exposure"),
                                                    .blur = wants("sensor.blur_px")},
                                                   scan_.cells);
    detached_pixels_ = std::max(detached_pixels_, gradient.detached_pixels);
    ShapeDerivative motion(scan_.footprints.tunnel());
    gradient.collect(scan_.footprints, motion);
    std::vector<double> by_path;
    for (const std::string& path : wanted_.paths) {
      by_path.push_back(derivative_by(path, gradient, motion));
    }
    return by_path;
  }

  /// By how much the slot's margin changes where its sight line meets the wall.
  static void collect_sight(const SlotMargin& slot, ShapeDerivative& motion) {
    const std::array<float, 3> origin = components(slot.sight.origin_mm);
    const std::array<float, 3> direction = components(slot.sight.direction);
    const std::array<float, 3> hit = components({slot.x_mm, slot.y_mm, slot.wall_margin_mm});
    const float by_y = slot.has_sight ? (slot.y_mm < 0.0 ? 1.0F : -1.0F) : 0.0F;
    const float none = 0.0F;
    motion.collect({.origin_x = &origin[0],
                    .origin_y = &origin[1],
                    .origin_z = &origin[2],
                    .direction_x = &direction[0],
                    .direction_y = &direction[1],
                    .direction_z = &direction[2],
                    .count = 1},
                   {.x_mm = &hit[0], .y_mm = &hit[1], .margin_mm = &hit[2]},
                   {.x = &none, .y = &by_y, .margin = &none});
  }

  /// Half the slot's width less |y| where the worst sight line meets the wall.
  std::vector<double> gradient_of_slot() const {
    ShapeDerivative motion(scan_.footprints.tunnel());
    collect_sight(scan_.slot, motion);
    std::vector<double> by_path;
    for (const std::string& path : wanted_.paths) {
      const std::string key = tunnel_key(scene_, path);
      const std::optional<double> by_shape = motion.derivative_by(key);
      const bool is_pose_of_camera = path.starts_with("viewpoint.") || path.starts_with("camera.");
      by_path.push_back(key == "slot_mm"    ? 0.5
                        : by_shape          ? *by_shape * unit_of(key)
                        : is_pose_of_camera ? std::numeric_limits<double>::quiet_NaN()
                                            : 0.0);
    }
    return by_path;
  }

  double derivative_by(const std::string& path,
                       const ScanGradient& gradient,
                       const ShapeDerivative& motion) {
    if (!without_derivative(scene_, path).empty()) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    if (path == "sensor.gain") {
      return gradient.gain;
    }
    if (path == "sensor.exposure") {
      return gradient.exposure;
    }
    if (path == "sensor.blur_px") {
      return gradient.blur_px;
    }
    if (is_pose(path)) {
      return derivative_by_pose(path, gradient, motion);
    }
    const std::string key = tunnel_key(scene_, path);
    const double dark = by_dark(scene_, key, gradient);
    if (key == "slot_mm") {
      return gradient.slot_mm + dark;
    }
    if (key == "period_mm") {
      return gradient.period_mm;
    }
    if (key == "duty") {
      return gradient.duty + dark;
    }
    if (key == "offset_mm") {
      return gradient.offset_mm;
    }
    return motion.derivative_by(key).value() * unit_of(key) + dark;
  }

  double derivative_by_pose(const std::string& path,
                            const ScanGradient& gradient,
                            const ShapeDerivative& motion) {
    if (!poses_) {
      trace_poses();
    }
    const auto at = std::ranges::find(pose_paths_, path) - pose_paths_.begin();
    const auto index = static_cast<std::size_t>(at);
    const CornerRays& rays = scan_.traced.corners;
    double sum = 0.0;
    gradient.corners.for_each_run([&](std::size_t first, int count, const HitGradient& run) {
      sum += by_rays(rays.corners,
                     first,
                     count,
                     hits_from(scan_.footprints.hits(), first),
                     run,
                     poses_->corners[index],
                     motion);
    });
    WallHits met;
    for (std::size_t g = 0; g < gradient.refined.size(); ++g) {
      const RefinedGroup& group = rays.refined[g];
      const int count = (group.cells_per_axis + 1) * (group.cells_per_axis + 1);
      for (std::size_t i = 0; i < gradient.refined[g].pixels.size(); ++i) {
        const std::size_t first = gradient.refined[g].pixels[i] * static_cast<std::size_t>(count);
        intersect_light(
            group.rays, scan_.footprints.tunnel(), static_cast<std::int64_t>(first), count, met);
        sum += by_rays(group.rays,
                       first,
                       count,
                       hits_from(met, 0),
                       gradient.refined[g].by_hits.from(i * static_cast<std::size_t>(count)),
                       poses_->refined[g][index],
                       motion);
      }
    }
    return sum;
  }

  /// Of rays [first, first + count); hits and derivatives begin with the first of them.
  static double by_rays(const RayCache& rays,
                        std::size_t first,
                        int count,
                        const HitBlock& hits,
                        const HitGradient& gradient,
                        const RayDerivative& d,
                        const ShapeDerivative& motion) {
    return motion.derivative_by_rays(rays.block(static_cast<std::int64_t>(first), count),
                                     {.origin_x = d.origin_x.data() + first,
                                      .origin_y = d.origin_y.data() + first,
                                      .origin_z = d.origin_z.data() + first,
                                      .direction_x = d.direction_x.data() + first,
                                      .direction_y = d.direction_y.data() + first,
                                      .direction_z = d.direction_z.data() + first},
                                     hits,
                                     gradient);
  }

  void trace_poses() {
    std::vector<CameraTwist> twists;
    for (const std::string& path : wanted_.paths) {
      if (is_pose(path)) {
        pose_paths_.push_back(path);
        twists.push_back(twist_by(scene_.viewpoint(), path.substr(kPose.size())));
      }
    }
    const PinholeCamera camera(intrinsics_of(scene_));
    const CameraScene scene = {.part = scan_.traced.built().part,
                               .bvh = *scan_.traced.built().bvh,
                               .detail = scan_.traced.detail(),
                               .camera = camera,
                               .camera_from_world = scan_.traced.camera_from_world,
                               .settings = scene_.render};
    poses_.emplace();
    poses_->corners = corner_derivatives(scene, twists, pool_);
    for (const RefinedGroup& group : scan_.traced.corners.refined) {
      poses_->refined.push_back(refined_derivatives(scene, group, twists, pool_));
    }
  }

  void add_remark(std::string text, std::optional<std::int64_t> count = {}) {
    result_.remarks.push_back({.count = count, .text = std::move(text)});
  }

  void add_remarks() {
    for (const std::string& path : wanted_.paths) {
      const std::string why = without_derivative(scene_, path);
      if (!why.empty()) {
        add_remark(fmt::format("{}: {}", path, why));
      }
    }
    if (detached_pixels_ > 0) {
      add_remark("pixels at outlines of the part or ends of the tunnel are treated as constant",
                 detached_pixels_);
    }
    const auto is_uniformity = [](const std::string& score) {
      return score == "homogeneity.h_rms" || score == "homogeneity.h_abs";
    };
    if (std::ranges::any_of(wanted_.scores, is_uniformity) &&
        noise_share(scored_image()) > kLargeNoise) {
      add_remark(
          "the scatter of pixels by noise and few frames is treated as constant: the homogeneity "
          "includes it, but no term for how it changes");
    }
    if (std::ranges::any_of(wanted_.paths, is_pose)) {
      add_remark(
          "the camera's pose moves the part's outline and the region of interest: both are treated "
          "as constant");
      if (scan_.footprints.hidden_share() > 0.0) {
        add_remark(
            "the edge of what the wall occludes from the camera is treated as constant by the "
            "camera's pose; slot and shape have their terms for it");
      }
    }
  }

  const SceneSettings& scene_;
  const ScanState& scan_;
  const WantedGradients& wanted_;
  ThreadPool& pool_;
  Gradients result_;
  std::optional<PoseMotions> poses_;
  std::vector<std::string> pose_paths_;
  int detached_pixels_ = 0;
};

}  // namespace

std::string without_derivative(const SceneSettings& scene, const std::string& path) {
  const std::string key = tunnel_key(scene, path);
  const bool is_shape = is_one_of(kShapeKeys, key) || key.starts_with("control_mm.");
  const bool is_offered =
      is_shape || is_one_of(kStripeKeys, key) || is_one_of(kSensorKeys, path) || is_pose(path);
  if (!is_offered) {
    return "has no derivative; offered are the tunnel's shape, slot_mm, period_mm, duty and "
           "offset_mm, sensor.gain, exposure and blur_px, and the viewpoint's numbers";
  }
  if ((is_shape || is_pose(path)) &&
      (scene.tunnel.orientation_rad != 0.0 || scene.tunnel.cosine_law)) {
    return "has no derivative with oblique stripes or the cosine law";
  }
  if (key == "period_mm" && scene.scan.step_mm > 0.0) {
    return "has no derivative with a given scan.step_mm; leave it 0 so that the steps follow";
  }
  return "";
}

Gradients gradients_of(const SceneSettings& scene,
                       const ScanState& scan,
                       const WantedGradients& wanted,
                       ThreadPool& pool) {
  return SceneGradients(scene, scan, wanted, pool).run();
}

}  // namespace glint
