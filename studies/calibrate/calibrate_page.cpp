// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/calibrate_page.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/calibrate/calibrate_files.h"
#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value, double step) {
  return std::round(value / step) * step;
}

/// x, y and residual of each corner, one after another; nothing where no residual is known.
Json corners_json(const BoardCorners& corners, const std::vector<Eigen::Vector2d>& residuals_px) {
  Json list = Json::array();
  for (std::size_t i = 0; i < residuals_px.size(); ++i) {
    list.push_back(rounded(corners.picture_px[i].x(), 0.01));
    list.push_back(rounded(corners.picture_px[i].y(), 0.01));
    list.push_back(rounded(residuals_px[i].x(), 0.0001));
    list.push_back(rounded(residuals_px[i].y(), 0.0001));
  }
  return list;
}

std::size_t count_accepted(const Json& result) {
  std::size_t accepted = 0;
  for (const Json& picture : result["pictures"]) {
    accepted += picture["accepted"].get<bool>() ? 1U : 0U;
  }
  return accepted;
}

std::string sentence(const Json& result) {
  std::string text = fmt::format("{} of {} pictures agree to {:.3g} px rms",
                                 count_accepted(result),
                                 result["pictures"].size(),
                                 result["rms_px"].get<double>());
  if (result["prediction_rms_px"].is_null()) {
    return text + "; how well it predicts other pictures is not known.";
  }
  text += fmt::format("; pictures that were left out are predicted to {:.3g} px",
                      result["prediction_rms_px"].get<double>());
  return text + (result["hand_eye"].is_null() ? ", each with a pose of its own."
                                              : " from the robot's pose alone.");
}

Json figure(const char* label, const Json& value, const char* unit, const std::string& note) {
  return {{"label", label},
          {"value",
           value.is_null() ? std::string("unknown") : fmt::format("{:.3g}", value.get<double>())},
          {"unit", value.is_null() ? "" : unit},
          {"note", note}};
}

/// The big numbers.
Json figures(const Json& result) {
  const Json& intrinsics = result["intrinsics"];
  const Json& sigma = intrinsics["sigma"]["focal_px"][0];
  Json list = Json::array();
  list.push_back(figure("rms of all corners", result["rms_px"], "px", ""));
  list.push_back(figure("pictures left out",
                        result["prediction_rms_px"],
                        "px",
                        fmt::format("rms, in {} parts", result["prediction_folds"].get<int>())));
  if (sigma.get<double>() > 0.0) {
    list.push_back(figure(
        "focal length known to",
        sigma,
        "px",
        fmt::format("standard deviation; {:.2f} px", intrinsics["focal_px"][0].get<double>())));
  }
  if (!result["hand_eye"].is_null()) {
    list.push_back(figure("hand-eye, place known to",
                          result["hand_eye"]["sigma_mm"],
                          "mm",
                          "standard deviation, three axes together"));
    list.push_back(figure("hand-eye, rotation known to",
                          result["hand_eye"]["sigma_deg"],
                          "degrees",
                          "standard deviation, three axes together"));
    list.push_back(figure("computed point",
                          result["point_error_px"]["rms"],
                          "px",
                          "standard deviation over the picture, at the board's distance"));
  }
  return list;
}

Json verdict(const Json& result) {
  Json details = Json::array();
  for (const Json& warning : result["warnings"]) {
    details.push_back("Warning: " + warning.get<std::string>());
  }
  for (const Json& note : result["notes"]) {
    details.push_back("Note: " + note.get<std::string>());
  }
  return {{"sentence", sentence(result)},
          {"tone", result["warnings"].empty() ? "good" : "neutral"},
          {"details", details},
          {"figures", figures(result)}};
}

std::string subtitle(const Json& result, const CalibrateInput& input) {
  const std::string setup = result["setup"].get<std::string>();
  const std::string what = setup == "none"          ? "A camera alone"
                           : setup == "eye_in_hand" ? "A camera on a robot's flange"
                                                    : "A camera beside a robot";
  return fmt::format("{}, {} x {} px; board of {} x {} corners, squares of {:.6g} mm",
                     what,
                     input.width_px,
                     input.height_px,
                     input.board.cols,
                     input.board.rows,
                     result["board"]["square_mm"].get<double>());
}

Json methods(const CalibrateInput& input) {
  Json lines = Json::array(
      {"Corners are fitted at full resolution, with a window that suits the blur around them. A "
       "residual is the place where a corner was found minus the place that was computed.",
       "Standard deviations come from the information of all corners at the solution. They hold "
       "when the errors are as they were modelled; the prediction of pictures that were left out "
       "holds whatever they are, and is what to compare calibrations by."});
  if (input.method) {
    lines.push_back(fmt::format(
        "The camera is from the pictures alone, the hand-eye from them and the robot's poses by "
        "OpenCV's method {}, the board the mean of what all pictures say. None of it knows its "
        "standard deviations beyond the camera's. Which pictures are used, and the sizes of the "
        "robot's and of the corners' errors, are from our own solution.",
        name_of(*input.method)));
  } else if (input.poses) {
    lines.push_back(
        "Intrinsics, hand-eye, board and six numbers of robot error per picture are estimated "
        "together; sizes of the robot's and of the corners' errors are estimated from the data.");
  }
  return lines;
}

}  // namespace

std::string calibrate_page(const Json& result,
                           const CalibrateInput& input,
                           const SolvedCalibration& solved,
                           const std::vector<std::vector<Eigen::Vector2d>>& residuals_px,
                           const std::string& when) {
  Json calibration = result;
  for (std::size_t i = 0; i < input.names.size(); ++i) {
    Json& picture = calibration["pictures"][i];
    picture["file"] = std::filesystem::path(input.names[i]).filename().string();
    picture["image"] = input.shown[i];
    picture["corners"] = corners_json(input.corners[i], residuals_px[i]);
  }
  return render_report({{"title", "Calibration"},
                        {"subtitle", subtitle(result, input)},
                        {"when", when},
                        {"verdict", verdict(result)},
                        {"calibration", calibration},
                        {"methods", methods(input)},
                        {"config_toml", calibration_toml(input, solved)},
                        {"provenance", provenance()}});
}

}  // namespace glint
