// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/key_writer.h"
#include "core/units.h"
#include "hardware/calibration/rotation.h"
#include "studies/calibrate/corner_residuals.h"
#include "studies/calibrate/known_calibration.h"
#include "studies/definition/cell_settings.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// JSON has no infinity.
Json number_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// Nine numbers as the tables of a camera.
Json lens_json(const LensVector& v) {
  return {{"focal_px", {v[0], v[1]}},
          {"center_px", {v[2], v[3]}},
          {"radial", {v[4], v[5], v[6]}},
          {"tangential", {v[7], v[8]}}};
}

Json intrinsics_json(const CalibrateInput& input, const SolvedCalibration& solved) {
  Json json = lens_json(solved.lens);
  json["width_px"] = input.width_px;
  json["height_px"] = input.height_px;
  json["sigma"] = lens_json(solved.lens_sigma);
  // What was known beforehand: exactly where it is 0.
  json["prior"] =
      input.camera ? lens_json(input.camera_sigma.value_or(LensVector::Zero())) : Json(nullptr);
  json["free"] = Json::array();
  for (std::size_t i = 0; i < kLensSize; ++i) {
    if (solved.camera.is_free[i]) {
      json["free"].push_back(std::string(kLensNames[i]));
    }
  }
  return json;
}

/// How the picture is predicted when it is left out.
Json prediction_json(const SolvedCalibration& solved, std::size_t picture) {
  if (!is_used(solved, picture)) {
    return nullptr;
  }
  std::size_t place = 0;
  for (std::size_t i = 0; i < picture; ++i) {
    place += is_used(solved, i) ? 1U : 0U;
  }
  return number_json(solved.predicted_rms_px[place]);
}

/// How far the solution moves without the picture.
Json influence_json(const SolvedCalibration& solved, std::size_t i) {
  const ViewInfluence& influence = solved.influences[i];
  Json json = {{"cook", number_json(influence.cook)},
               {"focal_px", number_json(influence.focal_px)},
               {"center_px", number_json(influence.center_px)}};
  if (solved.joint) {
    json["hand_eye_deg"] = number_json(influence.rotation_rad * kDegPerRad);
    json["hand_eye_mm"] = number_json(influence.translation_mm);
  }
  return json;
}

Json picture_json(const CalibrateInput& input, const SolvedCalibration& solved, std::size_t i) {
  Json json = {{"file", input.names[i]}};
  if (!input.views[i].is_accepted()) {
    json["accepted"] = false;
    json["reason"] = reason_of(input, solved, i);
    json["rms_px"] = nullptr;
    json["influence"] = nullptr;
    return json;
  }
  const auto put = [&](bool accepted, const std::string& reason, double rms_px) {
    json["accepted"] = accepted;
    json["reason"] = reason;
    json["rms_px"] = number_json(rms_px);
    json["influence"] = accepted && !input.method ? influence_json(solved, i) : Json(nullptr);
  };
  if (!solved.joint) {
    const CalibratedPicture& picture = solved.camera.pictures[i];
    put(picture.accepted, picture.reason, picture.rms_px);
    return json;
  }
  const HandEyePicture& picture = solved.joint->pictures[i];
  // A closed form knows no errors of the robot: what is left over is the camera's.
  put(picture.accepted,
      picture.reason,
      input.method ? solved.camera.pictures[i].rms_px : picture.rms_px);
  json["prediction_px"] = prediction_json(solved, i);
  json["pose"] = input.poses->poses[input.pose_of[i]].name;
  json["chi_square"] = input.method ? Json(nullptr) : number_json(picture.chi_square);
  json["board_turn"] = picture.board_turn;
  return json;
}

const char* flange_or_base(bool is_flange) {
  return is_flange ? "flange" : "base";
}

Json pose_json(const char* from, const char* to, const Eigen::Isometry3d& pose) {
  return {{"from", from},
          {"to", to},
          {"rotation_vector_rad", vector_json(rotation_vector_rad(pose.linear()))},
          {"translation_mm", vector_json(pose.translation())}};
}

bool is_in_hand(const HandEyeCalibration& joint) {
  return joint.mounting == Mounting::kEyeInHand;
}

Json hand_eye_json(const CalibrateInput& input, const SolvedCalibration& solved) {
  const HandEyeCalibration& joint = *solved.joint;
  Json json = pose_json("camera", flange_or_base(is_in_hand(joint)), solved.poses.hand_eye);
  json["method"] = input.method ? std::string(name_of(*input.method)) : "glint";
  // Closed forms do not tell how well they are known.
  json["sigma_deg"] =
      input.method ? Json(nullptr) : number_json(joint.rotation_sigma_rad() * kDegPerRad);
  json["sigma_mm"] = input.method ? Json(nullptr) : number_json(joint.translation_sigma_mm());
  json["scatter_deg"] = number_json(solved.scatter.rotation_rad * kDegPerRad);
  json["scatter_mm"] = number_json(solved.scatter.translation_mm);
  return json;
}

std::string orientation_name(BoardOrientation orientation) {
  switch (orientation) {
    case BoardOrientation::kMark:
      return "mark";
    case BoardOrientation::kPattern:
      return "pattern";
    case BoardOrientation::kFirstPicture:
      break;
  }
  return "first picture";
}

Json board_json(const CalibrateInput& input, const SolvedCalibration& solved) {
  const Board& board = solved.board;
  Json json = {{"kind", board.kind == BoardKind::kCharuco ? "charuco" : "checkerboard"},
               {"cols", board.cols},
               {"rows", board.rows},
               {"square_mm", board.square_mm},
               {"given_square_mm", input.given_board.square_mm},
               {"mark", board.mark},
               {"given_mark", input.given_board.mark}};
  if (board.kind == BoardKind::kCharuco) {
    json["marker_mm"] = marker_side_mm(board);
    json["dictionary"] = fmt::format("{0}x{0}", 4 + static_cast<int>(board.dictionary));
  }
  if (solved.joint) {
    const HandEyeCalibration& joint = *solved.joint;
    json["orientation"] = orientation_name(joint.orientation);
    json["pose"] = pose_json("board", flange_or_base(!is_in_hand(joint)), solved.poses.board);
    json["measured_scale"] = {{"factor", number_json(joint.scale.factor)},
                              {"sigma", number_json(joint.scale.sigma)},
                              {"is_taken", joint.has_other_squares}};
  }
  return json;
}

Json map_json(const ResidualMap& map) {
  Json json = {{"cols", map.cols}, {"rows", map.rows}, {"cells", Json::array()}};
  for (const ResidualCell& cell : map.cells) {
    json["cells"].push_back({{"corners", cell.corners},
                             {"mean_px", {cell.mean_px.x(), cell.mean_px.y()}},
                             {"rms_px", cell.rms_px}});
  }
  return json;
}

Json rings_json(const std::vector<ErrorRing>& rings) {
  Json list = Json::array();
  for (const ErrorRing& ring : rings) {
    list.push_back({{"from_px", ring.from_px},
                    {"to_px", ring.to_px},
                    {"corners", ring.corners},
                    {"rms_px", ring.corners > 0 ? Json(ring.rms_px) : Json(nullptr)},
                    {"error_px", number_json(ring.error_px)}});
  }
  return list;
}

/// Of intrinsics, hand-eye and board, row by row; of the intrinsics alone without poses.
Json covariance_json(const Eigen::MatrixXd& covariance) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < covariance.cols(); ++k) {
      row.push_back(number_json(covariance(i, k)));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// To a millionth of a pixel: OpenCV's methods do not repeat their last bits.
Json rounded_json(double value_px) {
  constexpr double kPerPixel = 1e6;
  return number_json(std::round(value_px * kPerPixel) / kPerPixel);
}

Json methods_json(const SolvedCalibration& solved) {
  Json methods = Json::array();
  for (const MethodPrediction& method : solved.methods) {
    methods.push_back({{"name", method.name},
                       {"prediction_rms_px", rounded_json(method.rms_px)},
                       {"prediction_5fold_rms_px", rounded_json(method.five_fold.rms_px)},
                       {"failed", method.has_failed}});
  }
  return methods;
}

/// Of the method that was asked for.
Json five_fold_json(const SolvedCalibration& solved) {
  const auto method = std::ranges::find(solved.methods, solved.method, &MethodPrediction::name);
  return method == solved.methods.end() ? Json(nullptr) : rounded_json(method->five_fold.rms_px);
}

/// What to photograph next, the best first.
Json next_json(const CalibrateInput& input, const SolvedCalibration& solved) {
  Json views = Json::array();
  for (const NextView& view : solved.next.views) {
    Json json = {{"text", text_of(view, input.width_px, input.height_px)},
                 {"tilt_deg", view.tilt_rad * kDegPerRad},
                 {"near_side_deg", view.near_side_rad * kDegPerRad},
                 {"roll_deg", view.roll_rad * kDegPerRad},
                 {"middle_px", {view.middle_px.x(), view.middle_px.y()}},
                 {"distance_mm", view.distance_mm},
                 {"point_error_px", number_json(view.point_error_px)}};
    if (view.base_from_flange) {
      json["base_from_flange"] = pose_json("flange", "base", *view.base_from_flange);
    }
    views.push_back(std::move(json));
  }
  return {{"point_error_px", number_json(solved.next.point_error_px)}, {"views", std::move(views)}};
}

void put_joint(const CalibrateInput& input, const SolvedCalibration& solved, Json& json) {
  const HandEyeCalibration& joint = *solved.joint;
  json["setup"] = is_in_hand(joint) ? "eye_in_hand" : "eye_to_hand";
  json["hand_eye"] = hand_eye_json(input, solved);
  json["convention"] = input.convention ? convention_json(*input.convention) : Json(nullptr);
  json["noise"] = {{"corner_px", joint.noise.corner_px},
                   {"pattern_px", joint.noise.whole_pattern_px()},
                   {"robot_deg", joint.noise.robot_rad * kDegPerRad},
                   {"robot_mm", joint.noise.robot_mm}};
  const auto error_json = [&](double error_px) {
    return input.method ? Json(nullptr) : number_json(error_px);
  };
  json["point_error_px"] = {{"rms", error_json(joint.point.rms_px)},
                            {"center", error_json(joint.point.center_px)},
                            {"edge", error_json(joint.point.edge_px)}};
}

/// [camera] with intrinsics alone: all else is the scene's own.
ConfigNode camera_node(const CalibrateInput& input, const LensVector& lens) {
  constexpr std::array<const char*, kLensSize> kKeys = {
      "focal_x_px", "focal_y_px", "center_x_px", "center_y_px", "k1", "k2", "k3", "p1", "p2"};
  ConfigNode camera = ConfigNode::table();
  set_path(camera, "width_px", ConfigNode::from_integer(input.width_px));
  set_path(camera, "height_px", ConfigNode::from_integer(input.height_px));
  for (std::size_t i = 0; i < kLensSize; ++i) {
    set_path(camera, kKeys[i], ConfigNode::from_number(lens[static_cast<Eigen::Index>(i)]));
  }
  return camera;
}

/// Closed forms do not tell how well their hand-eye is known: then of the intrinsics alone.
std::optional<CovarianceSettings> known_covariance(const CalibrateInput& input,
                                                   const SolvedCalibration& solved) {
  constexpr Eigen::Index kWithHandEye = 15;
  Eigen::MatrixXd covariance = solved.camera.covariance;
  if (solved.joint && !input.method) {
    covariance = solved.joint->covariance.topLeftCorner<kWithHandEye, kWithHandEye>();
  }
  if (!covariance.allFinite()) {
    return std::nullopt;
  }
  return covariance_settings(covariance);
}

CalibrationSettings calibration_settings(const CalibrateInput& input,
                                         const SolvedCalibration& solved) {
  CalibrationSettings settings = {.covariance = known_covariance(input, solved)};
  if (!solved.joint) {
    return settings;
  }
  const Eigen::Isometry3d& hand_eye = solved.poses.hand_eye;
  MeasuredPoseSettings pose = {.pose = pose_settings({.rotation = hand_eye.linear(),
                                                      .translation_mm = hand_eye.translation()})};
  if (settings.covariance) {
    take_sigmas(*settings.covariance, pose);
  }
  if (is_in_hand(*solved.joint)) {
    settings.setup = CalibrationSetup::kEyeInHand;
    settings.flange_from_camera = pose;
  } else {
    settings.setup = CalibrationSetup::kEyeToHand;
    settings.base_from_camera = pose;
  }
  return settings;
}

}  // namespace

Json vector_json(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

std::string reason_of_view(const BoardView& view) {
  const std::string name = outcome_name(view.outcome);
  return view.why.empty() || view.why == name ? name : fmt::format("{}: {}", name, view.why);
}

std::string reason_of(const CalibrateInput& input,
                      const SolvedCalibration& solved,
                      std::size_t picture) {
  if (!input.views[picture].is_accepted()) {
    return reason_of_view(input.views[picture]);
  }
  return solved.joint ? solved.joint->pictures[picture].reason
                      : solved.camera.pictures[picture].reason;
}

Json calibration_json(const CalibrateInput& input,
                      const SolvedCalibration& solved,
                      const std::vector<std::vector<Eigen::Vector2d>>& residuals_px) {
  Json json = {{"schema", 1}, {"status", "done"}, {"setup", "none"}, {"pictures", Json::array()}};
  for (std::size_t i = 0; i < input.names.size(); ++i) {
    json["pictures"].push_back(picture_json(input, solved, i));
  }
  json["intrinsics"] = intrinsics_json(input, solved);
  json["rms_px"] = number_json(solved.rms_px);
  json["hand_eye"] = nullptr;
  json["board"] = board_json(input, solved);
  json["prediction_rms_px"] =
      solved.prediction_rms_px ? rounded_json(*solved.prediction_rms_px) : Json(nullptr);
  json["prediction_folds"] = solved.prediction_folds;
  json["prediction_5fold_rms_px"] = five_fold_json(solved);
  json["prediction_5fold_splits"] = solved.five_fold_splits;
  json["methods"] = methods_json(solved);
  json["next"] = next_json(input, solved);
  if (solved.joint) {
    put_joint(input, solved, json);
  }
  json["residual_map"] = map_json(residual_map(input, solved, residuals_px));
  json["growth"] = rings_json(error_rings(input, solved, residuals_px));
  json["covariance"] = solved.joint && !input.method ? covariance_json(solved.joint->covariance)
                                                     : covariance_json(solved.camera.covariance);
  json["warnings"] = solved.joint ? solved.joint->warnings : solved.camera.warnings;
  json["notes"] = input.notes;
  for (const std::string& note : solved.notes) {
    json["notes"].push_back(note);
  }
  return json;
}

std::string known_camera_toml(const CalibrateInput& input) {
  ConfigNode root = ConfigNode::table();
  set_path(root, "camera", camera_node(input, lens_vector(input.camera->intrinsics)));
  return "# The intrinsics that --camera gave\n" + to_toml(root);
}

std::string calibration_toml(const CalibrateInput& input, const SolvedCalibration& solved) {
  ConfigNode root = ConfigNode::table();
  set_path(root, "schema", ConfigNode::from_integer(kNewestSchema));
  set_path(root, "camera", camera_node(input, solved.lens));
  ConfigNode calibration = ConfigNode::table();
  CalibrationSettings settings = calibration_settings(input, solved);
  KeyWriter writer(calibration);
  visit_keys(writer, settings);
  set_path(root, "calibration", std::move(calibration));
  return "# glint calibrate: include = [\"calibration.toml\"] in a scene takes this camera\n" +
         to_toml(root);
}

}  // namespace glint
