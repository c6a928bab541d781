// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far what moves stays from everything else, at joints and along paths of joints.
//
// A path is checked without gaps (conservative advancement): a pair of bodies whose distance is d
// cannot touch before one of them has moved by d relative to the other (motion_bound.h), so the
// next look is there. Each pair goes along the path by itself, and one that is far apart is looked
// at once. Of a body of many triangles the distance to its bounding box is asked first, and its own
// only as far as some centimetres: far away all triangles are about equally near, and finding the
// nearest takes longest. B. Mirtich, "Impulse-based dynamic simulation of rigid body systems",
// 1996, section 2.3.
//
// Bodies of the arm and what it carries keep the margin to the table and to what stands. They are
// also checked against the arm itself, without margin, as capsules are rounded up: base, shoulder,
// upper arm and elbow against wrist 3, tool and what is carried; forearm against tool and what is
// carried; wrist 1 and 2 against what is carried.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hardware/planning/mesh_distances.h"
#include "hardware/planning/motion_bound.h"
#include "hardware/planning/planning_cell.h"

namespace glint {

struct Clearance {
  enum class Touch { kNone, kBox, kCollision };

  Touch touch = Touch::kNone;
  std::string text;  ///< what would touch what; empty: nothing
  /// Smallest distance between what moves and table or standing bodies. At joints to 0.001 mm;
  /// along paths a lower bound, at most 10 % + 0.5 mm below the smallest distance. Not beyond 1 m.
  double margin_mm = 0.0;

  bool is_free() const { return touch == Touch::kNone; }
};

/// What is looked for beyond the margin, so that steps along a path do not become arbitrarily
/// small.
inline constexpr double kLookMm = 0.5;

class ClearanceCheck {
 public:
  explicit ClearanceCheck(const PlanningCell& cell);

  Clearance at(const JointVector& joints_rad) const;

  /// @param from_rad, to_rad  free by at()
  Clearance along(const JointVector& from_rad, const JointVector& to_rad) const;

  /// Distances asked for so far.
  std::int64_t num_queries() const { return distances_.num_queries(); }

  /// Base, arm, tool, carried bodies, then standing ones.
  const std::vector<SolidBody>& bodies() const { return bodies_; }

 private:
  struct Pair {
    enum class Kind { kMeshes, kTable, kBox };
    Kind kind = Kind::kMeshes;
    std::size_t fixed = 0;   ///< of kMeshes: the body nearer to the base
    std::size_t moving = 0;  ///< the other body
    double margin_mm = 0.0;
    bool is_counted = false;  ///< in the margin that is told
  };

  /// A distance, or what it is not below.
  struct Gap {
    double mm = 0.0;
    bool is_exact = true;
  };

  /// A straight way of the joints and the smallest distance so far.
  struct Walk {
    JointVector from_rad;
    JointVector way_rad;
    double min_mm;

    /// What a distance may fall to between two looks.
    double floor_mm(const Pair& pair) const;
  };

  void add_pairs(std::size_t moving);
  void add_self_pairs(std::size_t moving);
  Gap gap(const Pair& pair, const LinkFrames& frames, double near_mm, double enough_mm) const;
  double height_mm(const Pair& pair, const LinkFrames& frames) const;
  double room_mm(const Pair& pair, const LinkFrames& frames) const;
  bool goes_free(const Pair& pair, Walk& walk) const;
  bool contains_any(const LinkFrames& frames, std::string& text) const;
  Clearance refused(const Pair& pair) const;

  const PlanningCell& cell_;
  std::vector<SolidBody> bodies_;
  std::vector<MotionHull> hulls_;
  std::vector<BoundingBox> boxes_;  ///< of the bodies, in their frames
  MeshDistances distances_;
  std::vector<Pair> pairs_;
};

}  // namespace glint
