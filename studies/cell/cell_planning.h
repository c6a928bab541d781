// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a cell file says for planning: room that the arm's tool takes, what stands in the cell.
//
//     [planning]     margin, table, camera and cable, limits of joints
//     [[obstacle]]   a box or a mesh, in the robot's base
//     [[body]]       a capsule on the flange
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/keys.h"
#include "core/units.h"

namespace glint {

/// [planning]
struct PlanningSettings {
  double margin_mm = 5.0;                 ///< >= 0; what moves stays that far from what stands
  std::optional<double> table_height_mm;  ///< in the base; none: no table
  std::vector<double> camera_size_mm;     ///< along the camera's x, y, z; empty: no body
  double camera_front_mm = 0.0;           ///< from the pinhole forward to its front
  std::vector<double> cable_mm;           ///< x, y, z of points on the flange, two or more
  double cable_radius_mm = 5.0;           ///< > 0; of the room that the cable may take
  std::vector<double> joint_min_rad = std::vector<double>(6, -2.0 * kPi);
  std::vector<double> joint_max_rad = std::vector<double>(6, 2.0 * kPi);
  double min_joint_sine = 0.05;     ///< of joints 3 and 5 at views
  double light_thickness_mm = 3.0;  ///< >= 0; of the lights of a scene, on all sides
};

/// [[obstacle]]: a box, or a mesh.
struct CellObstacle {
  std::string name;
  std::vector<double> position_mm = {0.0, 0.0, 0.0};  ///< of the box's centre, or the mesh's origin
  std::vector<double> rotation_rad = {0.0, 0.0, 0.0};  ///< axis times angle
  std::vector<double> size_mm;                         ///< of a box
  std::filesystem::path file;                          ///< of a mesh, mm
};

/// [[body]]
struct CellBody {
  std::string name;
  std::vector<double> from_mm;  ///< on the flange
  std::vector<double> to_mm;
  double radius_mm = 0.0;
};

struct CellPlanning {
  PlanningSettings settings;
  std::vector<CellObstacle> obstacles;
  std::vector<CellBody> bodies;
};

void visit_keys(KeyVisitor& keys, PlanningSettings& settings);
void visit_keys(KeyVisitor& keys, CellObstacle& obstacle);
void visit_keys(KeyVisitor& keys, CellBody& body);

/// The three tables of a cell file. @param errors  grows by the problems found
CellPlanning read_cell_planning(const ConfigNode& root, std::vector<Problem>& errors);

}  // namespace glint
