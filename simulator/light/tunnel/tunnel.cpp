// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/tunnel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/units.h"
#include "simulator/light/tunnel/tunnel_profile.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Shape = TunnelSettings::Shape;

/// Hits nearer than this belong to the surface the ray leaves.
constexpr double kMinT_mm = 1e-3;

EllipseAxes axes_of(const TunnelSettings& s) {
  return s.shape == Shape::kSemicylinder
             ? EllipseAxes{.half_width_mm = s.radius_mm, .height_mm = s.radius_mm}
             : EllipseAxes{.half_width_mm = s.half_width_mm, .height_mm = s.height_mm};
}

Ray ray_at(const RayBlock& rays, std::size_t i) {
  return {.origin_mm = vector_of(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]),
          .direction = vector_of(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i])};
}

}  // namespace

RayBlock part_of(const RayBlock& rays, int begin, int max_count) {
  RayBlock part = rays;
  for (const float** array : {&part.origin_x,
                              &part.origin_y,
                              &part.origin_z,
                              &part.direction_x,
                              &part.direction_y,
                              &part.direction_z}) {
    *array = *array != nullptr ? *array + begin : nullptr;
  }
  part.count = std::min(max_count, rays.count - begin);
  return part;
}

Tunnel::Tunnel(const TunnelSettings& settings) : settings_(settings) {
  build_profile();
}

void Tunnel::build_profile() {
  const TunnelSettings& s = settings_;
  switch (s.shape) {
    case Shape::kFlat:
      walls_ = flat_walls(s.distance_mm, s.opening_rad, s.panel_height_mm, s.base_mm);
      for (const double side : {-1.0, 1.0}) {
        const FlatWall& wall = walls_[side < 0 ? 0 : 1];
        const Vector2d foot(wall.start_y_mm, wall.start_z_mm);
        const Vector2d top = foot + wall.length_mm * Vector2d(wall.along_y, wall.along_z);
        profile_yz_mm_.push_back(side < 0 ? foot : top);
        profile_yz_mm_.push_back(side < 0 ? top : foot);
      }
      break;
    case Shape::kFree:
      segments_ = free_segments(s.control_mm, s.base_mm);
      extended_segments_ = with_straight_ends(segments_);
      profile_yz_mm_ = sample_spline(segments_, kProfilePoints);
      break;
    default:
      profile_yz_mm_ = sample_superellipse(
          axes_of(s), s.shape == Shape::kSuperellipse ? s.exponent : 2.0, s.base_mm);
  }
  arc_mm_.assign(profile_yz_mm_.size(), 0.0);
  for (std::size_t i = 1; i < arc_mm_.size(); ++i) {
    arc_mm_[i] = arc_mm_[i - 1] + (profile_yz_mm_[i] - profile_yz_mm_[i - 1]).norm();
  }
  for (double& arc : arc_mm_) {
    arc -= 0.5 * arc_mm_.back();
  }
  // A little below, so that a level ceiling is above its own slot's floor in float, too.
  slot_floor_mm_ = 0.5 * (s.base_mm + top_mm()) - 1e-3 - 1e-5 * std::abs(top_mm());
  if (s.dark_reflectance > 0.0 && s.duty > 0.0) {
    const bool is_flat = s.shape == Shape::kFlat;
    dark_ = DarkRadiance(
        s, half_wall(), is_flat ? walls_[0].length_mm : 0.0, is_flat && panels_touch());
  }
}

/// The wall at y <= 0, from its rim to its slot or the middle.
std::vector<Vector2d> Tunnel::half_wall() const {
  const double half_slot_mm = 0.5 * settings_.slot_mm;
  std::vector<Vector2d> half;
  for (std::size_t i = 0; i < (profile_yz_mm_.size() + 1) / 2; ++i) {
    const Vector2d& point = profile_yz_mm_[i];
    if (!in_slot(point)) {
      half.push_back(point);
      continue;
    }
    if (!half.empty()) {  // where it crosses the slot's side, or its floor
      const Vector2d from = half.back();
      const bool is_beside = from.x() < -half_slot_mm;
      const double t = is_beside ? (-half_slot_mm - from.x()) / (point.x() - from.x())
                                 : (slot_floor_mm_ - from.y()) / (point.y() - from.y());
      half.emplace_back(from + t * (point - from));
    }
    break;
  }
  return half;
}

double Tunnel::half_width_mm() const {
  double width = 0.0;
  for (const Vector2d& point : profile_yz_mm_) {
    width = std::max(width, std::abs(point.x()));
  }
  return width;
}

double Tunnel::top_mm() const {
  double top = -std::numeric_limits<double>::infinity();
  for (const Vector2d& point : profile_yz_mm_) {
    top = std::max(top, point.y());
  }
  return top;
}

bool Tunnel::in_slot(const Vector2d& point) const {
  return std::abs(point.x()) < 0.5 * settings_.slot_mm && point.y() > slot_floor_mm_;
}

std::optional<double> Tunnel::hit_profile(const Vector2d& origin, const Vector2d& direction) const {
  const TunnelSettings& s = settings_;
  switch (s.shape) {
    case Shape::kFlat:
      return hit_walls(walls_, origin, direction, kMinT_mm);
    case Shape::kFree:
      return hit_segments(segments_, origin, direction, kMinT_mm);
    default:
      return hit_superellipse_exact(axes_of(s),
                                    s.shape == Shape::kSuperellipse ? s.exponent : 2.0,
                                    s.base_mm,
                                    origin,
                                    direction,
                                    kMinT_mm);
  }
}

std::size_t Tunnel::profile_piece(const Vector2d& point) const {
  if (settings_.shape == Shape::kFlat) {
    return point.x() < 0.0 ? 0 : 2;
  }
  // Seen from (0, base) the cross-section runs in one direction: control points stand at growing
  // angles, and a B-spline crosses a line no more often than its control polygon.
  const double base = settings_.base_mm;
  const double height = point.y() - base;
  const auto is_before = [&](const Vector2d& node, const Vector2d&) {
    // A point below the base line lies beyond one of the rims.
    return height < 0.0 ? point.x() > 0.0 : point.x() * (node.y() - base) - height * node.x() > 0.0;
  };
  const auto after =
      std::lower_bound(profile_yz_mm_.begin() + 1, profile_yz_mm_.end() - 1, point, is_before);
  return static_cast<std::size_t>(after - profile_yz_mm_.begin()) - 1;
}

std::optional<WallHit> Tunnel::hit(const Ray& ray) const {
  const Vector2d origin = ray.origin_mm.tail<2>();
  const Vector2d direction = ray.direction.tail<2>();
  const std::optional<double> t = hit_profile(origin, direction);
  if (!t) {
    return std::nullopt;
  }
  const Vector2d point = origin + *t * direction;
  if (in_slot(point)) {
    return std::nullopt;
  }
  return wall_hit(ray, *t);
}

WallHit Tunnel::wall_hit(const Ray& ray, double t_mm) const {
  const Vector3d point_mm = ray.origin_mm + t_mm * ray.direction;
  const Vector2d point = point_mm.tail<2>();
  const std::size_t piece = profile_piece(point);
  // The profile runs from y < 0 over the top to y > 0: the inside is on its right.
  const Vector2d along = (profile_yz_mm_[piece + 1] - profile_yz_mm_[piece]).normalized();
  // The wall's continuation below its first rim lies before the piece's beginning.
  const Vector2d from_node = point - profile_yz_mm_[piece];
  return {.t_mm = t_mm,
          .point_mm = point_mm,
          .normal = {0.0, along.y(), -along.x()},
          .arc_mm = arc_mm_[piece] + std::copysign(from_node.norm(), from_node.dot(along))};
}

void Tunnel::hit_profile(const RayBlock& rays, bool is_whole, float* t_mm) const {
  const TunnelSettings& s = settings_;
  const auto base = static_cast<float>(s.base_mm);
  const auto width = static_cast<float>(axes_of(s).half_width_mm);
  const auto height = static_cast<float>(axes_of(s).height_mm);
  switch (s.shape) {
    case Shape::kFlat:
      hit_flat(rays, walls_.data(), static_cast<int>(walls_.size()), is_whole, t_mm);
      break;
    case Shape::kFree:
      hit_spline(rays,
                 is_whole ? extended_segments_.data() : segments_.data(),
                 static_cast<int>(is_whole ? extended_segments_.size() : segments_.size()),
                 t_mm);
      break;
    case Shape::kSuperellipse:
      hit_superellipse(rays, base, width, height, static_cast<float>(s.exponent), is_whole, t_mm);
      break;
    default:
      hit_ellipse(rays, base, width, height, is_whole, t_mm);
  }
}

void Tunnel::hit_block(const RayBlock& rays, float* x_mm, float* pattern_mm, float* gain) const {
  const auto count = static_cast<std::size_t>(rays.count);
  cross_wall(rays, pattern_mm, x_mm, gain);  // t, until the array holds the pattern coordinate
  if (settings_.orientation_rad == 0.0 && !settings_.cosine_law) {
    std::copy(x_mm, x_mm + count, pattern_mm);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (gain[i] == 0.0F) {
      pattern_mm[i] = x_mm[i];
      continue;
    }
    const auto t = static_cast<double>(pattern_mm[i]);
    set_details(ray_at(rays, i), t, x_mm[i], pattern_mm[i], gain[i]);
  }
}

void Tunnel::cross_wall(const RayBlock& rays, float* t_mm, float* x_mm, float* gain) const {
  hit_profile(rays, false, t_mm);
  finish_hits(rays,
              t_mm,
              static_cast<float>(0.5 * settings_.slot_mm),
              static_cast<float>(slot_floor_mm_),
              x_mm,
              gain);
}

void Tunnel::intersect_block(const RayBlock& rays,
                             float* x_mm,
                             float* y_mm,
                             float* margin_mm) const {
  const bool is_flat = settings_.shape == Shape::kFlat;
  const auto base = static_cast<float>(is_flat ? 0.0 : settings_.base_mm);
  // A few at a time: what is read again stays in the first cache.
  constexpr int kTogether = 256;
  std::array<float, kTogether> t_mm;
  for (int begin = 0; begin < rays.count; begin += kTogether) {
    const RayBlock part = part_of(rays, begin, kTogether);
    float* const y = y_mm + begin;
    float* const margin = margin_mm + begin;
    hit_profile(part, true, t_mm.data());
    points_of_hits(part, t_mm.data(), base, x_mm + begin, y, margin);
    if (is_flat) {
      margins_of_panels(walls_[1], panels_touch(), y, part.count, margin);
    }
  }
}

void Tunnel::hit_details(const RayBlock& rays,
                         const float* x_mm,
                         const float* y_mm,
                         const float* margin_mm,
                         float* pattern_mm,
                         float* cosine) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(rays.count); ++i) {
    pattern_mm[i] = x_mm[i];
    cosine[i] = 1.0F;
    if (margin_mm[i] == kNoHitMargin_mm) {
      continue;
    }
    const Ray ray = ray_at(rays, i);
    set_details(ray, distance_to(ray, y_mm[i], margin_mm[i]), x_mm[i], pattern_mm[i], cosine[i]);
  }
}

/// @param cosine  left alone without cosine law
void Tunnel::set_details(
    const Ray& ray, double t_mm, float x_mm, float& pattern_mm, float& cosine) const {
  const WallHit found = wall_hit(ray, t_mm);
  const double turn = settings_.orientation_rad;
  pattern_mm = static_cast<float>(static_cast<double>(x_mm) * std::cos(turn) +
                                  found.arc_mm * std::sin(turn));
  if (settings_.cosine_law) {
    cosine = static_cast<float>(std::abs(found.normal.dot(ray.direction)) / ray.direction.norm());
  }
}

/// Along a ray to where intersect_block() tells that it meets the wall.
double Tunnel::distance_to(const Ray& ray, float y_mm, float margin_mm) const {
  const Vector2d origin = ray.origin_mm.tail<2>();
  const Vector2d direction = ray.direction.tail<2>();
  if (settings_.shape == Shape::kFlat) {  // where margins do not tell heights
    const FlatWall& wall = walls_[y_mm < 0.0F ? 0 : 1];
    const Vector2d normal(wall.normal_y, wall.normal_z);
    return (wall.offset_mm - normal.dot(origin)) / normal.dot(direction);
  }
  const Vector2d point(static_cast<double>(y_mm),
                       settings_.base_mm + static_cast<double>(margin_mm));
  return (point - origin).dot(direction) / direction.squaredNorm();
}

bool Tunnel::panels_touch() const {
  const double sine = std::sin(0.5 * settings_.opening_rad);
  return settings_.panel_height_mm * sine >= settings_.distance_mm * (1.0 - 1e-9);
}

double Tunnel::to_edge_mm(const Vector2d& point) const {
  // Positive beside the slot.
  const double to_slot =
      std::max(std::abs(point.x()) - 0.5 * settings_.slot_mm, slot_floor_mm_ - point.y());
  return std::min(std::abs(to_slot), std::abs(to_rim_mm(point)));
}

/// The same, the slot left aside.
double Tunnel::to_rim_mm(const Vector2d& point) const {
  if (settings_.shape != Shape::kFlat) {
    return point.y() - settings_.base_mm;
  }
  const FlatWall& wall = walls_[point.x() < 0.0 ? 0 : 1];
  const Vector2d from_foot = point - Vector2d(wall.start_y_mm, wall.start_z_mm);
  const double along = from_foot.dot(Vector2d(wall.along_y, wall.along_z));
  return panels_touch() ? along : std::min(along, wall.length_mm - along);
}

StripePattern Tunnel::pattern(double shift_mm) const {
  const TunnelSettings& s = settings_;
  return {.shift_x_mm = static_cast<float>(shift_mm),
          // Whole periods are taken off in double: a float keeps too few digits of a long way.
          .shift_pattern_mm = static_cast<float>(
              std::remainder(shift_mm * std::cos(s.orientation_rad) + s.offset_mm, s.period_mm)),
          .periods_per_mm = static_cast<float>(1.0 / s.period_mm),
          .duty = static_cast<float>(s.duty),
          .dark = static_cast<float>(dark_.is_even() ? dark_.mean() : 0.0),
          .half_length_mm = static_cast<float>(0.5 * s.length_mm),
          .led_ripple = static_cast<float>(s.led_ripple),
          .led_per_mm = static_cast<float>(1.0 / s.led_pitch_mm),
          .end_falloff = static_cast<float>(s.end_falloff)};
}

bool Tunnel::contains(double y_mm, double z_mm) const {
  if (settings_.shape == Shape::kFlat) {
    return std::ranges::all_of(walls_, [&](const FlatWall& wall) {
      return wall.normal_y * y_mm + wall.normal_z * z_mm < wall.offset_mm;
    });
  }
  const Vector2d offset(y_mm, z_mm - settings_.base_mm);
  if (offset.y() <= 0.0) {
    return std::abs(y_mm) < std::abs(profile_yz_mm_.front().x());
  }
  const std::optional<double> t = hit_profile({0.0, settings_.base_mm}, offset);
  return offset.norm() < kMinT_mm || (t && *t > 1.0);
}

std::vector<std::vector<Vector2d>> Tunnel::outline(double max_step_mm) const {
  std::vector<std::vector<Vector2d>> lines(1);
  Vector2d last = profile_yz_mm_.front();
  for (std::size_t i = 0; i < profile_yz_mm_.size(); ++i) {
    const Vector2d& point = profile_yz_mm_[i];
    const bool starts_second_panel = settings_.shape == Shape::kFlat && i == 2;
    if (in_slot(point) || starts_second_panel) {
      if (!lines.back().empty()) {
        lines.emplace_back();
      }
      if (in_slot(point)) {
        continue;
      }
    }
    const bool is_end = i == 0 || i + 1 == profile_yz_mm_.size() ||
                        settings_.shape == Shape::kFlat || in_slot(profile_yz_mm_[i + 1]) ||
                        lines.back().empty();
    if (is_end || (point - last).norm() >= max_step_mm) {
      lines.back().push_back(point);
      last = point;
    }
  }
  std::erase_if(lines, [](const auto& line) { return line.size() < 2; });
  return lines;
}

}  // namespace glint
