// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --place`: the part's place from touched points, pictures and boards.
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/config/toml.h"
#include "core/csv.h"
#include "hardware/calibration/rotation.h"
#include "studies/calibrate/place_run.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::json;
using ::testing::HasSubstr;

Isometry3d pose_of(const Json& json) {
  const auto vector = [&](const char* key) {
    const Json& v = json[key];
    return Vector3d(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = rotation_of(vector("rotation_vector_rad"));
  pose.translation() = vector("translation_mm");
  return pose;
}

class PlaceVerb : public CalibrateVerb {
 protected:
  Json place(const Arguments& more) const {
    Arguments all = {"calibrate"};
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {"--out", "out", "--json"});
    const ProgramResult result = glint_in(folder_, all);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.out.empty() ? Json() : Json::parse(result.out);
  }

  /// Touched points of a part at a pose.
  void write_touched(const std::string& name, const Isometry3d& base_from_part) const {
    std::string text = "name,x_mm,y_mm,z_mm,base_x_mm,base_y_mm,base_z_mm\n";
    int number = 0;
    for (const Vector3d& p :
         {Vector3d(0, 0, 0), Vector3d(80, 0, 0), Vector3d(0, 50, 0), Vector3d(40, 25, 6)}) {
      const Vector3d b = base_from_part * p;
      text += csv_row_of(fmt::format("p{}", ++number), p.x(), p.y(), p.z(), b.x(), b.y(), b.z());
    }
    write_file(folder_ / name, text);
  }

  /// Rows of corners.csv of some pictures as points of a part that is the board.
  void write_seen(const SharedCalibration& shared,
                  const std::string& name,
                  std::size_t every,
                  std::size_t max_pictures) const {
    const auto rows = parse_csv(read_file(shared.folder / "out/corners.csv"), "corners.csv");
    std::string text = "picture,x_mm,y_mm,z_mm,u_px,v_px\n";
    std::set<std::string> pictures;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (rows[i][9].text != "yes" && rows[i][9].text != "true" && rows[i][9].text != "1") {
        continue;
      }
      pictures.insert(rows[i][0].text);
      if (pictures.size() <= max_pictures && i % every == 0) {
        text += csv_row_of(rows[i][0].text,
                           *rows[i][3].number(),
                           *rows[i][4].number(),
                           0.0,
                           *rows[i][5].number(),
                           *rows[i][6].number());
      }
    }
    write_file(folder_ / name, text);
  }
};

Isometry3d some_place() {
  Vector6d six;
  six << 0.1, -0.2, 1.3, 410.0, -90.0, 22.0;
  return motion_of(six);
}

TEST_F(PlaceVerb, TouchedPointsGiveAPlaceThatAScenesCellTakes) {
  write_touched("touched.csv", some_place());
  const Json result = place({"--place", "touched.csv", "--set", "place.sigma_mm=0.1"});
  EXPECT_LT(six_of(pose_of(result["base_from_part"]).inverse() * some_place()).norm(), 1e-6);
  EXPECT_EQ(result["placements"][0]["by"], "touched points");
  EXPECT_LT(result["placements"][0]["points"][2]["distance_mm"].get<double>(), 1e-6);
  // 0.1 mm a point and axis, four points: 0.05 mm along each axis at least.
  EXPECT_GT(result["base_from_part"]["sigma_mm"].get<double>(), 0.05 * std::sqrt(3.0));
  EXPECT_EQ(result["spread"], nullptr);
  EXPECT_EQ(Json::parse(read_file(folder_ / "out/run.json"))["verb"], "calibrate --place");
  const ConfigNode root = load_toml(folder_ / "out/placement.toml");
  EXPECT_NEAR(root.at_path("cell.base_from_part.translation_mm.0")->number,
              result["base_from_part"]["translation_mm"][0].get<double>(),
              1e-9);
  EXPECT_GT(root.at_path("cell.base_from_part.sigma_mm.1")->number, 0.0);

  write_file(folder_ / "scene.toml",
             "include = [\"out/placement.toml\"]\n[part]\nshape = \"plate\"\n"
             "length_mm = 80\nwidth_mm = 50\nthickness_mm = 6\n[camera]\nwidth_px = 64\n"
             "height_px = 48\nfocal_x_px = 60\n[calibration]\nsetup = \"eye_in_hand\"\n"
             "[calibration.flange_from_camera]\n[[viewpoint]]\n[viewpoint.base_from_flange]\n"
             "translation_mm = [410, -90, 300]\nrotation_vector_deg = [180, 0, 0]\n");
  const ProgramResult scene =
      glint_in(folder_, {"render", "scene.toml", "--masks", "--out", "masks", "--quiet"});
  EXPECT_EQ(scene.code, 0) << scene.err;
}

TEST_F(PlaceVerb, SeveralPlacementsTellTheirSpread) {
  // Put down at -0.3, 0 and 0.3 mm along the part's x: a standard deviation of 0.3 mm.
  for (const int i : {-1, 0, 1}) {
    Isometry3d moved = some_place();
    moved.translate(Vector3d(0.3 * i, 0.0, 0.0));
    write_touched(fmt::format("t{}.csv", i + 1), moved);
  }
  const Json result = place({"--place", "t0.csv", "--place", "t1.csv", "--place", "t2.csv"});
  EXPECT_EQ(result["placements"].size(), 3U);
  EXPECT_NEAR(result["spread"]["mm"].get<double>(), 0.3, 1e-6);
  EXPECT_NEAR(result["spread"]["farthest_mm"].get<double>(), 0.3, 1e-6);
  // The next one lies off the mean of three by sqrt(1 + 1/3) of that.
  const double next_mm = 0.3 * std::sqrt(4.0 / 3.0);
  EXPECT_NEAR(result["base_from_part"]["sigma_mm"].get<double>(), next_mm, 1e-6);
  EXPECT_THAT(result["notes"].dump(), HasSubstr("estimated from 3 placements; 5 or more"));
  EXPECT_LT(six_of(pose_of(result["base_from_part"]).inverse() * some_place()).norm(), 1e-6);
  // The result is a placement, too.
  fs::rename(folder_ / "out", folder_ / "before");
  const Json again = place({"--place", "before/placement.toml"});
  EXPECT_EQ(again["placements"][0]["by"], "placement");
  EXPECT_NEAR(again["base_from_part"]["sigma_mm"].get<double>(), next_mm, 1e-6);
}

// 1 mm to either side of their mean along x: a standard deviation of sqrt(2) mm, and the next part
// is off their mean by sqrt(2) sqrt(1 + 1/2) mm.
TEST_F(PlaceVerb, TheNextPartLiesOffTheMeanOfTwo) {
  std::vector<PlaceInput> inputs;
  for (const int x_mm : {-1, 1}) {
    const fs::path file = folder_ / fmt::format("at{}.toml", x_mm);
    write_file(file, fmt::format("[cell.base_from_part]\ntranslation_mm = [{}, 0, 0]\n", x_mm));
    inputs.push_back({.file = file});
  }
  const auto result = place_part(inputs, {.out = folder_ / "out"});
  const auto& rows = result["base_from_part"]["covariance"];
  EXPECT_NEAR(std::sqrt(rows[3][3].get<double>()), std::sqrt(2.0) * std::sqrt(1.5), 1e-9);
  EXPECT_NEAR(result["spread"]["mm"].get<double>(), std::sqrt(2.0), 1e-9);
}

// Files that are alike tell nothing of how the part is put back: what is known of each stays.
TEST_F(PlaceVerb, PlacementsThatAreAlikeKeepWhatIsKnownOfEach) {
  write_touched("a.csv", some_place());
  write_touched("b.csv", some_place());
  const Arguments sigma = {"--set", "place.sigma_mm=0.1"};
  Arguments once = {"--place", "a.csv"};
  once.insert(once.end(), sigma.begin(), sigma.end());
  const Json one = place(once);
  fs::rename(folder_ / "out", folder_ / "one");
  Arguments twice = {"--place", "a.csv", "--place", "b.csv"};
  twice.insert(twice.end(), sigma.begin(), sigma.end());
  const Json two = place(twice);
  for (const char* key : {"sigma_mm", "sigma_deg"}) {
    const double known = one["base_from_part"][key].get<double>();
    EXPECT_NEAR(two["base_from_part"][key].get<double>(), known, 1e-9 * known);
  }
  fs::remove_all(folder_ / "out");
  write_file(folder_ / "c.toml", "[cell.base_from_part]\ntranslation_mm = [1, 2, 3]\n");
  write_file(folder_ / "d.toml", "[cell.base_from_part]\ntranslation_mm = [1, 2, 3]\n");
  const Json untold = place({"--place", "c.toml", "--place", "d.toml"});
  EXPECT_EQ(untold["base_from_part"]["sigma_mm"], nullptr);
  EXPECT_THAT(untold["notes"].dump(), HasSubstr("the placements are all alike"));
}

// The part is the board itself: three ways to the place that the calibration found.
TEST_F(PlaceVerb, PicturesAndBoardAgreeWithTheCalibration) {
  if (franka().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const std::string calibration = (franka().folder / "out").string();
  const fs::path set = photographs("field/handeye_franka");
  const Arguments poses = files_in(set, "franka_pose_rPe_", ".yaml");
  const auto with_poses = [&](Arguments arguments) {
    arguments.insert(arguments.end(), {"--camera", calibration, "--poses"});
    arguments.insert(arguments.end(), poses.begin(), poses.end());
    return arguments;
  };
  write_file(folder_ / "board.toml", "[part_from_board]\n");
  const Json known = place({"--place", "board.toml", "--camera", calibration});
  const Isometry3d board = pose_of(franka().result["board"]["pose"]);
  EXPECT_LT(six_of(pose_of(known["base_from_part"]).inverse() * board).norm(), 1e-9);
  EXPECT_GT(known["base_from_part"]["sigma_mm"].get<double>(), 0.1);

  const auto distance_mm = [&](const Json& placed) {
    const Isometry3d pose = pose_of(placed["base_from_part"]);
    return (pose * Vector3d(90, 60, 0) - board * Vector3d(90, 60, 0)).norm();
  };
  fs::remove_all(folder_ / "out");
  write_seen(franka(), "seen.csv", 7, 100);
  const Json seen = place(with_poses({"--place", "seen.csv"}));
  EXPECT_EQ(seen["placements"][0]["by"], "pictures");
  EXPECT_LT(distance_mm(seen), 3.0 * seen["base_from_part"]["sigma_mm"].get<double>());
  EXPECT_LT(distance_mm(seen), 5.0);

  fs::remove_all(folder_ / "out");
  Arguments pictures = files_in(set, "franka_image-", ".png");
  pictures.insert(pictures.end(), {"--place", "board.toml"});
  const Json looked = place(with_poses(pictures));
  EXPECT_EQ(looked["placements"][0]["pictures"], poses.size());
  EXPECT_LT(distance_mm(looked), 3.0 * looked["base_from_part"]["sigma_mm"].get<double>());
  EXPECT_LT(distance_mm(looked), 5.0);
}

// One picture of a camera in the cell is enough, and edges are worth half a point.
TEST_F(PlaceVerb, OnePictureOfACameraInTheCellAndEdgesDo) {
  if (board_on_robot().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  const std::string calibration = (board_on_robot().folder / "out").string();
  write_seen(board_on_robot(), "seen.csv", 1, 1);
  const Json seen = place({"--place", "seen.csv", "--camera", calibration});
  EXPECT_LT(seen["placements"][0]["rms_px"].get<double>(), 1.0);
  EXPECT_EQ(seen["placements"][0]["point_sigma"], "measured");
  // Every point as two edges, upright and level.
  std::string edges = "picture,x_mm,y_mm,z_mm,u_px,v_px,normal_u,normal_v\n";
  const auto rows = parse_csv(read_file(folder_ / "seen.csv"), "seen.csv");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    std::string row;
    for (const CsvField& field : rows[i]) {
      row += field.text + ",";
    }
    edges += row + "2,0\n" + row + "0,1\n";
  }
  write_file(folder_ / "edges.csv", edges);
  fs::remove_all(folder_ / "out");
  const Json by_edges = place({"--place", "edges.csv", "--camera", calibration});
  const Isometry3d apart =
      pose_of(seen["base_from_part"]).inverse() * pose_of(by_edges["base_from_part"]);
  EXPECT_LT(apart.translation().norm(), seen["base_from_part"]["sigma_mm"].get<double>());
  EXPECT_NEAR(by_edges["base_from_part"]["sigma_mm"].get<double>(),
              seen["base_from_part"]["sigma_mm"].get<double>(),
              0.2 * seen["base_from_part"]["sigma_mm"].get<double>());
  // Pictures of a board in the cell: what is said of poses is of none that matter.
  const fs::path set = photographs("calibration/board_on_robot");
  write_file(folder_ / "in_cell.toml", "[board_from_part]\n");
  fs::remove_all(folder_ / "out");
  const Json shown = place({"--place",
                            "in_cell.toml",
                            (set / "img00.png").string(),
                            "--camera",
                            calibration,
                            "--poses",
                            (set / "poses.csv").string(),
                            "--set",
                            "convention.unit=mm"});
  EXPECT_EQ(shown["placements"][0]["pictures"], 1);
  // On the robot's hand the board is where the robot holds it.
  write_file(folder_ / "board.toml", "[board_from_part]\ntranslation_mm = [0, 0, -5]\n");
  fs::remove_all(folder_ / "out");
  const Json held = place({"--place", "board.toml", "--camera", calibration});
  EXPECT_EQ(held["flange_from_part"]["to"], "flange");
  EXPECT_THAT(read_file(folder_ / "out/placement.toml"), HasSubstr("[cell.flange_from_part]"));
}

// As of --method, whose closed forms tell nothing of how well the hand-eye is known.
TEST_F(PlaceVerb, AHandEyeWithoutACovarianceStatesNoSigma) {
  if (board_on_robot().result.is_null()) {
    GTEST_SKIP() << "no photographs";
  }
  Json calibration = Json::parse(read_file(board_on_robot().folder / "out/calibration.json"));
  Json& rows = calibration["covariance"];
  rows.erase(rows.begin() + 9, rows.end());
  for (Json& row : rows) {
    row.erase(row.begin() + 9, row.end());
  }
  calibration["hand_eye"]["method"] = "park";
  write_file(folder_ / "calibration.json", calibration.dump());
  write_seen(board_on_robot(), "seen.csv", 1, 1);
  write_file(folder_ / "board.toml", "[board_from_part]\nsigma_mm = [0.1, 0.1, 0.1]\n");
  for (const std::string name : {"seen.csv", "board.toml"}) {
    const auto result =
        place_part({{.file = folder_ / name}},
                   {.camera = folder_ / "calibration.json", .out = folder_ / ("of_" + name)});
    const char* pose = name == "seen.csv" ? "base_from_part" : "flange_from_part";
    EXPECT_EQ(result[pose]["sigma_mm"], nullptr) << name;
    EXPECT_EQ(result[pose]["sigma_deg"], nullptr) << name;
    EXPECT_THAT(result["notes"].dump(),
                HasSubstr("the calibration by park does not say how well its hand-eye is known"));
  }
}

TEST_F(PlaceVerb, RefusesWhatTellsNoPlace) {
  const auto refused = [&](const std::string& name,
                           const std::string& text,
                           const std::string& message,
                           CalibrateOptions options = {}) {
    write_file(folder_ / name, text);
    options.out = "out";
    expect_refused_here([&] { place_part({{.file = name}}, options); }, message);
  };
  const std::string head = "x_mm,y_mm,z_mm,base_x_mm,base_y_mm,base_z_mm\n";
  refused("two.csv", head + "0,0,0,1,1,1\n9,0,0,9,1,1\n", "two.csv: 2 points do not determine");
  refused("line.csv",
          head + "0,0,0,1,1,1\n9,0,0,10,1,1\n5,0,0,6,1,1\n7,0,0,8,1,1\n",
          "line.csv: 4 points do not determine");
  refused("nan.csv", head + "0,0,0,1,nan,1\n", "nan.csv:2:9: 'nan' must be a number");
  refused("short.csv", head + "0,0,0,1,1\n", "short.csv:2:1: has 5 fields, must have 6");
  refused("none.csv", head, "none.csv: has no points");
  refused("columns.csv", "x_mm,y_mm\n1,2\n", "columns.csv:1:1: has no column z_mm");
  const std::string seen = "picture,x_mm,y_mm,z_mm,u_px,v_px\na.png,0,0,0,5,5\n";
  refused("seen.csv", seen, "--camera: is missing");
  refused("edge.csv",
          "picture,x_mm,y_mm,z_mm,u_px,v_px,normal_u,normal_v\na.png,0,0,0,5,5,0,0\n",
          "edge.csv:2:17: normal_u and normal_v are 0");
  refused("empty.toml", "schema = 2\n", "empty.toml: has 0 of [board_from_part]");
  refused("board.toml", "[part_from_board]\nshift_mm = 2\n", "board.toml:2:1: ");
  refused("board2.toml", "[part_from_board]\n", "--camera: is missing");
  refused("place.txt", "x", "place.txt: must be a .csv file");
  refused("t.csv", head + "0,0,0,1,1,1\n", "place.sigma", {.sets = {{"place.sigma", "1"}}});
  refused("t.csv", head + "0,0,0,1,1,1\n", "must begin with", {.sets = {{"seed", "1"}}});
  expect_refused({}, {"--place", "t.csv", "--setup", "eye_in_hand"}, "--place takes no --setup");
  expect_refused({}, {"--place", "absent.csv"}, "absent.csv", 3);
  if (board_on_robot().result.is_null() || franka().result.is_null()) {
    return;
  }
  const CalibrateOptions in_cell = {.camera = board_on_robot().folder / "out"};
  refused("one.csv", seen, "one.csv: its points leave the part's place open", in_cell);
  refused("arm.csv", seen, "--poses: is missing", {.camera = franka().folder / "out"});
}

}  // namespace
}  // namespace glint::test
