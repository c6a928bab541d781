// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/parametric_gear.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/units.h"
#include "simulator/geometry/part/exact_surface.h"
#include "simulator/geometry/part/parametric_builder.h"

namespace glint::parametric {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Involute of an angle: tan a - a, here of the roll angle T = tan a.
double involute_of_roll(double roll_rad) {
  return roll_rad - std::atan(roll_rad);
}

double roll_at(double radius_mm, double base_radius_mm) {
  const double ratio = radius_mm / base_radius_mm;
  return std::sqrt(std::max(0.0, ratio * ratio - 1.0));
}

/// A point of a flank: its radius and how far it has turned towards the tooth's centre line.
struct FlankPoint {
  double radius_mm = 0.0;
  double turn_rad = 0.0;
};

/// Points from root to tip. Steps are even in roll^(3/2), which spreads the chord error evenly:
/// sagitta = r_b roll droll^2 / 8.
std::vector<FlankPoint> flank_points(const GearGeometry& gear, double chord_mm) {
  std::vector<FlankPoint> points;
  if (gear.root_radius_mm < gear.base_radius_mm) {
    points.push_back({.radius_mm = gear.root_radius_mm, .turn_rad = 0.0});
  }
  const double first = std::pow(gear.root_roll_rad, 1.5);
  const double last = std::pow(gear.tip_roll_rad, 1.5);
  const double step = 1.5 * std::sqrt(6.0 * chord_mm / gear.base_radius_mm);
  const int count = std::max(2, static_cast<int>(std::ceil((last - first) / step)));
  for (int i = 0; i <= count; ++i) {
    const double roll = std::pow(first + (last - first) * i / count, 2.0 / 3.0);
    points.push_back({.radius_mm = gear.base_radius_mm * std::hypot(1.0, roll),
                      .turn_rad = involute_of_roll(roll)});
  }
  return points;
}

/// Outline of the gear with the places in it that the end faces need.
struct Outline {
  Profile profile;
  int flank = 0;  ///< points on a flank
  int tip = 0;    ///< points between two flanks at the tip
  int root = 0;   ///< points between two flanks at the root

  int per_tooth() const { return 2 * flank + tip + root; }
};

class OutlineMaker {
 public:
  OutlineMaker(const GearGeometry& gear,
               const GearSettings& settings,
               double chord_mm,
               Builder& builder)
      : gear_(gear),
        settings_(settings),
        chord_mm_(chord_mm),
        builder_(builder),
        flank_(flank_points(gear, chord_mm)) {}

  Outline make() {
    const std::int32_t tip =
        builder_.add_patch({.shape = CylinderPatch{.radius_mm = gear_.tip_radius_mm}});
    const std::int32_t root =
        builder_.add_patch({.shape = CylinderPatch{.radius_mm = gear_.root_radius_mm}});
    const int num_tip = arc_segments(gear_.tip_radius_mm, 2.0 * gear_.half_tip_rad, chord_mm_);
    const int num_root = arc_segments(gear_.root_radius_mm, 2.0 * gear_.half_gap_rad, chord_mm_);
    outline_.flank = static_cast<int>(flank_.size());
    outline_.tip = num_tip - 1;
    outline_.root = num_root - 1;
    const double pitch_rad = 2.0 * kPi / settings_.teeth;
    for (int tooth = 0; tooth < settings_.teeth; ++tooth) {
      const double centre_rad = 0.5 * kPi + tooth * pitch_rad;
      add_flank(centre_rad - gear_.half_tooth_rad, 1.0, tip);
      add_arc(gear_.tip_radius_mm,
              centre_rad - gear_.half_tip_rad,
              2.0 * gear_.half_tip_rad,
              num_tip,
              tip);
      add_flank(centre_rad + gear_.half_tooth_rad, -1.0, root);
      add_arc(gear_.root_radius_mm,
              centre_rad + 0.5 * pitch_rad - gear_.half_gap_rad,
              2.0 * gear_.half_gap_rad,
              num_root,
              root);
    }
    return std::move(outline_);
  }

 private:
  void add_point(double radius_mm, double angle_rad, std::int32_t patch) {
    outline_.profile.points_mm.emplace_back(radius_mm * std::cos(angle_rad),
                                            radius_mm * std::sin(angle_rad));
    outline_.profile.patches.push_back(patch);
  }

  /// hand +1: from root to tip; -1: from tip to root. The arc that follows belongs to next_patch.
  void add_flank(double start_rad, double hand, std::int32_t next_patch) {
    const std::int32_t patch = builder_.add_patch(
        {.shape = InvolutePatch{
             .base_radius_mm = gear_.base_radius_mm, .start_rad = start_rad, .hand = hand}});
    for (std::size_t i = 0; i < flank_.size(); ++i) {
      const FlankPoint& point = hand > 0.0 ? flank_[i] : flank_[flank_.size() - 1 - i];
      add_point(point.radius_mm,
                start_rad + hand * point.turn_rad,
                i + 1 < flank_.size() ? patch : next_patch);
    }
  }

  /// The points of an arc between its ends.
  void add_arc(double radius_mm, double from_rad, double angle_rad, int count, std::int32_t patch) {
    for (int i = 1; i < count; ++i) {
      add_point(radius_mm, from_rad + angle_rad * i / count, patch);
    }
  }

  const GearGeometry& gear_;
  const GearSettings& settings_;
  double chord_mm_ = 0.0;
  Builder& builder_;
  std::vector<FlankPoint> flank_;
  Outline outline_;
};

Profile circle(double radius_mm, double chord_mm, std::int32_t patch) {
  const int count = std::max(8, arc_segments(radius_mm, 2.0 * kPi, chord_mm));
  Profile profile;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    profile.points_mm.emplace_back(radius_mm * std::cos(angle), radius_mm * std::sin(angle));
  }
  profile.patches.assign(profile.points_mm.size(), patch);
  return profile;
}

/// One end face. The loops run counter-clockwise seen from +x; at the back (-x) triangles turn.
class EndFace {
 public:
  EndFace(Builder& builder, const Outline& outline, const Loop& rim, bool is_front, double x_mm)
      : builder_(builder), outline_(outline), rim_(rim), is_front_(is_front), x_mm_(x_mm) {
    patch_ = builder.add_plane({x_mm, 0.0, 0.0}, Vector3d(is_front ? 1.0 : -1.0, 0.0, 0.0));
  }

  /// @param bore empty for a gear without a hole
  void fill(int teeth, const Loop& bore) {
    Loop root;
    for (int tooth = 0; tooth < teeth; ++tooth) {
      fill_tooth(tooth);
      add_root(tooth, root);
    }
    set_angles(root);
    if (bore.vertices.empty()) {
      fan(builder_,
          is_front_ ? root : reversed(root),
          builder_.add_vertex({x_mm_, 0.0, 0.0}),
          patch_);
      return;
    }
    Loop hole = bore;
    rotate_to(hole, root);
    if (is_front_) {
      stitch(builder_, root, hole, patch_);
    } else {
      stitch(builder_, reversed(root), reversed(hole), patch_);
    }
  }

 private:
  std::int32_t rim_at(int tooth, int i) const {
    return rim_.vertices[static_cast<std::size_t>(tooth * outline_.per_tooth() + i)];
  }

  void add(std::int32_t a, std::int32_t b, std::int32_t c) {
    builder_.add_triangle(a, is_front_ ? b : c, is_front_ ? c : b, patch_);
  }

  /// Ladder between the two flanks, then a fan under the tip's arc.
  void fill_tooth(int tooth) {
    const int last = outline_.flank - 1;
    const int left_end = 2 * outline_.flank + outline_.tip - 1;
    for (int i = 0; i < last; ++i) {
      const std::int32_t right = rim_at(tooth, i);
      const std::int32_t right_up = rim_at(tooth, i + 1);
      const std::int32_t left = rim_at(tooth, left_end - i);
      const std::int32_t left_up = rim_at(tooth, left_end - i - 1);
      add(left, right, right_up);
      add(left, right_up, left_up);
    }
    const std::int32_t left_tip = rim_at(tooth, outline_.flank + outline_.tip);
    for (int i = last; i < last + outline_.tip; ++i) {
      add(left_tip, rim_at(tooth, i), rim_at(tooth, i + 1));
    }
  }

  void add_root(int tooth, Loop& root) const {
    root.vertices.push_back(rim_at(tooth, 0));
    for (int i = 2 * outline_.flank + outline_.tip - 1; i < outline_.per_tooth(); ++i) {
      root.vertices.push_back(rim_at(tooth, i));
    }
  }

  double angle_of(std::int32_t vertex) const {
    const Vector3d& p = builder_.vertex(vertex);
    return std::atan2(p.z(), p.y());
  }

  /// Angles of a loop that rise from its first vertex on, by less than a full turn.
  void set_angles(Loop& loop) const {
    loop.angles_rad.clear();
    for (const std::int32_t vertex : loop.vertices) {
      double angle = angle_of(vertex);
      while (!loop.angles_rad.empty() && angle < loop.angles_rad.back()) {
        angle += 2.0 * kPi;
      }
      loop.angles_rad.push_back(angle);
    }
  }

  /// Lets a loop begin at the vertex nearest in angle to the other's beginning.
  void rotate_to(Loop& loop, const Loop& other) const {
    const auto distance = [&](std::int32_t vertex) {
      return std::abs(std::remainder(angle_of(vertex) - other.angles_rad.front(), 2.0 * kPi));
    };
    const auto first = std::ranges::min_element(loop.vertices, {}, distance);
    std::rotate(loop.vertices.begin(), first, loop.vertices.end());
    set_angles(loop);
    const double shift =
        2.0 * kPi * std::round((other.angles_rad.front() - loop.angles_rad.front()) / (2.0 * kPi));
    for (double& angle : loop.angles_rad) {
      angle += shift;
    }
  }

  Builder& builder_;
  const Outline& outline_;
  const Loop& rim_;
  bool is_front_ = true;
  double x_mm_ = 0.0;
  std::int32_t patch_ = 0;
};

}  // namespace

GearGeometry gear_geometry(const GearSettings& settings) {
  const double reference_mm = 0.5 * settings.module_mm * settings.teeth;
  GearGeometry gear;
  gear.base_radius_mm = reference_mm * std::cos(settings.pressure_angle_rad);
  gear.tip_radius_mm = reference_mm + settings.module_mm;
  gear.root_radius_mm = reference_mm - 1.25 * settings.module_mm;
  gear.half_tooth_rad =
      0.5 * kPi / settings.teeth + involute_of_roll(std::tan(settings.pressure_angle_rad));
  gear.root_roll_rad = roll_at(gear.root_radius_mm, gear.base_radius_mm);
  gear.tip_roll_rad = roll_at(gear.tip_radius_mm, gear.base_radius_mm);
  gear.half_tip_rad = gear.half_tooth_rad - involute_of_roll(gear.tip_roll_rad);
  gear.half_gap_rad =
      kPi / settings.teeth - gear.half_tooth_rad + involute_of_roll(gear.root_roll_rad);
  return gear;
}

void build_spur_gear(const GearSettings& settings, double chord_mm, Part& part) {
  Builder builder;
  const GearGeometry gear = gear_geometry(settings);
  const Outline outline = OutlineMaker(gear, settings, chord_mm, builder).make();
  const double width_mm = settings.face_width_mm;
  const double tooth_mm = gear.tip_radius_mm - gear.root_radius_mm;
  const auto [back, front] = extrude(
      builder, outline.profile, width_mm, slices(width_mm, tooth_mm / outline.flank), false);
  std::pair<Loop, Loop> bore;
  if (settings.bore_mm > 0.0) {
    const double radius_mm = 0.5 * settings.bore_mm;
    const std::int32_t patch =
        builder.add_patch({.shape = CylinderPatch{.radius_mm = radius_mm, .is_bore = true}});
    const Profile hole = circle(radius_mm, chord_mm, patch);
    const double step_mm = 2.0 * kPi * radius_mm / static_cast<double>(hole.points_mm.size());
    bore = extrude(builder, hole, width_mm, slices(width_mm, step_mm), true);
  }
  EndFace(builder, outline, front, true, 0.5 * width_mm).fill(settings.teeth, bore.second);
  EndFace(builder, outline, back, false, -0.5 * width_mm).fill(settings.teeth, bore.first);
  builder.finish(part);
}

}  // namespace glint::parametric
