// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/units.h"
#include "simulator/light/tunnel_profile.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Shape = TunnelSettings::Shape;

constexpr std::array<std::string_view, 5> kShapeNames = {
    "flat", "semicylinder", "ellipse", "superellipse", "free"};

/// Hits nearer than this belong to the surface the ray leaves.
constexpr double kMinT_mm = 1e-3;

EllipseAxes axes_of(const TunnelSettings& s) {
  return s.shape == Shape::kSemicylinder
             ? EllipseAxes{.half_width_mm = s.radius_mm, .height_mm = s.radius_mm}
             : EllipseAxes{.half_width_mm = s.half_width_mm, .height_mm = s.height_mm};
}

}  // namespace

std::string_view shape_name(Shape shape) {
  return kShapeNames[static_cast<std::size_t>(shape)];
}

void visit_keys(KeyVisitor& keys, TunnelSettings& s) {
  const Range size = {.min = 1, .max = 1e5};
  keys.choice("shape", s.shape, kShapeNames, "cross-section of the luminous wall");
  keys.number("base_mm",
              s.base_mm,
              Range::between(-1e4, 1e4),
              "height of the cross-section's lower line above the part's origin");
  keys.number("radius_mm", s.radius_mm, size, "semicylinder: radius");
  keys.number("half_width_mm", s.half_width_mm, size, "ellipse, superellipse: half axis along y");
  keys.number("height_mm", s.height_mm, size, "ellipse, superellipse: half axis along z");
  keys.number("exponent",
              s.exponent,
              Range::between(1, 20),
              "superellipse: 2 = ellipse, larger = closer to a rectangle");
  keys.number(
      "distance_mm", s.distance_mm, size, "flat: from the middle plane to the foot of each panel");
  keys.number("opening_deg",
              s.opening_rad,
              Range::between(0, 180),
              "flat: full angle between the panels, 0 = parallel upright, 180 = a ceiling");
  keys.number("panel_height_mm", s.panel_height_mm, size, "flat: size of a panel across x");
  keys.numbers("control_mm",
               s.control_mm,
               {.min = 3, .max = 16},
               size,
               "free: distances of the B-spline's control points from the base line, at equal "
               "angles from the rim to the top");
  keys.number("length_mm", s.length_mm, size, "size along the tunnel axis");
  keys.number("slot_mm",
              s.slot_mm,
              Range::between(0, 1e5),
              "width of the camera slot along the top, 0 = none");
  keys.number("period_mm", s.period_mm, Range{.min = 1e-3, .max = 1e5}, "of the stripes");
  keys.number("duty", s.duty, Range::between(0, 1), "bright share of a period");
  keys.number("orientation_deg",
              s.orientation_rad,
              Range::between(-90, 90),
              "of the stripes on the unrolled wall, 0 = across the tunnel axis");
  keys.number("offset_mm", s.offset_mm, Range{}, "shift of the stripes along their normal");
  keys.number("dark_reflectance",
              s.dark_reflectance,
              Range::between(0, 0.99),
              "diffuse reflectance of dark stripes, lit by the bright ones");
  keys.number("led_ripple",
              s.led_ripple,
              Range::between(0, 1),
              "relative ripple of the radiance along x from the spacing of LEDs or tubes");
  keys.number("led_pitch_mm", s.led_pitch_mm, size, "spacing of LEDs or tubes along x");
  keys.number("end_falloff",
              s.end_falloff,
              Range::between(0, 1),
              "relative loss of radiance at the tunnel's ends, quadratic along x");
  keys.boolean("blocks_view",
               s.blocks_view,
               "whether the wall hides the part from the camera except through the slot");
  keys.boolean("cosine_law",
               s.cosine_law,
               "compatibility: multiplies the radiance by the cosine at the wall, which counts it "
               "twice for a Lambertian wall");
  const double half_width = s.shape == Shape::kFlat ? s.distance_mm
                            : s.shape == Shape::kFree
                                ? *std::max_element(s.control_mm.begin(), s.control_mm.end())
                                : axes_of(s).half_width_mm;
  keys.require(s.slot_mm < 2.0 * half_width,
               "slot_mm",
               fmt::format("is {:g}, must be smaller than the tunnel, which is {:g} mm wide",
                           s.slot_mm,
                           2.0 * half_width));
}

Tunnel::Tunnel(const TunnelSettings& settings) : settings_(settings) {
  build_profile();
}

void Tunnel::build_profile() {
  constexpr int kProfilePoints = 2049;
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
      profile_yz_mm_ = sample_spline(segments_, kProfilePoints);
      break;
    default:
      profile_yz_mm_ = sample_superellipse(axes_of(s),
                                           s.shape == Shape::kSuperellipse ? s.exponent : 2.0,
                                           s.base_mm,
                                           kProfilePoints);
  }
  arc_mm_.assign(profile_yz_mm_.size(), 0.0);
  for (std::size_t i = 1; i < arc_mm_.size(); ++i) {
    arc_mm_[i] = arc_mm_[i - 1] + (profile_yz_mm_[i] - profile_yz_mm_[i - 1]).norm();
  }
  for (double& arc : arc_mm_) {
    arc -= 0.5 * arc_mm_.back();
  }
  slot_floor_mm_ = s.base_mm + 0.5 * (top_mm() - s.base_mm) - 1e-6;
  const double share = wall_share(profile_yz_mm_, s.base_mm);
  const double fill = s.dark_reflectance * s.duty * share;
  dark_radiance_ = fill / (1.0 - fill);
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

Vector2d Tunnel::profile_normal(const Vector2d& point) const {
  // The dense profile is fine enough for a direction: its steps are below a thousandth of a radian.
  std::size_t best = 0;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < profile_yz_mm_.size(); ++i) {
    if (settings_.shape == Shape::kFlat && i == 1) {
      continue;  // the gap between the panels
    }
    const Vector2d step = profile_yz_mm_[i + 1] - profile_yz_mm_[i];
    const double along =
        std::clamp((point - profile_yz_mm_[i]).dot(step) / step.squaredNorm(), 0.0, 1.0);
    const double distance = (profile_yz_mm_[i] + along * step - point).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = i;
    }
  }
  const Vector2d step = (profile_yz_mm_[best + 1] - profile_yz_mm_[best]).normalized();
  return {step.y(), -step.x()};  // the profile runs from y < 0 over the top: inside is on its right
}

double Tunnel::arc_at(const Vector2d& point) const {
  if (settings_.shape == Shape::kFlat) {
    const std::size_t first = point.x() < 0.0 ? 0 : 2;
    return arc_mm_[first] + (point - profile_yz_mm_[first]).norm();
  }
  const auto angle_of = [&](const Vector2d& p) {
    return std::atan2(p.x(), p.y() - settings_.base_mm);
  };
  const double angle = angle_of(point);
  const auto after = std::lower_bound(profile_yz_mm_.begin() + 1,
                                      profile_yz_mm_.end() - 1,
                                      angle,
                                      [&](const Vector2d& p, double a) { return angle_of(p) < a; });
  const auto i = static_cast<std::size_t>(after - profile_yz_mm_.begin());
  return arc_mm_[i - 1] + (point - profile_yz_mm_[i - 1]).norm();
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
  const Vector2d normal = profile_normal(point);
  return WallHit{.t_mm = *t,
                 .point_mm = ray.origin_mm + *t * ray.direction,
                 .normal = {0.0, normal.x(), normal.y()},
                 .arc_mm = arc_at(point)};
}

void Tunnel::hit_profile(const RayBlock& rays, float* t_mm) const {
  const TunnelSettings& s = settings_;
  const auto base = static_cast<float>(s.base_mm);
  const auto width = static_cast<float>(axes_of(s).half_width_mm);
  const auto height = static_cast<float>(axes_of(s).height_mm);
  switch (s.shape) {
    case Shape::kFlat:
      hit_flat(rays, walls_.data(), static_cast<int>(walls_.size()), t_mm);
      break;
    case Shape::kFree:
      hit_spline(rays, segments_.data(), static_cast<int>(segments_.size()), t_mm);
      break;
    case Shape::kSuperellipse:
      hit_superellipse(rays, base, width, height, static_cast<float>(s.exponent), t_mm);
      break;
    default:
      hit_ellipse(rays, base, width, height, t_mm);
  }
}

void Tunnel::hit_block(const RayBlock& rays, float* x_mm, float* pattern_mm, float* gain) const {
  const auto count = static_cast<std::size_t>(rays.count);
  const bool is_plain = settings_.orientation_rad == 0.0 && !settings_.cosine_law;
  if (is_plain) {
    hit_profile(rays, pattern_mm);  // the array holds t until it holds the pattern coordinate
    finish_hits(rays,
                pattern_mm,
                static_cast<float>(0.5 * settings_.slot_mm),
                static_cast<float>(slot_floor_mm_),
                x_mm,
                gain);
    std::copy(x_mm, x_mm + count, pattern_mm);
    return;
  }
  const double cosine = std::cos(settings_.orientation_rad);
  const double sine = std::sin(settings_.orientation_rad);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d direction =
        vector_of(rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]);
    const std::optional<WallHit> found =
        hit({.origin_mm = vector_of(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]),
             .direction = direction});
    if (!found) {
      x_mm[i] = pattern_mm[i] = gain[i] = 0.0F;
      continue;
    }
    x_mm[i] = static_cast<float>(found->point_mm.x());
    pattern_mm[i] = static_cast<float>(found->point_mm.x() * cosine + found->arc_mm * sine);
    const double at_wall = std::abs(found->normal.dot(direction)) / direction.norm();
    gain[i] = settings_.cosine_law ? static_cast<float>(at_wall) : 1.0F;
  }
}

void Tunnel::hidden_block(const RayBlock& points, const Vector3d& camera_mm, float* hidden) const {
  const auto count = static_cast<std::size_t>(points.count);
  if (!settings_.blocks_view) {
    std::fill(hidden, hidden + count, 0.0F);
    return;
  }
  std::vector<float> to_x(count);
  std::vector<float> to_y(count);
  std::vector<float> to_z(count);
  for (std::size_t i = 0; i < count; ++i) {
    to_x[i] = static_cast<float>(camera_mm.x()) - points.origin_x[i];
    to_y[i] = static_cast<float>(camera_mm.y()) - points.origin_y[i];
    to_z[i] = static_cast<float>(camera_mm.z()) - points.origin_z[i];
  }
  RayBlock sight = points;
  sight.direction_x = to_x.data();
  sight.direction_y = to_y.data();
  sight.direction_z = to_z.data();
  std::vector<float> t(count);
  std::vector<float> x(count);
  hit_profile(sight, t.data());
  finish_hits(sight,
              t.data(),
              static_cast<float>(0.5 * settings_.slot_mm),
              static_cast<float>(slot_floor_mm_),
              x.data(),
              hidden);
  const auto half_length = static_cast<float>(0.5 * settings_.length_mm);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_before_camera = t[i] < 1.0F;
    const bool is_within_ends = std::abs(x[i]) < half_length;
    hidden[i] = is_before_camera && is_within_ends ? hidden[i] : 0.0F;
  }
}

StripePattern Tunnel::pattern(double shift_mm) const {
  const TunnelSettings& s = settings_;
  return {.shift_x_mm = static_cast<float>(shift_mm),
          .shift_pattern_mm = static_cast<float>(shift_mm * std::cos(s.orientation_rad)),
          .periods_per_mm = static_cast<float>(1.0 / s.period_mm),
          .phase = static_cast<float>(-s.offset_mm / s.period_mm),
          .duty = static_cast<float>(s.duty),
          .dark = static_cast<float>(dark_radiance_),
          .half_length_mm = static_cast<float>(0.5 * s.length_mm),
          .led_ripple = static_cast<float>(s.led_ripple),
          .led_per_mm = static_cast<float>(1.0 / s.led_pitch_mm),
          .end_falloff = static_cast<float>(s.end_falloff)};
}

bool Tunnel::contains(double y_mm, double z_mm) const {
  const Vector2d point(y_mm, z_mm);
  if (settings_.shape == Shape::kFlat) {
    return std::ranges::all_of(walls_, [&](const FlatWall& wall) {
      return wall.normal_y * y_mm + wall.normal_z * z_mm < wall.offset_mm;
    });
  }
  const Vector2d centre(0.0, settings_.base_mm);
  if (z_mm <= settings_.base_mm) {
    return std::abs(y_mm) < std::abs(profile_yz_mm_.front().x());
  }
  const Vector2d offset = point - centre;
  const std::optional<double> t = hit_profile(centre, offset);
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
