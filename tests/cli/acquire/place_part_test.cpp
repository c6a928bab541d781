// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --cell --part` with twins: a part put down three times, and its spread.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <regex>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/units.h"
#include "studies/twin_cell/truth.h"
#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Where the part is known to lie beforehand: 1.2 mm and half a degree off.
constexpr const char* kAboutHere = R"([cell.base_from_part]
translation_mm = [281, -120.6, 20.3]
rotation_vector_deg = [0.2, -0.1, 0.4]
sigma_mm = [1, 1, 1]
sigma_deg = [0.5, 0.5, 0.5]

[[viewpoint]]
position_mm = [0, 0, 180]
direction = [0, 0, -1]
up = [0, 1, 0]

[[viewpoint]]
position_mm = [0, -37.424, 176.067]
direction = [0, 0.207912, -0.978148]
up = [0.34202, 0.939693, 0]

[[viewpoint]]
position_mm = [37.333, -12.556, 175.638]
direction = [-0.207405, 0.069756, -0.975765]
up = [0.173648, 0.984808, 0]

[[viewpoint]]
position_mm = [-37.333, 12.556, 175.638]
direction = [0.207405, -0.069756, -0.975765]
up = [-0.422618, 0.906308, 0]
)";

/// Tilted so far that side faces are seen, 5 mm of them in 6 pixels: beside the matt top they are
/// dark, and its rim lies near that of the plate.
constexpr const char* kTiltedViews = R"(
[[viewpoint]]
position_mm = [0, 0, 180]
direction = [0, 0, -1]
up = [0, 1, 0]

[[viewpoint]]
position_mm = [15.688, -61.329, 168.501]
direction = [-0.087156, 0.340719, -0.936117]
up = [0, 0.939693, 0.342020]

[[viewpoint]]
position_mm = [46.587, 45, 167.942]
direction = [-0.258819, -0.25, -0.933013]
up = [0, 0.965926, -0.258819]

[[viewpoint]]
position_mm = [-61.564, -14.742, 168.501]
direction = [0.342020, 0.081900, -0.936117]
up = [0, 0.996195, 0.087156]
)";

/// The gallery's truth with a matt plate, in pictures of 204 x 171 pixels and without distortion.
std::string matt_truth() {
  std::string text = edited(small_truth(),
                            {{"k1 = -0.08\n", ""},
                             {"p1 = 0.0004\n", ""},
                             {"samples = 4", "samples = 8"},
                             {"read_noise_e = 10\n", ""}});
  const std::size_t metal = text.find("type = \"conductor\"");
  return text.replace(
      metal, text.find("# A lens") - metal, "type = \"diffuse\"\nreflectance = [0.6]\n");
}

/// The camera of the twin as a calibration would have found it: 180 mm / 0.2 mm = 900 px.
void write_calibration(const fs::path& folder) {
  fs::create_directories(folder);
  json covariance = json::array();
  for (std::size_t i = 0; i < 21; ++i) {
    std::vector<double> row(21, 0.0);
    row[i] = i < 4 ? 0.01 : i < 9 ? 1e-8 : i % 6 >= 3 ? 1e-9 : 1e-4;  // px, mm, rad
    covariance.push_back(row);
  }
  const json zero = {0.0, 0.0, 0.0};
  const std::vector<double> turn = {0.3 * kRadPerDeg, -0.2 * kRadPerDeg, 0.5 * kRadPerDeg};
  write_file(
      folder / "calibration.json",
      json{{"intrinsics",
            {{"width_px", 306},
             {"height_px", 256},
             {"focal_px", {900.0, 900.0}},
             {"center_px", {153.0, 128.0}},
             {"radial", {-0.08, 0.0, 0.0}},
             {"tangential", {0.0004, 0.0}},
             {"free", {"fx", "fy", "cx", "cy", "k1", "p1"}}}},
           {"board",
            {{"kind", "checkerboard"},
             {"cols", 8},
             {"rows", 6},
             {"square_mm", 4.4},
             {"pose", {{"translation_mm", zero}, {"rotation_vector_rad", zero}}}}},
           {"rms_px", 0.1},
           {"prediction_rms_px", 0.3},
           {"covariance", covariance},
           {"hand_eye",
            {{"to", "flange"},
             {"translation_mm", {0.4, 50.2, 29.7}},
             {"rotation_vector_rad", turn}}},
           {"noise",
            {{"corner_px", 0.1}, {"robot_deg", 0.02}, {"robot_mm", 0.05}, {"pattern_px", 0.02}}}}
          .dump());
  write_file(folder / "calibration.toml",
             "[camera]\nwidth_px = 306\nheight_px = 256\nfocal_x_px = 900\nfocal_y_px = 900\n"
             "center_x_px = 153\ncenter_y_px = 128\nk1 = -0.08\np1 = 0.0004\n"
             "[calibration.flange_from_camera]\ntranslation_mm = [0.4, 50.2, 29.7]\n"
             "rotation_vector_deg = [0.3, -0.2, 0.5]\nsigma_mm = [0.01, 0.01, 0.01]\n"
             "sigma_deg = [0.002, 0.002, 0.002]\n");
}

/// The gallery's cell with a part that is put down 0.2 mm and 0.2 degrees elsewhere each time.
/// Nobody serves it.
class PartOfACell : public testing::Test {
 protected:
  explicit PartOfACell(const std::string& truth = with_three_quarters(read_file(kGalleryCell /
                                                                                "truth.toml"))) {
    write_file(folder_ / "truth.toml",
               truth + "placement_mm = [0.2, 0.2, 0]\nplacement_deg = [0, 0, 0.2]\n");
    const std::string known = truth.substr(0, truth.find("# The camera sits"));
    const std::size_t bar = known.find("[lighting.bar]");
    write_file(
        folder_ / "part.toml",
        edited(known.substr(0, bar) + known.substr(known.find("[render.paths]")) + kAboutHere,
               {{"schema = 1", "schema = 2"}}));
    write_calibration(folder_ / "camera");
    write_file(folder_ / "cell.toml", fast_cell());
  }

  TemporaryFolder folder_;
};

/// The same with twins that serve it.
class PlacedPart : public PartOfACell {
 protected:
  PlacedPart() { serve(); }

  explicit PlacedPart(const std::string& truth) : PartOfACell(truth) { serve(); }

  ~PlacedPart() override { glint_in(folder_, {"cell", "twin", "stop", "t"}); }

  void serve() const {
    json_of(folder_,
            {"cell", "twin", "both", "cell.toml", "--port", "0", "--detach", "--ready_file", "t"});
  }

  static Arguments call(const Arguments& more) {
    Arguments all = {"calibrate",
                     "--cell",
                     "cell.toml",
                     "--twin",
                     "t",
                     "--part",
                     "part.toml",
                     "--camera",
                     "camera",
                     "--placements",
                     "3",
                     "--confirmed",
                     "ring",
                     "--speed_share",
                     "1",
                     "--out",
                     "out",
                     "--json",
                     "--move"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  /// What the call leaves. @param code  the exit code it has to have
  json place(int code, const Arguments& more) const {
    const ProgramResult result = glint_in(folder_, call(more));
    EXPECT_EQ(result.code, code) << result.err << result.out;
    return result.out.empty() ? json() : json::parse(result.out).at("part");
  }

  /// Hands lift the part and put it back.
  void put_down(int number) const {
    json_of(folder_, {"cell", "twin", "place", "t", fmt::format("{}", number)});
  }

  /// Whether a first view of the first placement is there.
  bool has_picture() const {
    std::error_code none;
    const fs::recursive_directory_iterator files(folder_ / "out/part/placement_1/views", none);
    return std::any_of(begin(files), end(files), [](const fs::directory_entry& entry) {
      return entry.path().filename() == "aspect.png";
    });
  }

  RigidTransform truth_of(int placement) const {
    return read_truth(folder_ / "truth.toml").carrier_from_scene(placement);
  }
};

RigidTransform pose_of_json(const json& pose) {
  return pose_of(pose["translation_mm"].get<std::vector<double>>(),
                 pose["rotation_vector_rad"].get<std::vector<double>>());
}

double turn_deg(const RigidTransform& motion) {
  return kDegPerRad * Eigen::AngleAxisd(motion.rotation).angle();
}

/// The arm is up to 0.05 mm an axis off at each view, the same at each placement.
void expect_found_at(const RigidTransform& truth, const json& all) {
  const RigidTransform off = inverse(truth) * pose_of_json(all["placements"][0]["base_from_part"]);
  const double sigma_mm = all["placements"][0]["base_from_part"]["sigma_mm"];
  EXPECT_LT(sigma_mm, 0.2);
  EXPECT_LT(off.translation_mm.norm(), 3.0 * sigma_mm);
  const double sigma_deg = all["placements"][0]["base_from_part"]["sigma_deg"];
  EXPECT_LT(turn_deg(off), 3.0 * sigma_deg);
  EXPECT_LT(turn_deg(off), 0.3);
  for (const json& told : all["placements"]) {
    const bool is_settled = told["settled"].get<bool>();
    const std::string note =
        fmt::format("placement {}: has not settled", told["placement"].get<int>());
    EXPECT_EQ(all["notes"].dump().find(note) == std::string::npos, is_settled) << all["notes"];
  }
}

TEST_F(PlacedPart, IsFoundEachTimeAndNothingIsAssumed) {
  const json asked = place(1, {});
  EXPECT_EQ(asked["status"], "waiting");
  EXPECT_EQ(asked["next"]["placement"], 1);
  EXPECT_FALSE(fs::exists(folder_ / "out/part/placement_1")) << "nothing has been driven";
  EXPECT_THAT(glint_in(folder_, call({"--placed", "2"})).err,
              HasSubstr("placement 1 has not been photographed"));
  {
    // Killed in between, the same command goes on.
    Program program(folder_ / "", call({"--placed", "1"}));
    for (int i = 0; i < 30000 && !has_picture() && program.is_running(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    program.send(SIGKILL);
    program.wait();
  }
  EXPECT_THAT(glint_in(folder_, call({"--placed", "2"})).err,
              HasSubstr("placement 1 has not been photographed"))
      << "its pictures are not whole: they would be mixed with those of the second";
  const json first = place(1, {"--placed", "1"});
  EXPECT_EQ(first["status"], "waiting");
  EXPECT_EQ(first["next"]["placement"], 2);
  EXPECT_EQ(first["placements"][0]["pictures"], 4);
  const std::string taken = read_file(folder_ / "out/part/placement_1/acquired.json");
  const auto drawn = fs::last_write_time(folder_ / "out/part/edges_1.csv");
  put_down(2);
  EXPECT_EQ(place(1, {"--placed", "2"})["next"]["placement"], 3);
  EXPECT_EQ(read_file(folder_ / "out/part/placement_1/acquired.json"), taken);
  EXPECT_EQ(fs::last_write_time(folder_ / "out/part/edges_1.csv"), drawn) << "found once";
  put_down(3);
  const json all = place(0, {"--placed", "3"});
  EXPECT_EQ(all["status"], "placed");

  expect_found_at(truth_of(1), all);
  for (const int number : {2, 3}) {
    const auto found = [&](int k) {
      return pose_of_json(all["placements"][static_cast<std::size_t>(k - 1)]["base_from_part"]);
    };
    const RigidTransform moved = inverse(found(1)) * found(number);
    const RigidTransform true_move = inverse(truth_of(1)) * truth_of(number);
    EXPECT_LT((moved.translation_mm - true_move.translation_mm).norm(), 0.05) << number;
    EXPECT_GT(true_move.translation_mm.norm(), 0.05) << "or there is nothing to be found";
    EXPECT_LT((moved.rotation - true_move.rotation).norm(), 0.3 * kRadPerDeg) << number;
  }
  EXPECT_EQ(all["spread"]["placements"], 3);
  EXPECT_GT(all["spread"]["mm"].get<double>(), 0.05);
  const std::string placement = read_file(folder_ / "out/place/placement.toml");
  EXPECT_THAT(placement, HasSubstr("base_from_part"));
  const json again = place(0, {});
  EXPECT_EQ(again["base_from_part"], all["base_from_part"]);
  fs::remove_all(folder_ / "out/part/placement_1");
  EXPECT_EQ(place(1, {})["next"]["placement"], 1);
}

/// A matt plate from far to the side, in coarse pictures.
class MattPlate : public PlacedPart {
 protected:
  MattPlate() : PlacedPart(matt_truth()) {
    const std::string scene = read_file(folder_ / "part.toml");
    write_file(folder_ / "part.toml", scene.substr(0, scene.find("[[viewpoint]]")) + kTiltedViews);
    const fs::path camera = folder_ / "camera";
    write_file(camera / "calibration.json",
               edited(read_file(camera / "calibration.json"),
                      {{"306", "204"},
                       {"256", "171"},
                       {"[900.0,900.0]", "[600.0,600.0]"},
                       {"[153.0,128.0]", "[102.0,85.5]"},
                       {"[-0.08,0.0,0.0]", "[0.0,0.0,0.0]"},
                       {"[0.0004,0.0]", "[0.0,0.0]"}}));
    write_file(camera / "calibration.toml",
               edited(read_file(camera / "calibration.toml"),
                      {{"306", "204"},
                       {"256", "171"},
                       {"focal_x_px = 900", "focal_x_px = 600"},
                       {"focal_y_px = 900", "focal_y_px = 600"},
                       {"153", "102"},
                       {"128", "85.5"},
                       {"k1 = -0.08\np1 = 0.0004\n", ""}}));
  }
};

TEST_F(MattPlate, IsNotTurnedUntilItsTopPassesForTheWhole) {
  const json found = place(1, {"--placed", "1"})["placements"][0];
  const RigidTransform off = inverse(truth_of(1)) * pose_of_json(found["base_from_part"]);
  EXPECT_TRUE(found["settled"].get<bool>()) << found;
  EXPECT_LT(turn_deg(off), 3.0 * found["base_from_part"]["sigma_deg"].get<double>());
  EXPECT_LT(turn_deg(off), 0.3);
}

/// The same in a run: the part is seen by a design's ring, and another design has another one.
class PartOfADesign : public PartOfACell {
 protected:
  PartOfADesign() {
    const std::string scene = read_file(folder_ / "part.toml");
    for (const char* design : {"narrow", "wide"}) {
      fs::create_directories(folder_ / "run" / design);
      write_file(folder_ / "run" / design / "scene.toml", scene);
    }
    write_file(folder_ / "run/study.resolved.toml", scene);
    write_file(
        folder_ / "run/wide/scene.toml",
        std::regex_replace(scene, std::regex("outer_radius_mm = [0-9.]+"), "outer_radius_mm = 77"));
  }

  ProgramResult place(const Arguments& more) const {
    Arguments call = {"calibrate", "--cell", "cell.toml", "--camera", "camera", "--out", "out"};
    call.insert(call.end(), {"--json", "--move", "--part", "run/narrow/scene.toml"});
    call.insert(call.end(), more.begin(), more.end());
    return glint_in(folder_, call);
  }

  /// Its first placement as an acquisition that has ended leaves it, seen by lights of a scene.
  void end_placement(const std::string& scene) const {
    const fs::path folder = folder_ / "out/part/placement_1";
    fs::create_directories(folder);
    write_file(folder_ / "out/part/placed.json", R"({"placed": 1})");
    write_file(folder / "acquired.json",
               R"({"schema": 1, "kind": "acquired", "status": "complete", "twin": false,
                   "counts": {"accepted": 1}, "scene": "scene.toml", "calibration": null,
                   "pictures": []})");
    write_file(folder / "scene.toml", scene);
  }
};

TEST_F(PartOfADesign, WaitsForItsPrototype) {
  const ProgramResult result = place({"--placed", "1"});
  EXPECT_EQ(result.code, 1) << result.err;
  const json told = json::parse(result.out);
  EXPECT_EQ(told["status"], "waiting");
  EXPECT_EQ(told["part"]["next"]["design"], "narrow");
  EXPECT_THAT(told["part"]["next"]["text"].get<std::string>(),
              HasSubstr("mount the prototype of narrow (ring)"));
  EXPECT_FALSE(fs::exists(folder_ / "out/part/placement_1")) << "nothing has been driven";
  const ProgramResult other = place({"--mounted", "wide"});
  EXPECT_EQ(other.code, 1) << other.err;
  const json next = json::parse(other.out)["part"];
  EXPECT_EQ(next["status"], "waiting");
  EXPECT_EQ(next["next"]["design"], "narrow");
  EXPECT_EQ(next["next"]["in_place_of"], json({"wide"}));
  const json light = json::parse(place({"--mounted", "narrow"}).out)["part"];
  EXPECT_EQ(light["status"], "waiting");
  EXPECT_EQ(light["next"]["lights"], json({"ring"}));
  EXPECT_EQ(place({"--mounted", "narrow", "--confirmed", "ring"}).code, 3) << "nobody listens";
  EXPECT_THAT(place({"--mounted", "wider"}).err, HasSubstr("there are narrow, wide"));
  EXPECT_THAT(glint_in(folder_,
                       {"calibrate",
                        "--cell",
                        "cell.toml",
                        "--board",
                        "board.toml",
                        "--mounted",
                        "wide",
                        "--move"})
                  .err,
              HasSubstr("--mounted: needs --part"));
}

TEST_F(PartOfADesign, IsNotFoundInPicturesOfAnotherPrototype) {
  end_placement(read_file(folder_ / "run/wide/scene.toml"));
  const ProgramResult other = place({});
  EXPECT_EQ(other.code, 2) << other.out;
  EXPECT_THAT(other.err, HasSubstr("placement_1: holds pictures of another prototype"));
  EXPECT_THAT(other.err, HasSubstr("[lighting.ring] is built differently"));
  const std::string own = read_file(folder_ / "run/narrow/scene.toml");
  end_placement(edited(own, {{"radiance = [2]", "radiance = [3]"}}));
  EXPECT_THAT(place({}).err, HasSubstr("[lighting.ring] shines at another power"));
  end_placement(own);
  EXPECT_THAT(place({}).err, HasSubstr("simulated_1")) << "it is looked for in no picture at all";
}

TEST_F(PlacedPart, IsRefusedWhereItsPlaceCannotBeTold) {
  const auto error = [&](const Arguments& arguments) {
    const ProgramResult result = glint_in(folder_, arguments);
    EXPECT_EQ(result.code, 2) << result.out;
    return result.err;
  };
  EXPECT_THAT(error({"calibrate", "--part", "part.toml"}), HasSubstr("--part: needs --cell"));
  EXPECT_THAT(error({"calibrate", "--cell", "cell.toml", "--placed", "1", "--move"}),
              HasSubstr("--placed: need --part"));
  EXPECT_THAT(error({"calibrate", "--cell", "cell.toml", "--part", "part.toml", "--move"}),
              HasSubstr("--part: needs --board"));
  EXPECT_THAT(error(call({"--placed", "4"})), HasSubstr("--placed 4: --placements are 3"));
  const std::string scene = read_file(folder_ / "part.toml");
  write_file(folder_ / "part.toml", scene.substr(0, scene.find("[cell.base_from_part]")));
  EXPECT_THAT(error(call({})), HasSubstr("cell.base_from_part: is missing"));
  write_file(folder_ / "part.toml", scene);
  fs::create_directories(folder_ / "out/part");
  write_file(folder_ / "out/part/scene.toml", scene);
  Arguments over_itself = call({});
  std::ranges::replace(over_itself, std::string("part.toml"), std::string("out/part/scene.toml"));
  EXPECT_THAT(error(over_itself), HasSubstr("is read, and lies where results are written"));
  EXPECT_EQ(read_file(folder_ / "out/part/scene.toml"), scene);
  write_file(folder_ / "camera/calibration.toml",
             "[camera]\nwidth_px = 306\nheight_px = 256\nfocal_x_px = 900\n"
             "[calibration.base_from_camera]\ntranslation_mm = [0, 0, 900]\n");
  EXPECT_THAT(error(call({})), HasSubstr("where the camera is on the flange"));
}

}  // namespace
}  // namespace glint::test
