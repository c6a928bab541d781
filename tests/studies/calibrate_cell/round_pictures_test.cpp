// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/round_pictures.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/journal.h"
#include "studies/cell/typed_permit.h"
#include "tests/support/temporary_folder.h"

namespace glint::calibrate_cell_detail {
namespace {

bool has_ended(const std::string& acquired_json) {
  const TemporaryFolder folder;
  write_file(folder / "acquired.json", acquired_json);
  return ended_round(folder.path()).has_value();
}

// With a lamp that was forgotten all pictures are rejected: the same command takes them anew.
TEST(EndedRound, HasAtLeastOneAcceptedPicture) {
  EXPECT_TRUE(has_ended(R"({"status": "complete", "counts": {"wanted": 9, "accepted": 9}})"));
  EXPECT_TRUE(has_ended(R"({"status": "partial", "counts": {"wanted": 9, "accepted": 7}})"));
  EXPECT_FALSE(has_ended(R"({"status": "partial", "counts": {"wanted": 9, "accepted": 0}})"));
  EXPECT_FALSE(has_ended(R"({"status": "stopped", "counts": {"wanted": 9, "accepted": 3}})"));
  EXPECT_FALSE(has_ended("{"));
}

/// Its squares were measured, its file had 3.3 mm.
constexpr const char* kCalibration = R"({
  "intrinsics": {"width_px": 1224, "height_px": 1025, "focal_px": [3600, 3600],
                 "center_px": [612, 512], "radial": [0, 0, 0], "tangential": [0, 0], "free": []},
  "board": {"kind": "checkerboard", "cols": 12, "rows": 10, "square_mm": 3.31,
            "given_square_mm": 3.3, "mark": false},
  "hand_eye": null, "rms_px": 0.08, "prediction_rms_px": null, "covariance": []
})";

constexpr const char* kCameraCell = R"([camera]
address = "127.0.0.1"
region_px = [0, 0, 640, 480]
[camera.features]
BlackLevel = 0
)";

// It is not driven again: its pictures have to be by the camera as the cell has it now.
TEST(EndedRound, IsByTheSameCamera) {
  const TemporaryFolder folder;
  const AcquireOptions options = {.cell = folder / "cell.toml", .out = folder / "round_1"};
  make_folder(options.out);
  write_file(options.cell, kCameraCell);
  write_file(options.out / "acquired.json",
             R"({"status": "complete", "counts": {"wanted": 9, "accepted": 9}})");
  MountedPrototypes none({}, {});
  const MotionPermit permit = typed_permit(true, "calibrate --cell");
  const auto status = [&] { return acquire_round(options, none, permit)["status"]; };
  EXPECT_EQ(status(), "complete") << "an earlier program recorded nothing of its camera";
  const auto grounds = [&] { return picture_grounds(nullptr, read_cell(options.cell)); };
  AcquireJournal(options.out, "plan", "", grounds()).end_session();
  EXPECT_EQ(status(), "complete");
  std::string text = kCameraCell;
  text.replace(text.find("640"), 3, "800");
  write_file(options.cell, text);
  EXPECT_THAT(status,
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr(
                  "[camera] region_px is [0, 0, 640, 480] there, and [0, 0, 800, 480] now")));
  text = kCameraCell;
  text.replace(text.find("BlackLevel = 0"), 14, "BlackLevel = 8");
  write_file(options.cell, text);
  EXPECT_THAT(status,
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("BlackLevel is 0 there")));
}

// `glint calibrate` of pictures goes by default to the same folder, out/<folder of the
// cell>/calibrate, and reads its poses.toml again for --from: rounds of a cell must not put theirs
// in its place.
TEST(CheckRoundsFolder, LeavesOtherCalibrationsAndFilesAlone) {
  const TemporaryFolder folder;
  const auto check = [&] { check_rounds_folder(folder.path()); };
  EXPECT_NO_THROW(check());
  write_file(folder / "poses.toml", "mine");
  EXPECT_THAT(check,
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr(
                  "holds a poses.toml that is not of `glint calibrate --cell`; choose another")));
  make_folder(folder / "round_1");
  EXPECT_NO_THROW(check()) << "it is begun";
  write_file(folder / "run.json", R"({"verb": "calibrate"})");
  EXPECT_THAT(check,
              testing::ThrowsMessage<ConfigError>(
                  testing::HasSubstr("holds results of `glint calibrate`; choose another")));
}

// Corners of one board are not those of another: an older folder would fail without a hint.
TEST(CheckBoard, NamesTheFolderOfAnotherBoard) {
  const TemporaryFolder folder;
  write_file(folder / "board.toml", "[board]\ncols = 12\nrows = 10\nsquare_mm = 3.3\n");
  const auto check = [&] { check_board(folder / "out", folder / "board.toml"); };
  make_folder(folder / "out/round_1");
  EXPECT_NO_THROW(check()) << "nothing is calibrated yet";
  make_folder(folder / "out/calibration");
  const auto calibrated = [&](int cols) {
    nlohmann::json json = nlohmann::json::parse(kCalibration);
    json["board"]["cols"] = cols;
    write_file(folder / "out/calibration/calibration.json", json.dump());
  };
  calibrated(12);
  EXPECT_NO_THROW(check());
  calibrated(11);
  EXPECT_THAT(check,
              testing::ThrowsMessage<ConfigError>(
                  testing::AllOf(testing::HasSubstr("11 x 10 corners"),
                                 testing::HasSubstr("12 x 10 corners"),
                                 testing::HasSubstr("remove this folder"))));
}

}  // namespace
}  // namespace glint::calibrate_cell_detail
