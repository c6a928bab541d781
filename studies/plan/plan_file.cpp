// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_file.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "hardware/robot/ur_settings.h"
#include "studies/cell/pose_numbers.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 1;

/// Null for none.
Json path_json(const std::filesystem::path& path) {
  return path.empty() ? Json(nullptr) : Json(path.string());
}

Json view_json(const PlannedView& view) {
  const bool is_planned = view.outcome == ViewOutcome::kPlanned;
  Json json = {{"name", view.name},
               {"outcome", name_of(view.outcome)},
               {"reason", view.reason},
               {"base_from_camera", six_numbers(view.base_from_camera)},
               {"base_from_flange", six_numbers(view.base_from_flange)},
               {"joints_deg", is_planned ? joints_deg(view.joints_rad) : Json(nullptr)},
               {"margin_mm", is_planned ? Json(view.margin_mm) : Json(nullptr)},
               {"singularity", is_planned ? Json(view.singularity) : Json(nullptr)},
               {"nearest_base_from_camera",
                view.nearest_base_from_camera ? six_numbers(*view.nearest_base_from_camera)
                                              : Json(nullptr)}};
  if (view.nearest_base_from_flange) {
    json["nearest_base_from_flange"] = six_numbers(*view.nearest_base_from_flange);
  }
  return json;
}

Json way_json(const PlannedPath& path) {
  Json joints = Json::array();
  for (const JointVector& joints_rad : path.joints_rad) {
    joints.push_back(joints_deg(joints_rad));
  }
  return {{"from", path.from},
          {"to", path.to},
          {"joints_deg", joints},
          {"margin_mm", path.margin_mm},
          {"duration_s", path.duration_s}};
}

/// Reads fields of one object and names what is wrong with them.
class Fields {
 public:
  Fields(const Json& object, std::string file, std::string path)
      : object_(object), file_(std::move(file)), path_(std::move(path)) {
    if (!object.is_object()) {
      throw ConfigError(fmt::format("{}: {}: must be an object", file_, path_));
    }
  }

  [[noreturn]] void fail(const std::string& key, const std::string& text) const {
    throw ConfigError(fmt::format("{}: {}{}: {}", file_, path_, key, text));
  }

  const Json& at(const std::string& key) const {
    const auto found = object_.find(key);
    if (found == object_.end()) {
      fail(key, "is missing");
    }
    return *found;
  }

  std::string text(const std::string& key) const {
    const Json& value = at(key);
    if (!value.is_string()) {
      fail(key, "must be a text");
    }
    return value.get<std::string>();
  }

  /// Null, or not there: empty.
  std::string text_if_any(const std::string& key) const {
    const auto found = object_.find(key);
    return found == object_.end() || found->is_null() ? std::string() : text(key);
  }

  double number(const std::string& key) const {
    const Json& value = at(key);
    if (!value.is_number()) {
      fail(key, "must be a number");
    }
    return value.get<double>();
  }

  JointVector six(const std::string& key, const Json& value) const {
    JointVector numbers;
    bool is_six = value.is_array() && value.size() == 6;
    for (std::size_t i = 0; is_six && i < 6; ++i) {
      is_six = value[i].is_number();
      numbers[static_cast<Eigen::Index>(i)] = is_six ? value[i].get<double>() : 0.0;
    }
    if (!is_six) {
      fail(key, "must be six numbers");
    }
    return numbers;
  }

  Eigen::Isometry3d pose(const std::string& key) const {
    const JointVector numbers = six(key, at(key));
    return pose_of_six({numbers.begin(), numbers.end()});
  }

  JointVector joints_rad(const std::string& key, const Json& value) const {
    JointVector joints = six(key, value) * kRadPerDeg;
    if (!(joints.cwiseAbs().maxCoeff() <= 2.0 * kPi + 1e-9)) {
      fail(key, "must be angles in [-360, 360] degrees");
    }
    return joints;
  }

 private:
  const Json& object_;
  std::string file_;
  std::string path_;
};

ViewOutcome outcome_of(const Fields& fields) {
  const std::string name = fields.text("outcome");
  for (int i = 0; i <= static_cast<int>(ViewOutcome::kNoPath); ++i) {
    if (name == name_of(static_cast<ViewOutcome>(i))) {
      return static_cast<ViewOutcome>(i);
    }
  }
  fields.fail("outcome", "\"" + name + "\" is no outcome of a view");
}

PlannedView read_view(const Json& json, const std::string& file, std::size_t i) {
  const Fields fields(json, file, fmt::format("views[{}].", i));
  PlannedView view = {.name = fields.text("name"),
                      .outcome = outcome_of(fields),
                      .reason = fields.text("reason"),
                      .base_from_camera = fields.pose("base_from_camera"),
                      .base_from_flange = fields.pose("base_from_flange")};
  if (view.outcome == ViewOutcome::kPlanned) {
    view.joints_rad = fields.joints_rad("joints_deg", fields.at("joints_deg"));
    view.margin_mm = fields.number("margin_mm");
    view.singularity = fields.number("singularity");
  }
  if (!fields.at("nearest_base_from_camera").is_null()) {
    view.nearest_base_from_camera = fields.pose("nearest_base_from_camera");
  }
  if (json.contains("nearest_base_from_flange")) {
    view.nearest_base_from_flange = fields.pose("nearest_base_from_flange");
  }
  return view;
}

PlannedPath read_path(const Json& json, const std::string& file, std::size_t i) {
  const Fields fields(json, file, fmt::format("paths[{}].", i));
  PlannedPath path = {.from = fields.text("from"), .to = fields.text("to")};
  const Json& joints = fields.at("joints_deg");
  if (!joints.is_array() || joints.size() < 2) {
    fields.fail("joints_deg", "must be two or more lists of six angles");
  }
  for (const Json& one : joints) {
    path.joints_rad.push_back(fields.joints_rad("joints_deg", one));
  }
  path.margin_mm = fields.number("margin_mm");
  path.duration_s = fields.number("duration_s");
  return path;
}

const Json& list_of(const Fields& fields, const std::string& key) {
  const Json& list = fields.at(key);
  if (!list.is_array()) {
    fields.fail(key, "must be a list");
  }
  return list;
}

void add_four_decimals(const JointVector& six, std::vector<std::string>& row) {
  for (const double number : six) {
    row.push_back(fmt::format("{:.4f}", number));
  }
}

}  // namespace

Json plan_json(const PlanFile& file) {
  const ViewPlan& plan = file.plan;
  Json json = {{"schema", kSchema},
               {"kind", "plan"},
               {"status", "done"},
               {"scene", file.scene.filename().string()},
               {"cell", file.cell.filename().string()},
               {"planned_from", path_json(file.origin.scene)},
               {"run", path_json(file.origin.run)},
               {"reach", {{"share", plan.reach_share}, {"margin_mm", plan.reach_margin_mm}}},
               {"views", Json::array()},
               {"paths", Json::array()},
               {"notes", file.notes}};
  double duration_s = 0.0;
  for (const PlannedView& view : plan.views) {
    json["views"].push_back(view_json(view));
  }
  for (const PlannedPath& path : plan.paths) {
    json["paths"].push_back(way_json(path));
    duration_s += path.duration_s;
  }
  json["duration_s"] = duration_s;
  return json;
}

void write_plan(const PlanFile& file, const std::filesystem::path& path) {
  write_file_durably(path, plan_json(file).dump(2) + "\n");
}

PlanFile read_plan(const std::filesystem::path& path) {
  const std::filesystem::path file =
      std::filesystem::is_directory(path) ? path / "plan.json" : path;
  const Json json = Json::parse(read_file(file), nullptr, false);
  if (json.is_discarded()) {
    throw ConfigError(file.string() + ": is no JSON");
  }
  const Fields fields(json, file.string(), "");
  if (fields.text("kind") != "plan" || fields.number("schema") != kSchema) {
    fields.fail("kind", fmt::format("is no plan of schema {}", kSchema));
  }
  PlanFile read = {.scene = file.parent_path() / fields.text("scene"),
                   .cell = file.parent_path() / fields.text("cell"),
                   .origin = {.scene = fields.text_if_any("planned_from"),
                              .run = fields.text_if_any("run"),
                              .is_told = json.contains("planned_from")}};
  const Json& views = list_of(fields, "views");
  for (std::size_t i = 0; i < views.size(); ++i) {
    read.plan.views.push_back(read_view(views[i], file.string(), i));
  }
  const Json& paths = list_of(fields, "paths");
  for (std::size_t i = 0; i < paths.size(); ++i) {
    read.plan.paths.push_back(read_path(paths[i], file.string(), i));
  }
  const Fields reach(fields.at("reach"), file.string(), "reach.");
  read.plan.reach_share = reach.number("share");
  read.plan.reach_margin_mm = reach.number("margin_mm");
  return read;
}

std::string plan_csv(const ViewPlan& plan) {
  std::string text =
      "view,outcome,margin_mm,singularity,joint_1_deg,joint_2_deg,joint_3_deg,joint_4_deg,"
      "joint_5_deg,joint_6_deg,camera_x_mm,camera_y_mm,camera_z_mm,camera_rx_rad,camera_ry_rad,"
      "camera_rz_rad,reason\n";
  for (const PlannedView& view : plan.views) {
    const bool is_planned = view.outcome == ViewOutcome::kPlanned;
    const JointVector joints_deg = view.joints_rad * kDegPerRad;
    std::vector<std::string> row = {csv_plain_text(view.name),
                                    std::string(name_of(view.outcome)),
                                    is_planned ? fmt::format("{:.3f}", view.margin_mm) : "",
                                    is_planned ? fmt::format("{:.5f}", view.singularity) : ""};
    if (is_planned) {
      add_four_decimals(joints_deg, row);
    } else {
      row.resize(row.size() + 6);
    }
    add_four_decimals(pose_difference(view.base_from_camera, Eigen::Isometry3d::Identity()), row);
    row.push_back(csv_plain_text(view.reason));
    text += csv_row(row);
  }
  return text;
}

}  // namespace glint
