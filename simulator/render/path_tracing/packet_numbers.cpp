// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/path_tracing/packet_numbers.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "simulator/material/multiple_scattering.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Half vectors are good to 1e-7 in float; slopes narrower than this would feel it.
constexpr double kMinAlphaOfFloat = 5e-3;

float to_float(double value) {
  return static_cast<float>(value);
}

void set_colour(const Colour& from, float* to) {
  for (Eigen::Index c = 0; c < 3; ++c) {
    to[c] = to_float(from[c]);
  }
}

void set_compensation(const Conductor& metal, const DirectionTable& table, ConductorNumbers& m) {
  m.columns = table.columns();
  m.knee = to_float(table.knee());
  m.rows_per_log = to_float((DirectionTable::kRows - 1) / table.scale());
  std::ranges::transform(table.values(), m.albedo, to_float);
  const double average = metal.albedo->average(1.0);
  const Colour colour = compensation_colour(metal.fresnel.average, average);
  set_colour(colour * metal.tint, m.compensation);
  m.compensation_strength = to_float(strength(colour));
  m.single_strength = to_float(strength(metal.fresnel.average));
  m.per_lost = to_float(compensation_brdf(0.0, 0.0, average));
  const CompensationSampler& losses = metal.albedo->losses(1.0);
  m.loss_knee = to_float(losses.knee());
  m.loss_scale = to_float(losses.scale());
  double below = 0.0;
  for (std::size_t i = 0; i < losses.mass().size(); ++i) {
    m.mass[i] = to_float(losses.mass()[i]);
    m.mass_below[i] = to_float(below);
    below += losses.mass()[i];
  }
}

}  // namespace

std::optional<ConductorNumbers> conductor_numbers(const Material& material) {
  static_assert(ConductorNumbers::kRows == DirectionTable::kRows);
  static_assert(ConductorNumbers::kCells == CompensationSampler::kCells);
  const auto* metal = std::get_if<Conductor>(&material);
  if (metal == nullptr || std::min(metal->alpha.x, metal->alpha.y) < kMinAlphaOfFloat) {
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
    if (table == nullptr || table->columns() > ConductorNumbers::kMaxColumns) {
      return std::nullopt;
    }
    set_compensation(*metal, *table, m);
  }
  return m;
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
