// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibration_trial/trial_page.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/image/image_io.h"
#include "core/units.h"
#include "studies/output/provenance.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kColumns = 4;
constexpr int kPageWidth_px = 1300;

std::string digits(const Json& value, int decimals) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), decimals) : "-";
}

Json row(const std::string& name,
         const Json& truth,
         const Json& estimate,
         const Json& sigma,
         int decimals) {
  const double error = estimate.get<double>() - truth.get<double>();
  return {name,
          digits(truth, decimals),
          digits(estimate, decimals),
          digits(error, decimals),
          digits(sigma, decimals)};
}

Json camera_table(const Json& result) {
  Json rows = Json::array();
  for (const auto& [name, term] : result["intrinsics"].items()) {
    const bool is_px = name.starts_with('f') || name.starts_with('c');
    rows.push_back(row(name + (is_px ? " [px]" : ""),
                       term["truth"],
                       term["estimate"],
                       term["sigma"],
                       is_px ? 2 : 5));
  }
  return {{"caption", "The camera"},
          {"head", {"", "truth", "estimate", "error", "standard deviation"}},
          {"rows", rows}};
}

/// Along and about each axis.
void add_pose_rows(const Json& truth, const Json& estimate, Json& rows) {
  const std::array<const char*, 3> axes = {"x", "y", "z"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    rows.push_back(row(fmt::format("{} [mm]", axes[i]),
                       truth["translation_mm"][i],
                       estimate["translation_mm"][i],
                       nullptr,
                       3));
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto degrees = [&](const Json& pose) {
      return kDegPerRad * pose["rotation_vector_rad"][i].get<double>();
    };
    rows.push_back(row(fmt::format("rotation about {} [deg]", axes[i]),
                       degrees(truth),
                       degrees(estimate),
                       nullptr,
                       4));
  }
}

Json hand_eye_table(const Json& result) {
  const Json& hand_eye = result["hand_eye"];
  Json rows = Json::array();
  add_pose_rows(hand_eye["truth"], hand_eye["estimate"], rows);
  rows.push_back({"distance of the positions [mm]",
                  "",
                  "",
                  digits(hand_eye["error_mm"], 3),
                  digits(hand_eye["sigma_mm"], 3)});
  rows.push_back({"angle between the rotations [deg]",
                  "",
                  "",
                  digits(hand_eye["error_deg"], 4),
                  digits(hand_eye["sigma_deg"], 4)});
  const auto add_noise = [&](const char* name, const Json& noise, int decimals) {
    rows.push_back(row(name, noise["truth"], noise["estimate"], nullptr, decimals));
  };
  add_noise("robot's error along an axis [mm]", result["noise"]["robot_mm"], 3);
  add_noise("robot's error about an axis [deg]", result["noise"]["robot_deg"], 4);
  return {{"caption", "Where the camera is"},
          {"head", {"", "truth", "estimate", "error", "standard deviation"}},
          {"rows", rows}};
}

Json goals_table(const Json& result) {
  Json rows = Json::array();
  for (const Json& goal : result["goals"]) {
    rows.push_back(
        {fmt::format("{} [{}]", goal["name"].get<std::string>(), goal["unit"].get<std::string>()),
         digits(goal["found"], 4),
         digits(goal["goal"], 3),
         goal["is_met"].get<bool>() ? "met" : "not met"});
  }
  return {{"caption", "Goals for 80 pictures of 2448 x 2050 pixels"},
          {"head", {"", "found", "at most", ""}},
          {"rows", rows}};
}

Json methods_table(const Json& result) {
  Json rows = Json::array();
  for (const Json& method : result["methods"]) {
    rows.push_back(
        {method["name"],
         method["failed"].get<bool>() ? "failed" : digits(method["prediction_rms_px"], 3)});
  }
  return {{"caption", "How well pictures that were left out are predicted"},
          {"head", {"method", "rms [px]"}},
          {"rows", rows}};
}

Json truth_panel(const Json& result) {
  return {{"id", "truth"},
          {"title", "Truth and estimate"},
          {"lead", "The estimate saw the picture files, poses.csv and board.toml alone."},
          {"tables",
           Json::array({camera_table(result),
                        hand_eye_table(result),
                        goals_table(result),
                        methods_table(result)})}};
}

std::string sentence(const Json& result) {
  return fmt::format(
      "{} of {} pictures were accepted; the camera's place was found to {:.3f} mm and {:.4f} "
      "degrees, the board the right way up: {}.",
      result["pictures"]["accepted"].get<int>(),
      result["pictures"]["rendered"].get<int>(),
      result["hand_eye"]["error_mm"].get<double>(),
      result["hand_eye"]["error_deg"].get<double>(),
      result["is_board_upright"].get<bool>() ? "yes" : "no");
}

}  // namespace

ImageF contact_sheet(const std::vector<ImageF>& pictures, int width_px) {
  const int factor = std::max(1, (pictures.front().width() + width_px - 1) / width_px);
  const int columns = std::min(kColumns, static_cast<int>(pictures.size()));
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  const ImageF first = reduce(pictures.front(), factor);
  ImageF sheet(columns * first.width(), rows * first.height(), 1.0F);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const ImageF small = reduce(pictures[i], factor);
    const int left = static_cast<int>(i) % columns * small.width();
    const int top = static_cast<int>(i) / columns * small.height();
    for (int y = 0; y < small.height(); ++y) {
      std::copy_n(small.row(y), small.width(), sheet.row(top + y) + left);
    }
  }
  return sheet;
}

ImageF shown_pictures(const std::filesystem::path& folder) {
  constexpr int kMax = 12;
  constexpr int kWidth_px = 320;
  std::vector<ImageF> shown;
  for (int i = 0; i < kMax; ++i) {
    const std::filesystem::path file = folder / "pictures" / trial_picture_name(i);
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) {
      shown.push_back(read_image(file));
    }
  }
  if (shown.empty()) {
    throw IoError((folder / "pictures").string() + ": holds no pictures");
  }
  return contact_sheet(shown, kWidth_px);
}

std::string trial_picture_name(int picture) {
  return fmt::format("picture_{:04}.png", picture);
}

std::string trial_page(const Json& result,
                       const std::string& title,
                       const ImageF& sheet,
                       const std::string& config_toml) {
  return render_report(
      {{"title", title},
       {"subtitle", "A calibration tried out on rendered pictures, whose truth is known"},
       {"verdict",
        {{"title", "Summary"},
         {"sentence", sentence(result)},
         {"tone", result["is_board_upright"].get<bool>() ? "neutral" : "bad"}}},
       {"scene",
        {{"size_px", {sheet.width(), sheet.height()}},
         {"picture", report_png(sheet, kPageWidth_px)},
         {"note", "the first pictures, as the files have them"}}},
       {"panels", Json::array({truth_panel(result)})},
       {"config_toml", config_toml},
       {"provenance", provenance()}});
}

}  // namespace glint
