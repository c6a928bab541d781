// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gallery's trial, and the same with 80 pictures. Pictures are kept in a bank, so that a test
// that was stopped goes on where it was; remove the bank to render them anew. Takes some minutes.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/calibration_trial/trial_run.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

fs::path gallery_file(const std::string& name) {
  return fs::path(GLINT_SOURCE_DIR) / "studies/gallery/calibrate_camera" / name;
}

Json run_gallery(const std::string& bank, const std::vector<KeyValue>& sets) {
  return run_calibration_trial(load_study(gallery_file("study.toml"), sets),
                               {.out = fs::path(GLINT_BANK_DIR) / bank, .threads = 2});
}

TEST(CalibrationBank, TheGallerysTrialGivesWhatItsReadmeSays) {
  const Json result = run_gallery("calibrate_camera_12", {});
  const Json expected = Json::parse(read_file(gallery_file("expected.json")));
  for (const auto& [name, row] : expected.items()) {
    std::string path = "/" + name;
    std::ranges::replace(path, '.', '/');
    EXPECT_NEAR(result.at(Json::json_pointer(path)).get<double>(),
                row.at("value").get<double>(),
                row.at("tolerance").get<double>())
        << name;
  }
}

TEST(CalibrationBank, EightyPicturesFindTheCamera) {
  const Json result = run_gallery("calibrate_camera_80", {{"calibration_trial.pictures", "80"}});
  std::cout << result.dump(2) << "\n";
  EXPECT_EQ(result["pictures"]["accepted"], 80);
  EXPECT_TRUE(result["is_board_upright"].get<bool>());
  // Three standard deviations of what the calibration itself says.
  EXPECT_LT(result["hand_eye"]["error_deg"].get<double>(),
            3.0 * result["hand_eye"]["sigma_deg"].get<double>());
  EXPECT_LT(result["hand_eye"]["error_mm"].get<double>(),
            3.0 * result["hand_eye"]["sigma_mm"].get<double>());
}

}  // namespace
}  // namespace glint
