// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts under inspection: a mesh from a file, or a parametric shape whose exact surface is known.
//
// Part frame: +z towards the camera at rest, +x along the tunnel axis, origin at the centre of the
// bounding box unless `origin = "file"`. The scene frame is the part frame after the pose
// (rotation about the fixed x, then y, then z axis, then translation). Formulas of the parametric
// parts: docs/theory/parts.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/keys.h"
#include "core/pose.h"
#include "core/units.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

/// An involute spur gear lying along x without profile shift: addendum 1 module, dedendum 1.25
/// modules, radial flanks inside the base circle, a tooth's centre at +z.
struct GearSettings {
  int teeth = 30;
  double module_mm = 2.0;
  double pressure_angle_rad = 20.0 * kRadPerDeg;
  double face_width_mm = 20.0;
  double bore_mm = 16.0;  ///< diameter of the hole along the axis, 0 = none
};

/// How far the triangles of a parametric part may lie from its exact surface.
inline constexpr double kChordTolerance_mm = 2e-3;

/// The [part] table of a study.
struct PartSettings {
  enum class Shape { kStrip, kPlate, kSphereCap, kCylinder, kSpurGear, kMesh };
  enum class Unit { kMillimetre, kCentimetre, kMetre, kInch };
  enum class Origin { kCentre, kFile };

  Shape shape = Shape::kStrip;
  std::filesystem::path file = {};  ///< STL, PLY, OBJ or OFF; when given, shape is kMesh
  Unit unit = Unit::kMillimetre;

  double length_mm = 200.0;        ///< strip, plate, cylinder: along x
  double width_mm = 50.0;          ///< strip, plate: along y
  double radius_along_mm = 800.0;  ///< strip: in the x-z plane; 0 or inf straight, < 0 concave
  double radius_across_mm = 80.0;  ///< strip: in the y-z plane; likewise
  double thickness_mm = 3.0;       ///< strip (at its thinnest), plate
  double radius_mm = 25.0;         ///< sphere cap, cylinder
  double height_mm = 10.0;         ///< sphere cap: from its flat base to the top, <= 2 radii
  GearSettings gear = {};
  double facets_mm = 0.0;  ///< not a mesh: triangles this near the surface take its place; 0: exact

  double crease_rad = 30.0 * kRadPerDeg;  ///< mesh: edges sharper than this stay sharp
  std::vector<double> position_mm = {0.0, 0.0, 0.0};
  std::vector<double> rotation_rad = {0.0, 0.0, 0.0};  ///< about fixed x, then y, then z
  Origin origin = Origin::kCentre;
  std::vector<double> expected_size_mm = {};  ///< empty or 3 numbers: bounding box before the pose

  double chord_tolerance_mm() const { return facets_mm > 0.0 ? facets_mm : kChordTolerance_mm; }
};

/// The keys of [part]; see core/config/keys.h.
void visit_keys(KeyVisitor& keys, PartSettings& settings);

/// A part ready to be traced. Mesh and patches are in the SCENE frame: the pose is applied.
struct Part {
  std::string name;  ///< the shape's name, or the file's without folders
  TriangleMesh mesh;
  std::vector<ExactPatch> patches;  ///< TriangleMesh::patch points here
  RigidTransform scene_from_part;
  BoundingBox box_in_part_mm;  ///< before the pose
  PartSettings::Unit unit = PartSettings::Unit::kMillimetre;
  bool is_from_file = false;
};

/// "mm", "cm", "m" or "inch".
std::string_view unit_name(PartSettings::Unit unit);
double mm_per_unit(PartSettings::Unit unit);

/// Builds or reads a part. Cost: the reading and one pass over the triangles.
/// @throws ConfigError naming key or file: settings that give no solid, an unusable mesh, an
///         implausible size (< 1 mm or > 5000 mm: wrong unit?), an unexpected size.
/// @throws IoError when the file cannot be read.
Part build_part(const PartSettings& settings);

/// Scene from part for a position and a rotation about the fixed x, then y, then z axis:
/// rotation = Rz(c) Ry(b) Rx(a).
RigidTransform pose_from_angles(const Eigen::Vector3d& position_mm,
                                const Eigen::Vector3d& rotation_rad);

}  // namespace glint
