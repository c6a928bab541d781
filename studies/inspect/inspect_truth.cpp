// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_truth.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/units.h"
#include "simulator/camera/pinhole_camera.h"
#include "studies/definition/scene.h"
#include "studies/definition/scene_file.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinSeenPx = 1.0;  ///< what `glint render` sees less of has no window either

/// Radius of a line with round ends from its area: pi r^2 + 2 r length = area.
double radius_of(double area_px, double length_px) {
  return (std::sqrt(length_px * length_px + kPi * area_px) - length_px) / kPi;
}

class Reader {
 public:
  explicit Reader(const SceneSettings& scene)
      : camera_(intrinsics_of(scene)), pose_(camera_from_world(scene.viewpoint())) {}

  /// Empty when the camera does not see the defect: it is on the far side, or outside the picture.
  std::optional<KnownDefect> read(const nlohmann::json& json) const {
    const double area_px = json.at("area_px").get<double>();
    if (area_px < kMinSeenPx) {
      return std::nullopt;
    }
    KnownDefect known{.id = json.at("id").get<int>(),
                      .label = json.at("label").get<std::string>(),
                      .kind = json.at("kind").get<std::string>()};
    const Vector3d centre_mm = vector_of(json.at("centre_mm"));
    Vector3d half_mm = Vector3d::Zero();
    if (json.contains("direction")) {
      half_mm = half_line_mm(json) * vector_of(json["direction"]);
    }
    const auto middle = camera_.project(pose_ * centre_mm);
    const auto from = camera_.project(pose_ * (centre_mm - half_mm));
    const auto to = camera_.project(pose_ * (centre_mm + half_mm));
    if (!middle || !from || !to || !is_inside(*middle)) {
      return std::nullopt;
    }
    known.from_px = *from;
    known.to_px = *to;
    known.radius_px = radius_of(area_px, (*to - *from).norm());
    return known;
  }

 private:
  static Vector3d vector_of(const nlohmann::json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
  }

  /// The line that a scratch's width is measured from ends half a width before its ends.
  static double half_line_mm(const nlohmann::json& json) {
    return std::max(0.0,
                    0.5 * (json.at("length_mm").get<double>() - json.at("width_mm").get<double>()));
  }

  bool is_inside(const Vector2d& at_px) const {
    return at_px.x() >= 0.0 && at_px.y() >= 0.0 && at_px.x() < camera_.intrinsics().width_px &&
           at_px.y() < camera_.intrinsics().height_px;
  }

  PinholeCamera camera_;
  RigidTransform pose_;
};

}  // namespace

bool KnownDefect::is_line() const {
  return kind == type_name(DefectType::kScratch) || kind == type_name(DefectType::kGouge);
}

double KnownDefect::distance_px(const Vector2d& point) const {
  const Vector2d along = to_px - from_px;
  const double length2 = along.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp((point - from_px).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - from_px - share * along).norm();
}

std::vector<KnownDefect> read_known_defects(const fs::path& defects, const fs::path& scene) {
  const Reader reader(load_scene(scene));
  std::vector<KnownDefect> known;
  try {
    const nlohmann::json list = nlohmann::json::parse(read_file(defects));
    for (const nlohmann::json& json : list.at("defects")) {
      if (auto defect = reader.read(json)) {
        known.push_back(std::move(*defect));
      }
    }
  } catch (const nlohmann::json::exception& error) {
    throw ConfigError(fmt::format("{}: is no list of defects as `glint render` writes it: {}",
                                  defects.string(),
                                  error.what()));
  }
  return known;
}

DetectionMatches match_detections(std::span<const FoundDefect> found,
                                  std::span<const KnownDefect> known,
                                  const TrialSettings& settings) {
  const auto distance = [&](const FoundDefect& blob, std::size_t i, double slack_px) {
    const double distance_px = known[i].distance_px({blob.x_px, blob.y_px});
    return distance_px <= settings.hit_radii * known[i].radius_px + slack_px
               ? std::optional(distance_px / known[i].radius_px)
               : std::nullopt;
  };
  return match_detections(found, known.size(), settings.echo_px, distance);
}

}  // namespace glint
