// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/clearance.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "simulator/geometry/mesh/winding_number.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Kind = SolidBody::Kind;

constexpr double kFarMm = 1000.0;  ///< margins are not told beyond it
/// The robot itself asks for 1 mm between links and box (path_check.h).
constexpr double kBoxMarginMm = 1.0;
constexpr double kCloseShare = 0.9;
constexpr double kNearMm = 30.0;  ///< beyond it distances to large meshes are not sought

std::vector<SolidBody> all_bodies(const PlanningCell& cell) {
  std::vector<SolidBody> bodies = arm_bodies(cell.arm);
  bodies.insert(bodies.end(), cell.carried.begin(), cell.carried.end());
  bodies.insert(bodies.end(), cell.standing.begin(), cell.standing.end());
  return bodies;
}

bool is_moving(const SolidBody& body) {
  return body.kind != Kind::kBase && body.kind != Kind::kStanding;
}

bool is_in(const BoundingBox& box, const Vector3d& point_mm) {
  return (point_mm.array() >= box.min_mm.array()).all() &&
         (point_mm.array() <= box.max_mm.array()).all();
}

/// A body's first vertex lies within another's closed mesh: surfaces that do not touch tell
/// nothing of that.
bool is_within(const SolidBody& inner,
               const Eigen::Isometry3d& base_from_inner,
               const SolidBody& outer,
               const BoundingBox& outer_box,
               const Eigen::Isometry3d& base_from_outer) {
  constexpr double kHalf = 0.5;
  const Vector3d point_mm =
      base_from_outer.inverse() * (base_from_inner * inner.mesh.vertices_mm.front());
  return is_in(outer_box, point_mm) && std::abs(winding_number(outer.mesh, point_mm)) > kHalf;
}

}  // namespace

double ClearanceCheck::Walk::floor_mm(const Pair& pair) const {
  return pair.is_counted ? std::max(pair.margin_mm, kCloseShare * min_mm - kLookMm)
                         : pair.margin_mm;
}

ClearanceCheck::ClearanceCheck(const PlanningCell& cell)
    : cell_(cell), bodies_(all_bodies(cell)), distances_(bodies_) {
  for (const SolidBody& body : bodies_) {
    hulls_.emplace_back(cell.arm.arm.table(), body.link, hull_of(body.mesh));
    boxes_.push_back(bounding_box(body.mesh));
  }
  for (std::size_t i = bodies_.size(); i-- > 0;) {  // what is carried first: it touches first
    if (is_moving(bodies_[i])) {
      add_pairs(i);
    }
  }
  // Large meshes last: what is known by then cuts their distances off.
  std::stable_partition(pairs_.begin(), pairs_.end(), [this](const Pair& pair) {
    return pair.kind != Pair::Kind::kMeshes || !distances_.is_large(pair.fixed);
  });
}

void ClearanceCheck::add_pairs(std::size_t moving) {
  pairs_.push_back({.kind = Pair::Kind::kBox, .moving = moving, .margin_mm = kBoxMarginMm});
  if (cell_.table_mm) {
    pairs_.push_back({.kind = Pair::Kind::kTable,
                      .moving = moving,
                      .margin_mm = cell_.margin_mm,
                      .is_counted = true});
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].kind == Kind::kStanding) {
      pairs_.push_back(
          {.fixed = i, .moving = moving, .margin_mm = cell_.margin_mm, .is_counted = true});
    }
  }
  add_self_pairs(moving);
}

void ClearanceCheck::add_self_pairs(std::size_t moving) {
  constexpr int kForearm = 3;
  constexpr int kWrist3 = 5;
  const SolidBody& body = bodies_[moving];
  const bool is_link = body.kind == Kind::kArm;
  const bool is_tool = body.kind == Kind::kTool;
  if (is_link && body.link < kWrist3) {
    return;
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const SolidBody& other = bodies_[i];
    const bool is_low = other.kind == Kind::kBase || (other.kind == Kind::kArm && other.link < 3);
    const bool is_forearm = other.name == "forearm";
    const bool is_wrist =
        other.kind == Kind::kArm && !is_forearm && other.link >= kForearm && other.link < kWrist3;
    if (is_low || (is_forearm && !is_link) || (is_wrist && !is_link && !is_tool)) {
      pairs_.push_back({.fixed = i, .moving = moving});
    }
  }
}

/// Height over the table.
double ClearanceCheck::height_mm(const Pair& pair, const LinkFrames& frames) const {
  const SolidBody& body = bodies_[pair.moving];
  double lowest_mm = std::numeric_limits<double>::infinity();
  for (const Vector3d& point_mm : hulls_[pair.moving].points_mm()) {
    lowest_mm = std::min(lowest_mm, (frames[static_cast<std::size_t>(body.link)] * point_mm).z());
  }
  return lowest_mm - body.radius_mm - *cell_.table_mm;
}

/// Distance to the nearest wall of the box, from within.
double ClearanceCheck::room_mm(const Pair& pair, const LinkFrames& frames) const {
  const SolidBody& body = bodies_[pair.moving];
  const MotionLimits& limits = cell_.arm.limits;
  const Vector3d min_mm = Eigen::Map<const Vector3d>(limits.box_min_mm.data());
  const Vector3d max_mm = Eigen::Map<const Vector3d>(limits.box_max_mm.data());
  double room_mm = std::numeric_limits<double>::infinity();
  for (const Vector3d& local_mm : hulls_[pair.moving].points_mm()) {
    const Vector3d point_mm = frames[static_cast<std::size_t>(body.link)] * local_mm;
    room_mm = std::min({room_mm, (point_mm - min_mm).minCoeff(), (max_mm - point_mm).minCoeff()});
  }
  return room_mm - body.radius_mm;
}

/// @param near_mm    what the distance is compared with
/// @param enough_mm  more need not be known
ClearanceCheck::Gap ClearanceCheck::gap(const Pair& pair,
                                        const LinkFrames& frames,
                                        double near_mm,
                                        double enough_mm) const {
  if (pair.kind != Pair::Kind::kMeshes) {
    return {.mm =
                pair.kind == Pair::Kind::kTable ? height_mm(pair, frames) : room_mm(pair, frames)};
  }
  const SolidBody& fixed = bodies_[pair.fixed];
  const SolidBody& moving = bodies_[pair.moving];
  const Eigen::Isometry3d& base_from_fixed = frames[static_cast<std::size_t>(fixed.link)];
  const Eigen::Isometry3d& base_from_moving = frames[static_cast<std::size_t>(moving.link)];
  const double radii_mm = fixed.radius_mm + moving.radius_mm;
  double cut_mm = enough_mm + radii_mm;
  if (distances_.is_large(pair.fixed)) {
    const double box_mm = distances_.distance_to_box_mm(
        pair.fixed, base_from_fixed, pair.moving, base_from_moving, cut_mm);
    cut_mm = std::min(cut_mm, near_mm + kNearMm + radii_mm);
    if (box_mm >= cut_mm) {
      return {.mm = box_mm - radii_mm, .is_exact = false};
    }
  }
  const double distance_mm =
      distances_.distance_mm(pair.fixed, base_from_fixed, pair.moving, base_from_moving, cut_mm);
  return {.mm = distance_mm - radii_mm, .is_exact = distance_mm < cut_mm};
}

Clearance ClearanceCheck::refused(const Pair& pair) const {
  const std::string& name = bodies_[pair.moving].name;
  if (pair.kind == Pair::Kind::kBox) {
    return {.touch = Clearance::Touch::kBox, .text = fmt::format("the {} leaves the box", name)};
  }
  const std::string other = pair.kind == Pair::Kind::kTable ? "table" : bodies_[pair.fixed].name;
  return {
      .touch = Clearance::Touch::kCollision,
      .text = pair.margin_mm > 0.0
                  ? fmt::format(
                        "the {} comes nearer than {:g} mm to the {}", name, pair.margin_mm, other)
                  : fmt::format("the {} touches the {}", name, other)};
}

bool ClearanceCheck::contains_any(const LinkFrames& frames, std::string& text) const {
  for (const Pair& pair : pairs_) {
    if (pair.kind != Pair::Kind::kMeshes) {
      continue;
    }
    const SolidBody& moving = bodies_[pair.moving];
    const SolidBody& fixed = bodies_[pair.fixed];
    const Eigen::Isometry3d& base_from_moving = frames[static_cast<std::size_t>(moving.link)];
    const Eigen::Isometry3d& base_from_fixed = frames[static_cast<std::size_t>(fixed.link)];
    if (is_within(moving, base_from_moving, fixed, boxes_[pair.fixed], base_from_fixed) ||
        is_within(fixed, base_from_fixed, moving, boxes_[pair.moving], base_from_moving)) {
      text = fmt::format("the {} is within the {}, or around it", moving.name, fixed.name);
      return true;
    }
  }
  return false;
}

Clearance ClearanceCheck::at(const JointVector& joints_rad) const {
  const LinkFrames frames = cell_.arm.arm.frames(joints_rad);
  Clearance result = {.margin_mm = kFarMm};
  for (const Pair& pair : pairs_) {
    const double needed_mm = pair.margin_mm + kLookMm;
    const double enough_mm = pair.is_counted ? std::max(result.margin_mm, needed_mm) : needed_mm;
    const Gap there = gap(pair, frames, enough_mm, enough_mm);
    if (there.is_exact && there.mm < needed_mm) {
      return refused(pair);
    }
    if (there.is_exact && pair.is_counted) {
      result.margin_mm = std::min(result.margin_mm, there.mm);
    }
  }
  if (contains_any(frames, result.text)) {
    return {.touch = Clearance::Touch::kCollision, .text = result.text};
  }
  return result;
}

bool ClearanceCheck::goes_free(const Pair& pair, Walk& walk) const {
  const int fixed = pair.kind == Pair::Kind::kMeshes ? bodies_[pair.fixed].link : 0;
  double share = 0.0;
  while (share < 1.0) {
    const LinkFrames frames = cell_.arm.arm.frames(walk.from_rad + share * walk.way_rad);
    const MotionBound bound = hulls_[pair.moving].bound(frames, walk.way_rad, fixed);
    const double floor_mm = walk.floor_mm(pair);
    const double enough_mm = floor_mm + bound.over(1.0 - share) + kLookMm;
    const Gap there = gap(pair, frames, floor_mm, enough_mm);
    if (there.is_exact && there.mm < pair.margin_mm + kLookMm) {
      return false;
    }
    if (there.is_exact && pair.is_counted) {
      walk.min_mm = std::min(walk.min_mm, there.mm);
    }
    share += bound.share_within(there.mm - walk.floor_mm(pair));
  }
  return true;
}

Clearance ClearanceCheck::along(const JointVector& from_rad, const JointVector& to_rad) const {
  constexpr double kMiddle = 0.5;
  Walk walk = {.from_rad = from_rad, .way_rad = to_rad - from_rad, .min_mm = kFarMm};
  for (const double share : {0.0, 1.0, kMiddle}) {
    Clearance there = at(from_rad + share * walk.way_rad);
    if (!there.is_free()) {
      return there;
    }
    walk.min_mm = std::min(walk.min_mm, there.margin_mm);
  }
  for (const Pair& pair : pairs_) {
    if (!goes_free(pair, walk)) {
      return refused(pair);
    }
  }
  Clearance result;
  result.margin_mm = std::max(cell_.margin_mm, kCloseShare * walk.min_mm - kLookMm);
  return result;
}

}  // namespace glint
