// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/part.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/error.h"
#include "core/pose.h"
#include "core/text.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "simulator/geometry/part/parametric_gear.h"
#include "simulator/geometry/part/parametric_part.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Shape = PartSettings::Shape;
using Unit = PartSettings::Unit;

constexpr std::array<std::string_view, 6> kShapes = {
    "strip", "plate", "sphere_cap", "cylinder", "spur_gear", "mesh"};
constexpr std::array<std::string_view, 4> kUnits = {"mm", "cm", "m", "inch"};
constexpr std::array<double, 4> kMmPerUnit = {1.0, 10.0, 1000.0, 25.4};
constexpr std::array<std::string_view, 2> kOrigins = {"centre", "file"};

constexpr double kSmallest_mm = 1.0;
constexpr double kLargest_mm = 5000.0;
constexpr double kSizeTolerance = 0.01;  ///< of expected_size_mm

void visit_gear(KeyVisitor& keys, GearSettings& gear) {
  keys.integer("teeth", gear.teeth, Range::between(6, 1000), "Number of teeth.");
  keys.number("module_mm",
              gear.module_mm,
              Range::positive(),
              "Module: reference diameter divided by the number of teeth.");
  keys.number("pressure_angle_deg",
              gear.pressure_angle_rad,
              Range::between(5.0, 35.0),
              "Pressure angle of the involute at the reference circle.");
  keys.number("face_width_mm", gear.face_width_mm, Range::positive(), "Length of the teeth.");
  keys.number("bore_mm", gear.bore_mm, Range::at_least(0.0), "Diameter of the bore, 0 for none.");
}

/// What makes a gear impossible as key and message; both empty when it is possible.
std::pair<std::string, std::string> gear_fault(const GearSettings& settings) {
  const parametric::GearGeometry gear = parametric::gear_geometry(settings);
  if (gear.half_tip_rad <= 0.0) {
    return {
        "pressure_angle_deg",
        "the teeth end in a point below the tip circle; allowed: a smaller angle or more teeth"};
  }
  if (gear.half_gap_rad <= 0.0) {
    return {"teeth", "no gap is left between the teeth; allowed: fewer teeth or a smaller angle"};
  }
  // A tooth's foot is a chord, which runs up to 4 % inside the root circle for 6 teeth.
  const double largest_mm = 0.9 * 2.0 * gear.root_radius_mm;
  if (settings.bore_mm > largest_mm) {
    return {"bore_mm",
            fmt::format("{} mm cuts into the teeth; allowed: up to {} mm",
                        shortest(settings.bore_mm),
                        fmt::format("{:.4g}", largest_mm))};
  }
  return {};
}

bool is_gentle(double radius_mm, double extent_mm) {
  return radius_mm == 0.0 || std::abs(radius_mm) >= 0.5 * extent_mm;
}

/// All conditions between keys; calls fail(key, message) for each that does not hold.
template <class Fail>
void check_shape(const PartSettings& settings, const Fail& fail) {
  if (settings.shape == Shape::kMesh && settings.file.empty()) {
    fail("file", "shape \"mesh\" needs a file (STL, PLY, OBJ, OFF or CAO)");
  }
  if (settings.shape == Shape::kStrip) {
    if (!is_gentle(settings.radius_along_mm, settings.length_mm)) {
      fail("radius_along_mm", "allowed: at least half of length_mm, or 0 for straight");
    }
    if (!is_gentle(settings.radius_across_mm, settings.width_mm)) {
      fail("radius_across_mm", "allowed: at least half of width_mm, or 0 for straight");
    }
  }
  if (settings.shape == Shape::kSphereCap && settings.height_mm > 2.0 * settings.radius_mm) {
    fail("height_mm",
         "larger than the sphere; allowed: up to 2 radius_mm (" +
             shortest(2.0 * settings.radius_mm) + ")");
  }
  if (settings.shape == Shape::kSpurGear) {
    const auto [key, message] = gear_fault(settings.gear);
    if (!key.empty()) {
      fail("gear." + key, message);
    }
  }
  if (!settings.expected_size_mm.empty() && settings.expected_size_mm.size() != 3) {
    fail("expected_size_mm", "allowed: three numbers (x, y, z) or none");
  }
}

void visit_sizes(KeyVisitor& keys, PartSettings& settings) {
  keys.number("length_mm",
              settings.length_mm,
              Range::positive(),
              "Length along x of a strip, plate or cylinder.");
  keys.number(
      "width_mm", settings.width_mm, Range::positive(), "Width along y of a strip or plate.");
  keys.number("radius_along_mm",
              settings.radius_along_mm,
              Range{},
              "Radius of curvature of a strip along its length; 0 = straight, < 0 = concave.");
  keys.number("radius_across_mm",
              settings.radius_across_mm,
              Range{},
              "Radius of curvature of a strip across its width; 0 = straight, < 0 = concave.");
  keys.number("thickness_mm",
              settings.thickness_mm,
              Range::positive(),
              "Thickness of a plate, or of a strip at its thinnest place.");
  keys.number(
      "radius_mm", settings.radius_mm, Range::positive(), "Radius of a sphere cap or cylinder.");
  keys.number("height_mm",
              settings.height_mm,
              Range::positive(),
              "Height of a sphere cap from its flat base, up to 2 radii (a whole sphere).");
  keys.table(
      "gear", [&](KeyVisitor& inner) { visit_gear(inner, settings.gear); }, "The spur gear.");
  keys.number("facets_um",
              settings.facets_mm,
              Range::between(0.0, 1e4),
              "Not a mesh: triangles with smooth normals take the place of the exact surface, this "
              "near to it; 0 = exact.");
}

void visit_pose(KeyVisitor& keys, PartSettings& settings) {
  keys.numbers("position_mm",
               settings.position_mm,
               {.min = 3, .max = 3},
               Range{},
               "Where the part's origin lies in the scene.");
  keys.numbers("rotation_deg",
               settings.rotation_rad,
               {.min = 3, .max = 3},
               Range{},
               "Turns about the scene's fixed axes: first about x, then y, then z.");
  keys.choice("origin",
              settings.origin,
              kOrigins,
              "Origin of the part frame: the centre of the bounding box, or as the file (or the "
              "shape's formula) has it.");
}

/// Scales a mesh from its file's unit.
void to_mm(TriangleMesh& mesh, Unit unit) {
  for (Vector3d& vertex : mesh.vertices_mm) {
    vertex *= mm_per_unit(unit);
  }
}

void check_size(const Part& part) {
  const double size_mm = part.box_in_part_mm.size_mm().maxCoeff();
  if (size_mm >= kSmallest_mm && size_mm <= kLargest_mm) {
    return;
  }
  if (!part.is_from_file) {
    throw ConfigError(
        "part.shape",
        fmt::format("the {} is {:.4g} mm large; allowed: 1 to 5000 mm", part.name, size_mm));
  }
  // The unit under which the file's numbers make the most everyday size, 10 to 1000 mm.
  const double in_file = size_mm / mm_per_unit(part.unit);
  std::string question;
  for (const Unit unit : {Unit::kMillimetre, Unit::kMetre, Unit::kCentimetre, Unit::kInch}) {
    const double guess_mm = in_file * mm_per_unit(unit);
    if (unit != part.unit && guess_mm >= 10.0 && guess_mm <= 1000.0) {
      question = fmt::format(
          ": is the file in {0}? The unit \"{0}\" makes it {1:.4g} mm", unit_name(unit), guess_mm);
      break;
    }
  }
  throw ConfigError(
      "part.unit",
      fmt::format("{} is {:.4g} mm large{}; allowed: 1 to 5000 mm", part.name, size_mm, question));
}

void check_expected_size(const Part& part, const std::vector<double>& expected_mm) {
  const Vector3d size_mm = part.box_in_part_mm.size_mm();
  for (std::size_t i = 0; i < expected_mm.size(); ++i) {
    const double is_mm = size_mm[static_cast<Eigen::Index>(i)];
    if (std::abs(is_mm - expected_mm[i]) > kSizeTolerance * std::abs(expected_mm[i])) {
      throw ConfigError("part.expected_size_mm",
                        fmt::format("{} is {:.4g} x {:.4g} x {:.4g} mm large, expected "
                                    "{:.4g} x {:.4g} x {:.4g} mm (1 % allowed); check part.unit",
                                    part.name,
                                    size_mm.x(),
                                    size_mm.y(),
                                    size_mm.z(),
                                    expected_mm[0],
                                    expected_mm[1],
                                    expected_mm[2]));
    }
  }
}

void read_part(const PartSettings& settings, Part& part) {
  part.mesh = read_mesh(settings.file);
  part.name = settings.file.filename().string();
  part.unit = settings.unit;
  part.is_from_file = true;
  to_mm(part.mesh, settings.unit);
  const std::string fault = find_fault(part.mesh);  // scaling may overflow
  if (!fault.empty()) {
    throw ConfigError(fmt::format("{}: {}", settings.file.string(), fault));
  }
  smooth_normals(part.mesh, settings.crease_rad);
}

void build_shape(const PartSettings& settings, Part& part) {
  part.name = kShapes[static_cast<std::size_t>(settings.shape)];
  switch (settings.shape) {
    case Shape::kStrip:
      return parametric::build_strip(settings, part);
    case Shape::kPlate:
      return parametric::build_plate(settings, part);
    case Shape::kSphereCap:
      return parametric::build_sphere_cap(settings, part);
    case Shape::kCylinder:
      return parametric::build_cylinder(settings, part);
    case Shape::kSpurGear:
      return parametric::build_spur_gear(settings.gear, settings.chord_tolerance_mm(), part);
    case Shape::kMesh:
      return read_part(settings, part);
  }
}

void move_part(Part& part, const RigidTransform& target_from_source) {
  transform(part.mesh, target_from_source);
  for (ExactPatch& patch : part.patches) {
    patch.scene_from_patch = target_from_source * patch.scene_from_patch;
  }
}

/// The largest extent of a parametric shape across its fine side, before anything is built.
double extent_mm(const PartSettings& settings) {
  const double radius_mm = settings.radius_mm;
  const double height_mm = settings.height_mm;
  switch (settings.shape) {
    case Shape::kStrip:
    case Shape::kPlate:
      return std::max(settings.length_mm, settings.width_mm);
    case Shape::kSphereCap:
      return height_mm > radius_mm ? 2.0 * radius_mm
                                   : 2.0 * std::sqrt(height_mm * (2.0 * radius_mm - height_mm));
    case Shape::kCylinder:
      return std::max(settings.length_mm, 2.0 * radius_mm);
    case Shape::kSpurGear:
      return std::max(2.0 * parametric::gear_geometry(settings.gear).tip_radius_mm,
                      settings.gear.face_width_mm);
    case Shape::kMesh:
      break;
  }
  return 0.0;
}

/// A huge shape would ask for endless triangles, so it is refused before it is built.
void check_extent(const PartSettings& settings) {
  const double size_mm = extent_mm(settings);
  if (!(size_mm <= kLargest_mm)) {
    throw ConfigError("part.shape",
                      fmt::format("the {} is {:.4g} mm large; allowed: 1 to 5000 mm",
                                  kShapes[static_cast<std::size_t>(settings.shape)],
                                  size_mm));
  }
}

}  // namespace

void visit_keys(KeyVisitor& keys, PartSettings& settings) {
  keys.choice("shape", settings.shape, kShapes, "What the part is; a given file makes it a mesh.");
  keys.file("file", settings.file, "Mesh to read: STL, PLY, OBJ, OFF or CAO.");
  keys.choice("unit", settings.unit, kUnits, "Unit of the numbers in the mesh file.");
  if (!settings.file.empty()) {
    settings.shape = Shape::kMesh;
  }
  visit_sizes(keys, settings);
  keys.number("crease_deg",
              settings.crease_rad,
              Range::between(0.0, 180.0),
              "Edges of a mesh that are sharper than this stay sharp in the shading.");
  visit_pose(keys, settings);
  keys.numbers("expected_size_mm",
               settings.expected_size_mm,
               {.min = 0, .max = 3},
               Range::at_least(0.0),
               "Size of the bounding box (x, y, z) the part must have within 1 %; empty: any.");
  check_shape(settings, [&](const std::string& key, const std::string& message) {
    keys.require(false, key, message);
  });
}

std::string_view unit_name(Unit unit) {
  return kUnits[static_cast<std::size_t>(unit)];
}

double mm_per_unit(Unit unit) {
  return kMmPerUnit[static_cast<std::size_t>(unit)];
}

RigidTransform pose_from_angles(const Vector3d& position_mm, const Vector3d& rotation_rad) {
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(rotation_rad.z(), Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(rotation_rad.y(), Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(rotation_rad.x(), Vector3d::UnitX()))
                                       .toRotationMatrix();
  return {.rotation = rotation, .translation_mm = position_mm};
}

Part build_part(const PartSettings& settings) {
  check_shape(settings, [](const std::string& key, const std::string& message) {
    throw ConfigError("part." + key, message);
  });
  check_extent(settings);
  Part part;
  build_shape(settings, part);
  if (settings.facets_mm > 0.0) {
    part.patches.clear();
    part.mesh.patch.clear();
  }
  if (settings.origin == PartSettings::Origin::kCentre) {
    move_part(part, {.translation_mm = -bounding_box(part.mesh).centre_mm()});
  }
  part.box_in_part_mm = bounding_box(part.mesh);
  check_size(part);
  check_expected_size(part, settings.expected_size_mm);
  part.scene_from_part =
      pose_from_angles(vector_of(settings.position_mm), vector_of(settings.rotation_rad));
  move_part(part, part.scene_from_part);
  return part;
}

}  // namespace glint
