// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/calibration_trial_settings.h"

#include "studies/definition/scene_viewpoints.h"

namespace glint {
namespace {

constexpr const char* kTrialTable = "calibration_trial";

/// Parts of the scene without which no board can be photographed.
void check_scene(const ConfigNode& table,
                 const SceneSettings& scene,
                 std::vector<Problem>& errors) {
  const auto fail = [&](const std::string& text) {
    errors.push_back(
        {.kind = Problem::Kind::kRelation, .place = table.place, .key = kTrialTable, .text = text});
  };
  try {
    scene_from_camera(scene, PoseSettings{});
  } catch (const ConfigError& error) {
    fail(error.problems().front().text);
  }
  if (scene.has_tunnel || scene.lights.empty()) {
    fail(
        "needs a light that shines on paper in [lighting], such as [lighting.ring] with mount = "
        "\"camera\"; a fringe tunnel is for mirrors");
  }
  if (!scene.defects.empty()) {
    fail("is of a board, which has no [defects]");
  }
}

}  // namespace

void visit_keys(KeyVisitor& keys, CalibrationTrialSettings& s) {
  keys.file("board", s.board, "board.toml or board.json of the board that is photographed");
  keys.require(!s.board.empty(), "board", "must be given: board.toml or board.json");
  keys.integer("pictures", s.pictures, Range::between(3, 10000), "of the board, one a robot pose");
  keys.integer("seed", s.seed, Range::at_least(0), "of the poses and of the robot's errors");
  keys.interval("distance_mm",
                s.distance_mm,
                Range{.min = 1, .max = 1e5},
                "from the lens to the middle of the board along the view");
  keys.number("tilt_deg",
              s.tilt_rad,
              Range::between(0, 70),
              "the board is tilted by up to this about each of its two axes");
  keys.number(
      "roll_deg", s.roll_rad, Range::between(0, 180), "and rolled by up to this about the view");
  keys.number("shift_mm",
              s.shift_mm,
              Range::between(0, 1e4),
              "and its middle is off the view by up to this along both axes of the picture");
  keys.number("robot_sigma_mm",
              s.robot_sigma_mm,
              Range::between(0, 100),
              "standard deviation of the robot's position along each axis; hidden from the "
              "calibration");
  keys.number("robot_sigma_deg",
              s.robot_sigma_rad,
              Range::between(0, 10),
              "of its rotation about each axis; hidden from the calibration");
  keys.number("paper",
              s.paper,
              Range{.min = 0, .max = 1, .min_excluded = true},
              "reflectance of the board's white");
  keys.number("ink", s.ink, Range::between(0, 1), "reflectance of its black");
  keys.require(s.ink < s.paper, "ink", "must be less than the paper's reflectance");
}

std::optional<CalibrationTrialSettings> read_calibration_trial(const ConfigNode& root,
                                                               const SceneSettings& scene,
                                                               std::vector<Problem>& errors) {
  const ConfigNode* table = root.find(kTrialTable);
  if (table == nullptr) {
    return std::nullopt;
  }
  CalibrationTrialSettings settings;
  KeyReader reader(table, kTrialTable, errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  check_scene(*table, scene, errors);
  return settings;
}

ConfigNode write_calibration_trial(CalibrationTrialSettings settings) {
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  return table;
}

std::vector<KeyRow> calibration_trial_keys() {
  std::vector<KeyRow> rows;
  CalibrationTrialSettings settings;
  KeyLister lister(kTrialTable, rows);
  visit_keys(lister, settings);
  return rows;
}

}  // namespace glint
