// SPDX-License-Identifier: GPL-3.0-or-later
//
// Words and settings on the command line of `glint calibrate` that are refused.
#include "core/image/image_io.h"
#include "studies/calibrate/calibrate_run.h"
#include "studies/calibrate/place_run.h"
#include "studies/calibrate/plan_run.h"
#include "studies/calibrate/points_run.h"
#include "studies/calibrate/print_board.h"
#include "studies/output/result_folder.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {

class CalibrateWords : public CalibrateVerb {
 protected:
  CalibrateWords() {
    write_file(folder_ / "board.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 25\n");
    write_png(folder_ / "grey1.png", ImageF(80, 60, 0.5F), PixelDepth::k8Bit);
  }
};

TEST_F(CalibrateWords, WordsAreChecked) {
  write_file(folder_ / "poses.csv", "grey1.png,100,200,300,0,0,0.1\n");
  const CalibrateOptions with_poses = {
      .pictures = {"grey1.png"}, .board = "board.toml", .poses = {"poses.csv"}, .out = "out"};
  const auto refused = [&](const auto& say, const std::string& message) {
    CalibrateOptions options = with_poses;
    say(options);
    expect_refused_here([&] { calibrate_pictures(options); }, message);
  };
  refused([](auto& said) { said.setup = "hand"; }, "--setup hand: must be eye_in_hand or");
  refused([](auto& said) { said.method = "best"; }, "--method best: must be one of tsai, ");
  const auto refused_set = [&](const KeyValue& set, const std::string& message) {
    refused([&set](auto& said) { said.sets = {set}; }, message);
  };
  refused_set({"unit", "m"}, "must begin with \"convention.\"");
  refused_set({"prediction.splits", "0"}, "prediction.splits: is 0, must be in [1, 100]");
  refused_set({"prediction.folds", "5"}, "prediction.folds");
  expect_refused(
      {"grey1.png"}, {"--board", "board.toml", "--method", "park"}, "--method: needs --poses");
  expect_refused({"grey1.png"},
                 {"--board", "board.toml", "--set", "prediction.splits=2"},
                 "--set: prediction.splits: needs --poses");
}

/// Where nothing is calibrated nothing else is set than what the poses' numbers mean.
TEST_F(CalibrateWords, SetsThatAreNotOfPosesAreRefusedBesidePoints) {
  write_file(folder_ / "poses.csv", "grey1.png,100,200,300,0,0,0.1\n");
  for (const KeyValue& set : {KeyValue{"prior.focal_px", "5"},
                              KeyValue{"prediction.splits", "2"},
                              KeyValue{"unit", "m"},
                              KeyValue{"poses.pair", "order"}}) {
    const CalibrateOptions options = {
        .pictures = {"grey1.png"}, .poses = {"poses.csv"}, .camera = "c.toml", .sets = {set}};
    expect_refused_here([&] { poses_of_pictures(options); },
                        "--set: " + set.path + ": must begin with \"convention.\"");
  }
}

// A tool that was taken off them would be taken off a second time.
TEST_F(CalibrateWords, PosesOfAFolderAreNotReadOtherwise) {
  make_folder(folder_ / "before");
  write_file(folder_ / "before/calibration.json",
             R"({"hand_eye": {}, "intrinsics": {"prior": null}})");
  write_file(folder_ / "before/poses.toml", "[convention]\nunit = \"mm\"\n");
  for (const KeyValue& set : {KeyValue{"convention.flange_from_tcp", "[0, 0, 100, 0, 0, 0]"},
                              KeyValue{"convention.direction", "flange_from_base"}}) {
    const CalibrateOptions options = {
        .from = "before", .board = "board.toml", .out = "out", .sets = {set}};
    expect_refused_here([&] { calibrate_pictures(options); },
                        "--set: " + set.path + ": --from before has poses of the flange already");
  }
}

TEST_F(CalibrateWords, PlansThatCannotBeAreRefused) {
  write_file(folder_ / "camera.toml", "[camera]\nwidth_px = 80\nheight_px = 60\nfocal_x_px = 90\n");
  const auto refused = [&](const std::vector<KeyValue>& sets, const std::string& message) {
    const PosePlanOptions options = {
        .count = 5, .board = "board.toml", .camera = "camera.toml", .out = "out", .sets = sets};
    expect_refused_here([&] { plan_poses(options); }, message);
  };
  refused({{"plan.tilt_min_deg", "31"}}, "plan.tilt_min_deg: must not be above tilt_max_deg");
  refused({{"plan.near_mm", "30"}, {"plan.far_mm", "30"}}, "plan.near_mm: must be below far_mm");
  refused({{"plan.margin_px", "-1"}}, "plan.margin_px: is -1, must be >= 0");
  refused({{"plan.method", "best"}}, "plan.method: is \"best\", must be one of");
  refused({{"plan.tilt_deg", "20"}}, "plan.tilt_deg");
  // 250 mm of board and its outer squares do not fit into 60 px of 90 from 30 mm.
  refused({{"plan.near_mm", "20"}, {"plan.far_mm", "30"}}, "only 0 of the poses tried show");
}

TEST_F(CalibrateWords, ABoardThatIsNoneIsNotPrinted) {
  write_file(folder_ / "bad.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 0\n");
  expect_refused_here([] { print_board("bad.toml", "out"); }, "bad.toml:4:");
  EXPECT_THROW(print_board(folder_ / "none.toml", folder_ / "out"), IoError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

// The files of "right" have names of "left", of which there are results.
TEST_F(CalibrateWords, DefaultFoldersTakeNoResultsOfAnotherFileOfTheSameName) {
  const auto refused =
      [&](const std::string& out, ResultKind kind, const std::string& left, const auto& call) {
        const std::filesystem::path before = std::filesystem::current_path();
        std::filesystem::current_path(folder_ / "");
        make_folder(out);
        make_folder(left);
        mark_result_folder(out, kind, "", "../../../" + left);
        const std::string told = text_thrown_by<ConfigError>(call);
        std::filesystem::current_path(before);
        EXPECT_THAT(told, ::testing::HasSubstr(out + ": holds results of " + left + "; choose"));
      };
  refused("out/board/board", ResultKind::kBoard, "left/board.toml", [] {
    print_board("right/board.toml", "");
  });
  refused("out/rough/plan", ResultKind::kPlan, "left/rough.toml", [] {
    plan_poses({.count = 6, .camera = "right/rough.toml"});
  });
  refused("out/touched/place", ResultKind::kPlace, "left/touched.csv", [] {
    place_part({{.file = "right/touched.csv"}}, {});
  });
  refused("out/right/points", ResultKind::kPoints, "left/points.csv", [] {
    draw_points("right/points.csv", {.pictures = {"right/grey.png"}, .camera = "rough.toml"});
  });
}

TEST_F(CalibrateWords, APriorNeedsItsCamera) {
  const Arguments prior = {"--board", "board.toml", "--set", "prior.focal_px=5"};
  expect_refused({"grey1.png"}, prior, "--set: prior.focal_px: needs --camera");
  expect_refused({"grey1.png"},
                 {"--board", "board.toml", "--set", "convention.unit=m"},
                 "--set: convention.unit: needs --poses");
  write_file(folder_ / "camera.toml",
             "[camera]\nwidth_px = 80\nheight_px = 60\nfocal_x_px = 500\n");
  for (const auto& [set, told] :
       {std::pair("prior.focal_px=-1", "must be >= 0"), std::pair("prior.fx=1", "prior.fx")}) {
    expect_refused(
        {"grey1.png"}, {"--board", "board.toml", "--camera", "camera.toml", "--set", set}, told);
  }
}

}  // namespace
}  // namespace glint::test
