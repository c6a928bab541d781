// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/build_lights.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "simulator/light/area/read_environment.h"
#include "simulator/light/area/read_ies.h"

namespace glint {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;
using Mount = LightPlacement::Mount;

/// A light whose surface the file does not give is a disc of this size.
constexpr double kPointSize_mm = 1.0;

Vector3d to_vector(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

/// One value for all channels, or one for each.
Array3f to_channels(const std::vector<double>& values) {
  return values.size() == 3 ? Array3f(to_vector(values).cast<float>().array())
                            : Array3f::Constant(static_cast<float>(values.at(0)));
}

/// The frame moved along its axis: a height counts against the way a light shines, of those on the
/// camera along it.
EmitterFrame raised(EmitterFrame frame, Mount mount, double height_mm) {
  frame.origin_mm += (mount == Mount::kCamera ? height_mm : -height_mm) * frame.z;
  return frame;
}

/// Collects what one light after the other adds.
class Builder {
 public:
  Builder(const LightMounts& mounts, const MeshLoader& load_mesh)
      : mounts_(mounts), load_mesh_(load_mesh) {}

  void add(const NamedLight& light) {
    name_ = light.name;
    std::visit([this](const auto& settings) { build(settings); }, light.settings);
  }

  void add(const TunnelLight& tunnel) { add_tunnel(tunnel, lights_); }

  Lights finish() {
    lights_.tree = LightTree(lights_.emitters, lights_.bodies);
    return std::move(lights_);
  }

 private:
  void build(const RingSettings& s);
  void build(const DomeSettings& s);
  void build(const BarSettings& s);
  void build(const CoaxialSettings& s);
  void build(const MeshLightSettings& s);
  void build(const EnvironmentSettings& s);
  void build(const IesLightSettings& s);

  void add_even_ring(const RingSettings& s, const EmitterFrame& frame);
  void add_leds(const RingSettings& s, const EmitterFrame& frame);
  void add_body_faces(const IesLightSettings& s, int group);

  EmitterFrame frame_of(const LightPlacement& placement) const {
    return placed_frame(placement, mounts_);
  }

  int add_group(std::string name, double factor = 1.0) {
    lights_.groups.push_back({.name = std::move(name), .factor = factor});
    return static_cast<int>(lights_.groups.size()) - 1;
  }

  void begin_lobes(const LightEmission& emission) {
    first_ = lights_.emitters.size();
    segment_of_.clear();
    lobe_ = {.radiance = to_channels(emission.radiance),
             .exponent = exponent_of_half_angle(emission.half_angle_rad)};
  }

  void add_lobe(EmitterShape shape, int segment = 0) {
    lobe_.shape = std::move(shape);
    lights_.emitters.push_back(lobe_);
    segment_of_.push_back(segment);
  }

  void end_lobes(const LightEmission& emission, const LightSegments& segments = {});
  void scale_to_power(const Array3f& power_w);

  LightMounts mounts_;
  const MeshLoader& load_mesh_;
  Lights lights_;
  std::string name_;
  std::size_t first_ = 0;        ///< emitter of the light in hand
  std::vector<int> segment_of_;  ///< its emitters'
  Emitter lobe_;
};

/// Radiances that make the flux of the light in hand what was asked for.
void Builder::scale_to_power(const Array3f& power_w) {
  Array3f sum = Array3f::Zero();
  for (std::size_t i = first_; i < lights_.emitters.size(); ++i) {
    lights_.emitters[i].radiance = Array3f::Ones();
    sum += lobe_power_w(lights_.emitters[i]);
  }
  for (std::size_t i = first_; i < lights_.emitters.size(); ++i) {
    lights_.emitters[i].radiance = power_w / sum;
  }
}

/// Fills groups, powers and segment factors of the light in hand.
void Builder::end_lobes(const LightEmission& emission, const LightSegments& segments) {
  if (lights_.emitters.size() == first_) {
    throw ConfigError("lighting." + name_, "has no luminous area");
  }
  if (!emission.power_w.empty()) {
    scale_to_power(to_channels(emission.power_w));
  }
  const int group = static_cast<int>(lights_.groups.size());
  for (int k = 0; k < (segments.separate ? segments.segments : 1); ++k) {
    const bool has_factor = segments.separate && !segments.segment_power.empty();
    add_group(segments.separate ? fmt::format("{}.{}", name_, k) : name_,
              has_factor ? segments.segment_power[static_cast<std::size_t>(k)] : 1.0);
  }
  for (std::size_t i = first_; i < lights_.emitters.size(); ++i) {
    Emitter& emitter = lights_.emitters[i];
    const int segment = segment_of_[i - first_];
    emitter.group = group + (segments.separate ? segment : 0);
    if (!segments.separate && !segments.segment_power.empty()) {
      emitter.radiance *=
          static_cast<float>(segments.segment_power[static_cast<std::size_t>(segment)]);
    }
    lights_.groups[static_cast<std::size_t>(emitter.group)].power_w += lobe_power_w(emitter);
  }
}

void Builder::add_even_ring(const RingSettings& s, const EmitterFrame& frame) {
  const int count = s.segments.segments;
  const double span = 2.0 * kPi / count;
  for (int k = 0; k < count; ++k) {
    add_lobe(RingShape{.frame = frame,
                       .middle_radius_mm = 0.5 * (s.inner_radius_mm + s.outer_radius_mm),
                       .width_mm = s.outer_radius_mm - s.inner_radius_mm,
                       .tilt_rad = s.tilt_rad,
                       .first_rad = k * span,
                       .span_rad = span},
             k);
  }
}

/// LED i stands in the middle of the i-th part of the circle and belongs to the segment there.
void Builder::add_leds(const RingSettings& s, const EmitterFrame& frame) {
  const double radius = 0.5 * (s.inner_radius_mm + s.outer_radius_mm);
  for (int i = 0; i < s.leds; ++i) {
    const double phi = 2.0 * kPi * (i + 0.5) / s.leds;
    const Vector3d radial = std::cos(phi) * frame.x + std::sin(phi) * frame.y;
    const Vector3d normal = std::cos(s.tilt_rad) * frame.z - std::sin(s.tilt_rad) * radial;
    const double led_radius = 0.5 * s.led_diameter_mm;
    add_lobe(
        RingShape{.frame = frame_around(frame.origin_mm + radius * radial, normal.normalized()),
                  .middle_radius_mm = 0.5 * led_radius,
                  .width_mm = led_radius},
        i * s.segments.segments / s.leds);
  }
}

void Builder::build(const RingSettings& s) {
  const EmitterFrame frame = raised(frame_of(s.placement), s.placement.mount, s.height_mm);
  begin_lobes(s.emission);
  if (s.leds > 0) {
    add_leds(s, frame);
  } else {
    add_even_ring(s, frame);
  }
  end_lobes(s.emission, s.segments);
}

// The dome shines along its axis, so its top lies the other way.
void Builder::build(const DomeSettings& s) {
  EmitterFrame frame = raised(frame_of(s.placement), s.placement.mount, s.height_mm);
  frame.y = -frame.y;
  frame.z = -frame.z;
  begin_lobes(s.emission);
  add_lobe(CapShape{.frame = frame,
                    .radius_mm = s.radius_mm,
                    .top_rad = std::asin(std::min(1.0, 0.5 * s.opening_mm / s.radius_mm)),
                    .rim_rad = s.rim_rad});
  end_lobes(s.emission);
}

void Builder::build(const BarSettings& s) {
  const EmitterFrame frame = frame_of(s.placement);
  const int count = s.segments.segments;
  begin_lobes(s.emission);
  for (int k = 0; k < count; ++k) {
    RectangleShape part = {
        .frame = frame, .half_x_mm = 0.5 * s.length_mm / count, .half_y_mm = 0.5 * s.width_mm};
    part.frame.origin_mm += ((k + 0.5) / count - 0.5) * s.length_mm * frame.x;
    add_lobe(part, k);
  }
  end_lobes(s.emission, s.segments);
}

// Its mirror image in the beam splitter stands on the view axis; the camera looks through it.
void Builder::build(const CoaxialSettings& s) {
  begin_lobes(s.emission);
  lobe_.is_solid = false;
  add_lobe(RectangleShape{.frame = frame_of(s.placement),
                          .half_x_mm = 0.5 * s.width_mm,
                          .half_y_mm = 0.5 * s.height_mm});
  LightEmission emission = s.emission;
  for (double& power : emission.power_w) {
    power *= s.reflectance;
  }
  if (emission.power_w.empty()) {
    lights_.emitters.back().radiance *= static_cast<float>(s.reflectance);
  }
  end_lobes(emission);
}

void Builder::build(const MeshLightSettings& s) {
  if (s.file.empty()) {
    throw ConfigError(fmt::format("lighting.{}.file", name_), "must name a mesh");
  }
  GLINT_CHECK(load_mesh_, "a scene with a mesh emitter comes with a loader");
  const EmitterFrame frame = frame_of(s.placement);
  begin_lobes(s.emission);
  for (const LightTriangle& t : load_mesh_(s.file)) {
    const TriangleShape shape = {.a_mm = frame.origin_mm + frame.global(t[0]),
                                 .b_mm = frame.origin_mm + frame.global(t[1]),
                                 .c_mm = frame.origin_mm + frame.global(t[2])};
    const double area = area_mm2(shape);
    if (area > 0.0 && std::isfinite(area)) {
      add_lobe(shape);
    }
  }
  end_lobes(s.emission);
}

void Builder::build(const EnvironmentSettings& s) {
  if (lights_.environment) {
    throw ConfigError("lighting." + name_, "is a second environment, one is allowed");
  }
  const Array3f radiance = to_channels(s.radiance);
  lights_.environment = s.file.empty() ? Environment(radiance) : read_environment(s.file, radiance);
  lights_.environment_frame = frame_of(s.placement);
  lights_.environment_group = add_group(name_);
}

/// The sides of the opening: both faces of a flat one when the file has light to both sides.
void Builder::add_body_faces(const IesLightSettings& s, int group) {
  const int index = static_cast<int>(lights_.bodies.size()) - 1;
  const IesBody& body = lights_.bodies.back();
  const Vector3d half = 0.5 * body.size_mm;
  Emitter face = {.radiance = to_channels(s.scale), .body = index, .group = group};
  const EmitterFrame& f = body.frame;
  const auto add = [&](const Vector3d& x, const Vector3d& y, double hx, double hy, double out) {
    const Vector3d z = x.cross(y);
    const EmitterFrame frame = {.origin_mm = f.origin_mm + out * z, .x = x, .y = y, .z = z};
    if (body.is_round) {
      face.shape = RingShape{.frame = frame, .middle_radius_mm = 0.5 * hx, .width_mm = hx};
    } else {
      face.shape = RectangleShape{.frame = frame, .half_x_mm = hx, .half_y_mm = hy};
    }
    lights_.emitters.push_back(face);
  };
  const bool shines_down = body.table.vertical_rad.front() < kPi / 2.0;
  const bool shines_up = body.table.vertical_rad.back() > kPi / 2.0;
  const bool is_box = half.z() > 0.0;
  if (shines_down || is_box) {
    add(f.x, f.y, half.x(), half.y(), half.z());
  }
  if (shines_up || is_box) {
    add(f.y, f.x, half.y(), half.x(), half.z());
  }
  if (is_box) {
    add(f.y, f.z, half.y(), half.z(), half.x());
    add(f.z, f.y, half.z(), half.y(), half.x());
    add(f.z, f.x, half.z(), half.x(), half.y());
    add(f.x, f.z, half.x(), half.z(), half.y());
  }
}

void Builder::build(const IesLightSettings& s) {
  if (s.file.empty()) {
    throw ConfigError(fmt::format("lighting.{}.file", name_), "must name an IES file");
  }
  IesBody body = {.table = read_ies(s.file), .frame = frame_of(s.placement)};
  body.size_mm = body.table.size_mm;
  body.size_mm.x() = s.length_mm > 0.0 ? s.length_mm : body.size_mm.x();
  body.size_mm.y() = s.width_mm > 0.0 ? s.width_mm : body.size_mm.y();
  // A cylinder stands for by the box of the same cross-section; a line or a point gets a width.
  body.is_round = body.table.is_round && body.size_mm.z() == 0.0;
  if (body.table.is_round) {
    const double wide = body.size_mm.head<2>().maxCoeff();
    body.size_mm.head<2>().setConstant(body.is_round ? wide : wide * std::sqrt(kPi) / 2.0);
  }
  body.size_mm.head<2>() = body.size_mm.head<2>().cwiseMax(kPointSize_mm);
  const double flux = body.table.flux();
  lights_.bodies.push_back(std::move(body));
  const int group = add_group(name_);
  add_body_faces(s, group);
  lights_.groups.back().power_w = to_channels(s.scale) * static_cast<float>(flux);
}

RigidTransform scene_from_mount_of(Mount mount, const LightMounts& mounts) {
  switch (mount) {
    case Mount::kPart:
      return mounts.scene_from_part;
    case Mount::kCamera:
      return mounts.scene_from_camera;
    case Mount::kScene:
      break;
  }
  return {};
}

}  // namespace

EmitterFrame placed_frame(const LightPlacement& p, const LightMounts& mounts) {
  const bool on_camera = p.mount == Mount::kCamera;
  const Vector3d z = p.direction.empty() ? Vector3d(0.0, 0.0, on_camera ? 1.0 : -1.0)
                                         : to_vector(p.direction).normalized();
  const Vector3d wanted = std::abs(z.x()) < 1.0 - 1e-9 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d x = (wanted - wanted.dot(z) * z).normalized();
  const Vector3d y = z.cross(x);
  const double c = std::cos(p.roll_rad);
  const double s = std::sin(p.roll_rad);
  const RigidTransform scene_from_mount = scene_from_mount_of(p.mount, mounts);
  return {.origin_mm = scene_from_mount * to_vector(p.position_mm),
          .x = scene_from_mount.rotation * (c * x + s * y),
          .y = scene_from_mount.rotation * (c * y - s * x),
          .z = scene_from_mount.rotation * z};
}

Lights build_lights(const std::vector<NamedLight>& lights,
                    const LightMounts& mounts,
                    const MeshLoader& load_mesh,
                    const std::optional<TunnelLight>& tunnel) {
  Builder builder(mounts, load_mesh);
  for (const NamedLight& light : lights) {
    builder.add(light);
  }
  if (tunnel) {
    builder.add(*tunnel);
  }
  return builder.finish();
}

}  // namespace glint
