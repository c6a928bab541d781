// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/packet_numbers.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "simulator/material/regained.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Half vectors are good to 1e-7 in float; slopes narrower than this would feel it.
constexpr double kLeastAlpha = 5e-3;
/// Rings are flat up to this tilt, as in emitter_shape.cpp.
constexpr double kFlat_rad = 1e-9;
/// Less steep cones are too near to a plane for float: their sheets are told apart by height.
constexpr double kLeastTilt_rad = 1e-3;

float to_float(double value) {
  return static_cast<float>(value);
}

void set_colour(const Colour& from, float* to) {
  for (Eigen::Index c = 0; c < 3; ++c) {
    to[c] = to_float(from[c]);
  }
}

void set_regained(const Conductor& metal, const DirectionTable& table, ConductorNumbers& m) {
  m.columns = table.columns();
  m.knee = to_float(table.knee());
  m.rows_per_log = to_float((DirectionTable::kRows - 1) / table.scale());
  std::ranges::transform(table.values(), m.albedo, to_float);
  const double average = metal.albedo->average(1.0);
  const Colour colour = regained_colour(metal.fresnel.average, average);
  set_colour(colour * metal.tint, m.regained);
  m.regained_strength = to_float(strength(colour));
  m.single_strength = to_float(strength(metal.fresnel.average));
  m.per_lost = to_float(regained_brdf(0.0, 0.0, average));
  const LossSampler& losses = metal.albedo->losses(1.0);
  m.loss_knee = to_float(losses.knee());
  m.loss_scale = to_float(losses.scale());
  double below = 0.0;
  for (std::size_t i = 0; i < losses.mass().size(); ++i) {
    m.mass[i] = to_float(losses.mass()[i]);
    m.mass_below[i] = to_float(below);
    below += losses.mass()[i];
  }
}

bool is_flat(const RingShape& ring) {
  return std::abs(ring.tilt_rad) <= kFlat_rad;
}

bool is_ring(const Emitter& emitter) {
  const auto* ring = std::get_if<RingShape>(&emitter.shape);
  return ring != nullptr && (is_flat(*ring) || std::abs(ring->tilt_rad) >= kLeastTilt_rad) &&
         emitter.body < 0 && emitter.is_drawn;
}

/// Sectors of one tilted ring.
bool is_same_cone(const RingShape& a, const RingShape& b) {
  return !is_flat(a) && a.tilt_rad == b.tilt_rad && a.middle_radius_mm == b.middle_radius_mm &&
         a.width_mm == b.width_mm && a.frame.origin_mm == b.frame.origin_mm &&
         a.frame.x == b.frame.x && a.frame.y == b.frame.y && a.frame.z == b.frame.z;
}

/// As pseudo_angle() of the kernels.
double pseudo_angle(double angle_rad) {
  const double x = std::cos(angle_rad);
  const double y = std::sin(angle_rad);
  const double share = x / (std::abs(x) + std::abs(y));
  return y >= 0.0 ? 1.0 - share : 3.0 + share;
}

void set_shape(const RingShape& ring, std::size_t e, RingLights& to) {
  const EmitterFrame& f = ring.frame;
  to.origin_x[e] = to_float(f.origin_mm.x());
  to.origin_y[e] = to_float(f.origin_mm.y());
  to.origin_z[e] = to_float(f.origin_mm.z());
  to.x_x[e] = to_float(f.x.x());
  to.x_y[e] = to_float(f.x.y());
  to.x_z[e] = to_float(f.x.z());
  to.y_x[e] = to_float(f.y.x());
  to.y_y[e] = to_float(f.y.y());
  to.y_z[e] = to_float(f.y.z());
  to.z_x[e] = to_float(f.z.x());
  to.z_y[e] = to_float(f.z.y());
  to.z_z[e] = to_float(f.z.z());
  to.inner_squared[e] = to_float(ring.inner_radius_mm() * ring.inner_radius_mm());
  to.outer_squared[e] = to_float(ring.outer_radius_mm() * ring.outer_radius_mm());
  to.middle[e] = to_float(ring.middle_radius_mm);
  to.width[e] = to_float(ring.width_mm);
  to.tilt_cosine[e] = is_flat(ring) ? 1.0F : to_float(std::cos(ring.tilt_rad));
  to.tilt_sine[e] = is_flat(ring) ? 0.0F : to_float(std::sin(ring.tilt_rad));
  to.has_tilts = to.has_tilts || !is_flat(ring);
  const double first = ring.first_rad / (2.0 * kPi);
  to.first_turns[e] = to_float(first - std::floor(first));
  to.span_turns[e] = to_float(std::min(1.0, ring.span_rad / (2.0 * kPi)));
  to.first_cosine[e] = to_float(std::cos(ring.first_rad));
  to.first_sine[e] = to_float(std::sin(ring.first_rad));
  const bool is_whole = ring.span_rad >= 2.0 * kPi;
  to.span_pseudo[e] = is_whole ? 5.0F : to_float(pseudo_angle(ring.span_rad));
}

void set_light(const Emitter& emitter, std::size_t e, RingLights& to) {
  const double area = area_mm2(emitter.shape);
  to.per_area[e] = to_float(1.0 / area);
  for (std::size_t c = 0; c < 3; ++c) {
    to.radiance[c][e] = emitter.radiance[static_cast<Eigen::Index>(c)];
  }
  to.exponent[e] = to_float(emitter.exponent - 1.0);
  to.has_lobes = to.has_lobes || emitter.exponent != 1.0;
  to.solid[e] = emitter.is_solid ? 1.0F : 0.0F;
  to.group[e] = emitter.group;
  const Eigen::AlignedBox3d box = bounds_mm(emitter.shape);
  const Vector3d centre = box.center();
  to.box_x[e] = to_float(centre.x());
  to.box_y[e] = to_float(centre.y());
  to.box_z[e] = to_float(centre.z());
  to.box_radius[e] = to_float(0.5 * box.diagonal().norm());
  to.intensity[e] = to_float(static_cast<double>(emitter.radiance.mean()) * area * kM2PerMm2);
  const NormalCone cone = normal_cone(emitter.shape);
  to.axis_x[e] = to_float(cone.axis.x());
  to.axis_y[e] = to_float(cone.axis.y());
  to.axis_z[e] = to_float(cone.axis.z());
  to.cone_cosine[e] = to_float(std::cos(cone.half_angle_rad));
  to.cone_sine[e] = to_float(std::sin(cone.half_angle_rad));
}

}  // namespace

std::optional<ConductorNumbers> conductor_numbers(const Material& material) {
  static_assert(ConductorNumbers::kRows == DirectionTable::kRows);
  static_assert(ConductorNumbers::kCells == LossSampler::kCells);
  const auto* metal = std::get_if<Conductor>(&material);
  if (metal == nullptr || std::min(metal->alpha.x, metal->alpha.y) < kLeastAlpha) {
    return std::nullopt;
  }
  ConductorNumbers m;
  m.alpha_x = to_float(metal->alpha.x);
  m.alpha_y = to_float(metal->alpha.y);
  m.fresnel = metal->fresnel.kind == Fresnel::Kind::kConstant ? ConductorNumbers::Fresnel::kConstant
              : metal->fresnel.kind == Fresnel::Kind::kSchlick
                  ? ConductorNumbers::Fresnel::kSchlick
                  : ConductorNumbers::Fresnel::kConductor;
  set_colour(metal->fresnel.normal, m.normal);
  set_colour(metal->fresnel.n, m.n);
  set_colour(metal->fresnel.k, m.k);
  set_colour(metal->tint, m.tint);
  if (metal->albedo != nullptr) {
    const DirectionTable* table = metal->albedo->only_table();
    if (table == nullptr || table->columns() > ConductorNumbers::kMostColumns) {
      return std::nullopt;
    }
    set_regained(*metal, *table, m);
  }
  return m;
}

std::optional<RingLights> ring_numbers(const Lights& lights) {
  if (lights.environment || lights.wall || lights.emitters.empty() ||
      lights.emitters.size() > RingLights::kMost ||
      !std::ranges::all_of(lights.emitters, is_ring)) {
    return std::nullopt;
  }
  RingLights rings;
  const std::vector<int> order = lights.tree.order();
  rings.count = static_cast<int>(order.size());
  for (std::size_t e = 0; e < order.size(); ++e) {
    const Emitter& emitter = lights.emitters[static_cast<std::size_t>(order[e])];
    const auto& ring = std::get<RingShape>(emitter.shape);
    set_shape(ring, e, rings);
    set_light(emitter, e, rings);
    if (e > 0) {
      const Emitter& before = lights.emitters[static_cast<std::size_t>(order[e - 1])];
      rings.same_cone[e] = is_same_cone(ring, std::get<RingShape>(before.shape)) ? 1 : 0;
    }
  }
  return rings;
}

LayNumbers lay_numbers(const SurfaceMaterial& material, const RigidTransform& scene_from_part) {
  using Kind = LaySettings::Kind;
  const LaySettings& lay = material.lay();
  const LayPlane& plane = material.lay_plane();
  const Vector3d u = scene_from_part.rotation * plane.u;
  const Vector3d v = scene_from_part.rotation * plane.v;
  const Vector3d centre = scene_from_part * plane.center_mm;
  LayNumbers n;
  n.kind = lay.kind == Kind::kTurned   ? LayNumbers::Kind::kTurned
           : lay.kind == Kind::kMilled ? LayNumbers::Kind::kMilled
                                       : LayNumbers::Kind::kStraight;
  set_colour(u.array(), n.u);
  set_colour(v.array(), n.v);
  n.centre_u_mm = to_float(u.dot(centre));
  n.centre_v_mm = to_float(v.dot(centre));
  n.lane_mm = to_float(lay.lane_mm);
  n.radius_mm = to_float(lay.mill_radius_mm);
  for (Eigen::Index row = 0; row < 3; ++row) {
    set_colour(scene_from_part.rotation.row(row).transpose().array(), n.part + 3 * row);
  }
  return n;
}

std::optional<CameraNumbers> camera_numbers(const PhysicalScene& scene) {
  const PinholeIntrinsics& in = scene.camera.intrinsics();
  const auto is_zero = [](double k) { return k == 0.0; };
  if (!std::ranges::all_of(in.radial, is_zero) || !std::ranges::all_of(in.tangential, is_zero)) {
    return std::nullopt;
  }
  const RigidTransform pose = inverse(scene.camera_from_world);
  CameraNumbers c;
  c.per_focal_x = to_float(1.0 / in.focal_px.x());
  c.per_focal_y = to_float(1.0 / in.focal_px.y());
  c.aperture_mm = to_float(scene.lens.aperture_mm);
  c.per_focus = to_float(1.0 / scene.lens.focus_mm);
  set_colour(pose.translation_mm.array(), c.origin);
  for (Eigen::Index row = 0; row < 3; ++row) {
    set_colour(pose.rotation.row(row).transpose().array(), c.rotation + 3 * row);
  }
  return c;
}

}  // namespace glint
