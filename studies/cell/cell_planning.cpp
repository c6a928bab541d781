// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_planning.h"

#include <algorithm>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr double kFarMm = 5000.0;

/// [[name]], one settings struct each.
template <class Settings>
std::vector<Settings> read_list(const ConfigNode& root,
                                const std::string& name,
                                std::vector<Problem>& errors) {
  std::vector<Settings> all;
  const ConfigNode* list = root.find(name);
  if (list == nullptr) {
    return all;
  }
  if (!list->is_array()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = list->place,
                      .key = name,
                      .text = fmt::format("must be one or more [[{}]]", name)});
    return all;
  }
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    Settings settings = {.name = fmt::format("{} {}", name, i + 1)};
    KeyReader reader(&list->items[i], fmt::format("{}.{}", name, i + 1), errors);
    visit_keys(reader, settings);
    reader.report_unknown();
    all.push_back(std::move(settings));
  }
  return all;
}

void visit_room(KeyVisitor& keys, PlanningSettings& settings) {
  keys.numbers("camera_size_mm",
               settings.camera_size_mm,
               {.min = 3, .max = 3},
               Range::between(1, 1000),
               "room of the camera and its lens along its x, y and z; without it none");
  keys.number("camera_front_mm",
              settings.camera_front_mm,
              Range::between(-500, 500),
              "from the pinhole to the front of that room, along the view");
  keys.numbers("cable_mm",
               settings.cable_mm,
               {.min = 6},
               Range::between(-kFarMm, kFarMm),
               "x, y, z of points along the cable's room, on the flange; two points or more");
  keys.require(settings.cable_mm.size() % 3 == 0, "cable_mm", "must be three numbers a point");
  keys.number("cable_radius_mm",
              settings.cable_radius_mm,
              {.min = 0.0, .max = 200.0, .min_excluded = true},
              "of the cable's room");
  keys.number("light_thickness_mm",
              settings.light_thickness_mm,
              Range::between(0, 100),
              "of a scene's lights, on all sides of what shines");
}

}  // namespace

void visit_keys(KeyVisitor& keys, PlanningSettings& settings) {
  constexpr Count kSix = {.min = 6, .max = 6};
  const Range angles = Range::between(-360, 360);
  keys.number("margin_mm",
              settings.margin_mm,
              Range::between(0, 200),
              "arm and what it carries stay that far from table, obstacles and part");
  double table_mm = settings.table_height_mm.value_or(0.0);
  keys.number("table_height_mm",
              table_mm,
              Range::between(-kFarMm, kFarMm),
              "height of a table that fills the cell, in the robot's base; without it no table");
  if (keys.is_given("table_height_mm")) {
    settings.table_height_mm = table_mm;
  }
  visit_room(keys, settings);
  keys.numbers(
      "joint_min_deg", settings.joint_min_rad, kSix, angles, "lowest angles of the joints");
  keys.numbers(
      "joint_max_deg", settings.joint_max_rad, kSix, angles, "highest angles of the joints");
  for (std::size_t i = 0;
       i < std::min(settings.joint_min_rad.size(), settings.joint_max_rad.size());
       ++i) {
    keys.require(settings.joint_min_rad[i] < settings.joint_max_rad[i],
                 "joint_max_deg",
                 "must be above joint_min_deg in all six numbers");
  }
  keys.number("min_joint_sine",
              settings.min_joint_sine,
              Range::between(0.01, 0.9),
              "of joints 3 and 5 at views; less counts as singular");
}

void visit_keys(KeyVisitor& keys, CellObstacle& obstacle) {
  constexpr Count kThree = {.min = 3, .max = 3};
  keys.text("name", obstacle.name, "of the obstacle");
  keys.numbers("position_mm",
               obstacle.position_mm,
               kThree,
               Range::between(-kFarMm, kFarMm),
               "of the box's centre or the mesh's origin, in the robot's base");
  keys.numbers("rotation_deg",
               obstacle.rotation_rad,
               kThree,
               Range::between(-360, 360),
               "how it is turned: axis times angle");
  keys.numbers("size_mm", obstacle.size_mm, kThree, Range::between(0.1, kFarMm), "of a box");
  keys.file("file", obstacle.file, "mesh instead of a box, in millimetres");
  keys.require(obstacle.size_mm.empty() != obstacle.file.empty(),
               "size_mm",
               "or file: an obstacle is either a box or a mesh, one of the two must be given");
}

void visit_keys(KeyVisitor& keys, CellBody& body) {
  constexpr Count kThree = {.min = 3, .max = 3};
  const Range near = Range::between(-1000, 1000);
  keys.text("name", body.name, "of what the flange carries");
  keys.numbers("from_mm", body.from_mm, kThree, near, "one end of its axis, on the flange");
  keys.numbers("to_mm", body.to_mm, kThree, near, "the other end");
  keys.number("radius_mm",
              body.radius_mm,
              {.min = 0.0, .max = 500.0, .min_excluded = true},
              "everything nearer to the axis");
  for (const char* key : {"from_mm", "to_mm", "radius_mm"}) {
    keys.require(
        keys.is_given(key), key, "is missing: a body is a line on the flange and a radius");
  }
}

CellPlanning read_cell_planning(const ConfigNode& root, std::vector<Problem>& errors) {
  CellPlanning planning;
  const ConfigNode* table = root.find("planning");
  if (table != nullptr && !table->is_table()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = table->place,
                      .key = "planning",
                      .text = "must be a table: [planning]"});
    table = nullptr;
  }
  KeyReader reader(table, "planning", errors);
  visit_keys(reader, planning.settings);
  reader.report_unknown();
  planning.obstacles = read_list<CellObstacle>(root, "obstacle", errors);
  planning.bodies = read_list<CellBody>(root, "body", errors);
  return planning;
}

}  // namespace glint
