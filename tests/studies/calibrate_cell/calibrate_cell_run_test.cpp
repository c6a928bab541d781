// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rounds that have ended are not driven: their pictures are made here, and the board lies so far
// from the arm that no further pose is reached.
#include "studies/calibrate_cell/calibrate_cell_run.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "core/rng.h"
#include "studies/acquire/acquired.h"
#include "studies/cell/typed_permit.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kPictures = 10;
constexpr double kSquare_mm = 4.0;
constexpr const char* kSmallBoard = "[board]\ncols = 9\nrows = 6\nsquare_mm = 4\n";

/// Tilted to another side in each picture.
Isometry3d camera_from_small_board(int number) {
  const double about = 2.4 * number;
  const Vector3d side(std::cos(about), std::sin(about), 0.0);
  Isometry3d pose = Isometry3d::Identity();
  pose.translate(Vector3d(3.0 * side.x(), 2.0 * side.y(), 80.0 + 4.0 * (number % 3)));
  pose.rotate(AngleAxisd(number == 0 ? 0.0 : 0.4, side));
  pose.rotate(AngleAxisd(0.35 * (number % 5 - 2), Vector3d::UnitZ()));
  pose.translate(Vector3d(-4.0 * kSquare_mm, -2.5 * kSquare_mm, 0.0));
  return pose;
}

/// As a pinhole with a focal length of 500 px at this point of the picture sees it.
float grey_of(const Isometry3d& board_from_camera, double x_px, double y_px) {
  const Vector3d ray =
      board_from_camera.linear() * Vector3d((x_px - 240.0) / 500.0, (y_px - 180.0) / 500.0, 1.0);
  const Vector3d& from_mm = board_from_camera.translation();
  const Vector3d at_mm = from_mm - from_mm.z() / ray.z() * ray;
  const int col = static_cast<int>(std::floor(at_mm.x() / kSquare_mm));
  const int row = static_cast<int>(std::floor(at_mm.y() / kSquare_mm));
  const bool is_board = col >= -1 && col <= 8 && row >= -1 && row <= 5;
  return is_board && (col + row) % 2 == 0 ? 0.1F : 0.8F;
}

ImageF picture_of(const Isometry3d& camera_from_board) {
  constexpr int kSteps = 4;  // a pixel's side is cut into
  const Isometry3d board_from_camera = camera_from_board.inverse();
  ImageF picture(480, 360, 0.0F);
  for (int y = 0; y < kSteps * picture.height(); ++y) {
    for (int x = 0; x < kSteps * picture.width(); ++x) {
      picture(x / kSteps, y / kSteps) +=
          grey_of(board_from_camera, (x + 0.5) / kSteps, (y + 0.5) / kSteps) / (kSteps * kSteps);
    }
  }
  return picture;
}

/// Of the flange, as a robot tells it that is some hundredths of a millimetre off.
Isometry3d told_pose(int number) {
  Rng rng(1, Stream::kTest, static_cast<std::uint64_t>(number));
  Isometry3d pose(Eigen::Translation3d(1500.0, 0.0, 0.0));
  pose = pose * camera_from_small_board(number).inverse() * Eigen::Translation3d(0.0, -50.0, -30.0);
  pose.translate(0.02 * Vector3d(rng.normal(), rng.normal(), rng.normal()));
  pose.rotate(AngleAxisd(1e-4 * rng.normal(), Vector3d::UnitX()));
  pose.rotate(AngleAxisd(1e-4 * rng.normal(), Vector3d::UnitY()));
  return pose;
}

class CellRounds : public testing::Test {
 protected:
  CellRounds() {
    write_file(folder_ / "board.toml", kSmallBoard);
    std::string cell = test::kUr3Cell;
    for (int view = 0; view < 3; ++view) {
      cell += fmt::format("[[view]]\njoints_deg = [{}, -95, 95, -85, -90, 0]\n", 5 * view);
    }
    write_file(folder_ / "cell.toml",
               cell + "[camera]\naddress = \"127.0.0.1\"\nregion_px = [0, 0, 480, 360]\n");
    nlohmann::ordered_json pictures;
    for (int i = 0; i < kPictures; ++i) {
      pictures.push_back(kept(1, i, picture_of(camera_from_small_board(i))));
    }
    end_round(1, pictures);
  }

  /// A round whose only picture does not show the board: what is known stays as it is.
  void end_blank_round() const {
    end_round(2, nlohmann::ordered_json::array({kept(2, 0, ImageF(480, 360, 0.5F))}));
  }

  nlohmann::ordered_json calibrated(const calibrate_cell_detail::RoundTargets& targets,
                                    int poses_a_round = 8) const {
    const CalibrateCellOptions options = {
        .acquire = {.cell = folder_ / "cell.toml", .out = folder_ / "out"},
        .board = folder_ / "board.toml",
        .targets = targets,
        .poses_a_round = poses_a_round};
    return calibrate_cell(options, typed_permit(true, "calibrate --cell"));
  }

  nlohmann::ordered_json plan(int round) const {
    return nlohmann::ordered_json::parse(
        read_file(folder_ / fmt::format("out/plan_{}/plan.json", round)));
  }

 private:
  std::filesystem::path round_folder(int round) const {
    return folder_ / fmt::format("out/round_{}", round);
  }

  nlohmann::ordered_json kept(int round, int number, const ImageF& picture) const {
    const std::string file = fmt::format("{}.png", number);
    make_folder(round_folder(round));
    write_png(round_folder(round) / file, picture, PixelDepth::k8Bit);
    return picture_json({.view = fmt::format("board_{}", number),
                         .file = file,
                         .base_from_flange = told_pose(number)});
  }

  void end_round(int round, const nlohmann::ordered_json& pictures) const {
    const nlohmann::ordered_json acquired = {
        {"kind", "acquired"},
        {"status", "complete"},
        {"counts", {{"wanted", pictures.size()}, {"accepted", pictures.size()}}},
        {"pictures", pictures}};
    write_file(round_folder(round) / "acquired.json", acquired.dump());
  }

  TemporaryFolder folder_;
};

// Without what the plan promises it would end as the second round has not helped.
TEST_F(CellRounds, GoOnWhereAPlanForTheHandEyePromisesMore) {
  end_blank_round();
  const auto told = calibrated({.hand_eye_mm = 1e-6});
  EXPECT_EQ(told["status"], "no_pose_reached") << told;
  EXPECT_EQ(told["rounds"].size(), 2U);
  const auto third = plan(3);
  ASSERT_TRUE(third.contains("after")) << third;
  EXPECT_EQ(third["after"].size(), 24U);
  EXPECT_LT(third["after"][7]["hand_eye_mm"], third["before"]["hand_eye_mm"]);
}

// Both calls plan the second round, which no picture has been taken of.
TEST_F(CellRounds, PlanForWhatMissesItsTargetByMostNow) {
  EXPECT_EQ(calibrated({.hand_eye_mm = 1e-6})["status"], "no_pose_reached");
  const auto for_hand_eye = plan(2);
  EXPECT_EQ(calibrated({.point_px = 1e-6, .hand_eye_mm = 1000.0})["status"], "no_pose_reached");
  const auto for_all = plan(2);
  EXPECT_TRUE(for_all.contains("after")) << "it adds to the pictures";
  EXPECT_NE(for_all["poses"], for_hand_eye["poses"]);
}

// 900 poses are more than a plan tries.
TEST_F(CellRounds, EndWithTheirResultWhereNoPlanCanBeMade) {
  end_blank_round();
  const auto told = calibrated({.hand_eye_mm = 1e-6}, 300);
  EXPECT_EQ(told["status"], "no_pose_helps") << told;
}

}  // namespace
}  // namespace glint
