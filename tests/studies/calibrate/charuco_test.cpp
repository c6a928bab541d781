// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ChArUco board as `glint calibrate --print_board` prints it, photographed and calibrated from
// the files; pictures that cut it are worth what they show.
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/csv.h"
#include "core/image/image_io.h"
#include "core/units.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kFocal_px = 800.0;
constexpr double kCenterX_px = 322.0;
constexpr double kCenterY_px = 238.0;
constexpr double kTexel_mm = 20.0 / 160.0;  // of board.png
constexpr std::size_t kCorners = 6 * 4;

/// The sheet seen by a camera without distortion, each pixel the mean of 16 points; grey around it.
/// @param sheet  board.png, its upper left corner the origin, x along it, y down
ImageF photograph(const ImageF& sheet, const Isometry3d& camera_from_sheet) {
  const Isometry3d sheet_from_camera = camera_from_sheet.inverse();
  const auto seen = [&](double u, double v) {
    const Vector3d ray =
        sheet_from_camera.linear() *
        Vector3d((u - kCenterX_px) / kFocal_px, (v - kCenterY_px) / kFocal_px, 1.0);
    const Vector3d& eye = sheet_from_camera.translation();
    const Vector3d at = eye - eye.z() / ray.z() * ray;
    const int x = static_cast<int>(std::floor(at.x() / kTexel_mm));
    const int y = static_cast<int>(std::floor(at.y() / kTexel_mm));
    return x >= 0 && y >= 0 && x < sheet.width() && y < sheet.height() ? 0.8F * sheet(x, y) : 0.4F;
  };
  ImageF picture(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float sum = 0.0F;
      for (int i = 0; i < 16; ++i) {
        const int row = i / 4;
        sum += seen(x + (i % 4 + 0.5) / 4.0, y + (row + 0.5) / 4.0);
      }
      picture(x, y) = sum / 16.0F;
    }
  }
  return picture;
}

/// The sheet's middle at a place before the camera, tilted about both axes and rolled.
Isometry3d sheet_at(const ImageF& sheet, const Vector3d& middle_mm, const Vector3d& turn_deg) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translate(middle_mm);
  pose.rotate(Eigen::AngleAxisd(turn_deg.z() * kRadPerDeg, Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(turn_deg.y() * kRadPerDeg, Vector3d::UnitY()));
  pose.rotate(Eigen::AngleAxisd(turn_deg.x() * kRadPerDeg, Vector3d::UnitX()));
  pose.translate(Vector3d(-0.5 * kTexel_mm * sheet.width(), -0.5 * kTexel_mm * sheet.height(), 0));
  return pose;
}

/// A board as it is printed, and photographs of it.
struct CharucoPictures {
  TemporaryFolder folder;
  Arguments files;

  std::string board() const { return (folder / "board/board.toml").string(); }

  void print() const {
    write_file(folder / "charuco.toml",
               "[board]\nkind = \"charuco\"\ncols = 6\nrows = 4\nsquare_mm = 20\n");
    const ProgramResult printed =
        glint_in(folder, {"calibrate", "--print_board", "charuco.toml", "--out", "board"});
    EXPECT_EQ(printed.code, 0) << printed.err;
  }

  void photograph_all() {
    const ImageF sheet = read_image(folder / "board/board.png");
    const std::vector<std::pair<Vector3d, Vector3d>> views = {
        {{0, 0, 270}, {3, -2, 12}},
        {{4, 2, 280}, {25, 0, 10}},
        {{-3, 3, 280}, {-25, 5, -20}},
        {{2, -4, 285}, {0, 27, 30}},
        {{-4, 0, 285}, {5, -27, 14}},
        {{3, 3, 300}, {20, 20, -35}},
        {{-70, 0, 260}, {15, -10, 17}},
        {{30, 65, 260}, {-10, 20, 73}}};  // these two are cut
    for (const auto& [middle_mm, turn_deg] : views) {
      files.push_back((folder / fmt::format("view_{}.png", files.size())).string());
      write_png(
          files.back(), photograph(sheet, sheet_at(sheet, middle_mm, turn_deg)), PixelDepth::k8Bit);
    }
  }
};

/// Made once.
const CharucoPictures& charuco_pictures() {
  static const CharucoPictures& shared = []() -> const CharucoPictures& {
    static CharucoPictures made;
    made.print();
    made.photograph_all();
    return made;
  }();
  return shared;
}

class CharucoBoard : public CalibrateVerb {
 protected:
  const Arguments& pictures_ = charuco_pictures().files;
};

TEST_F(CharucoBoard, IsFoundAsItIsPrintedAlsoWhereItIsCut) {
  const nlohmann::json result = calibrate_json(pictures_, {"--board", charuco_pictures().board()});
  for (const auto& picture : result["pictures"]) {
    EXPECT_TRUE(picture["accepted"].get<bool>()) << picture;
  }
  EXPECT_LT(result["rms_px"].get<double>(), 0.05);
  const auto& lens = result["intrinsics"];
  EXPECT_NEAR(lens["focal_px"][0].get<double>(), kFocal_px, 1.0);
  EXPECT_NEAR(lens["focal_px"][1].get<double>(), kFocal_px, 1.0);
  EXPECT_NEAR(lens["center_px"][0].get<double>(), kCenterX_px, 1.0);
  EXPECT_NEAR(lens["center_px"][1].get<double>(), kCenterY_px, 1.0);

  std::map<std::string, std::size_t> corners;
  const auto rows = parse_csv(read_file(folder_ / "out/corners.csv"), "corners.csv");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ++corners[rows[i][0].text];
    EXPECT_EQ(rows[i].back().text, "known") << "markers tell how the board lies";
  }
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(corners[pictures_[i]], kCorners) << pictures_[i];
  }
  for (std::size_t i = 6; i < 8; ++i) {
    EXPECT_GE(corners[pictures_[i]], 6U) << pictures_[i];
    EXPECT_LT(corners[pictures_[i]], kCorners) << pictures_[i];
  }
}

TEST_F(CharucoBoard, OfAnotherDictionaryIsNone) {
  write_file(folder_ / "other.toml",
             "[board]\nkind = \"charuco\"\ncols = 6\nrows = 4\nsquare_mm = 20\n"
             "dictionary = \"6x6\"\n");
  expect_refused({pictures_.begin(), pictures_.begin() + 2},
                 {"--board", "other.toml"},
                 "no marker of the board was found");
}

}  // namespace
}  // namespace glint::test
