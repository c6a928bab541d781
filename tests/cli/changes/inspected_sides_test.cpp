// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint compare` inspects both sides of a pair whose simulated side knows its defects.
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/dented_plate.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class InspectedSides : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

// The photographed plate is sound: its dent is seen in the simulated picture alone.
TEST_F(InspectedSides, TellsADefectThatOneSideAloneShows) {
  const std::string dented = edited(kDentedPlate, {{"height_um = 100", "height_um = 400"}});
  write_file(folder_ / "dented.toml", dented);
  write_file(folder_ / "sound.toml", dented.substr(0, dented.find("[defects.dent]")));
  for (const std::string name : {"dented", "sound"}) {
    const ProgramResult result =
        glint_in(folder_, {"render", name + ".toml", "--quiet", "--out", name});
    ASSERT_EQ(result.code, 0) << result.err;
  }
  const Json result =
      json_of(folder_, {"compare", "dented/baseline", "sound/baseline", "--out", "out"});
  EXPECT_EQ(result["timings"]["render_s"], 0.0);
  const Json& inspection = result["pairs"][0]["inspection"];
  EXPECT_EQ(inspection["simulated"]["found"], 1) << inspection;
  EXPECT_EQ(inspection["simulated"]["missed"], 0);
  EXPECT_EQ(inspection["real"]["found"], 0) << inspection;
  EXPECT_EQ(inspection["real"]["missed"], 1);
  ASSERT_EQ(inspection["defects"].size(), 1U);
  const Json& defect = inspection["defects"][0];
  EXPECT_TRUE(defect["simulated"]["found"].get<bool>());
  EXPECT_FALSE(defect["real"]["found"].get<bool>());
  EXPECT_TRUE(defect["real"]["found_as"].is_null());
  for (const char* side : {"simulated", "real"}) {
    const Json& contrast = defect[side]["contrast"];
    EXPECT_LT(contrast["low"].get<double>(), contrast["high"].get<double>()) << side;
  }
}

/// Two dents where they are simulated and where they are photographed: all tests share a folder,
/// and what is found where the part has not moved.
class InspectedElsewhere : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_file(*folder_ / "scene.toml",
               edited(kDentedPlate,
                      {{"height_um = 100", "height_um = 400\nx_mm = [0, -5]\ny_mm = [0, 3]"}}));
    render("simulated", {"sensor.seed=1"});
    render("same", {"sensor.seed=2"});
  }

  static void TearDownTestSuite() {
    folder_.reset();
    in_place_.clear();
  }

  static void render(const std::string& name, const std::vector<std::string>& sets) {
    Arguments arguments = {"render", "scene.toml", "--quiet", "--out", name};
    for (const std::string& set : sets) {
      arguments.insert(arguments.end(), {"--set", set});
    }
    const ProgramResult result = glint_in(*folder_, arguments);
    ASSERT_EQ(result.code, 0) << result.err;
  }

  static std::string out_of(const std::string& real) { return "out_" + real; }

  static Json inspection(const std::string& real, const std::string& outline) {
    const Json result = json_of(*folder_,
                                {"compare",
                                 "simulated/baseline",
                                 real + "/baseline",
                                 "--outline",
                                 outline,
                                 "--out",
                                 out_of(real)});
    return result["pairs"][0]["inspection"];
  }

  /// What both sides show is what they show where the part lies in one place. @return it
  static Json expect_as_in_place(const std::string& real, const std::string& outline) {
    if (!in_place_.contains(outline)) {
      in_place_[outline] = inspection("same", outline);
    }
    const Json& in_place = in_place_.at(outline);
    Json there = inspection(real, outline);
    EXPECT_THAT(in_place["notes"].dump(), Not(HasSubstr("px from where")));
    EXPECT_THAT(there["notes"].dump(), HasSubstr("px from where the simulated picture has them"));
    for (const char* side : {"simulated", "real"}) {
      EXPECT_EQ(there[side], in_place[side]) << there;
      EXPECT_EQ(there[side]["found"], 2);
      for (const std::size_t i : {0U, 1U}) {
        EXPECT_NEAR(there["defects"][i][side]["contrast"]["value"].get<double>(),
                    in_place["defects"][i][side]["contrast"]["value"].get<double>(),
                    0.04)
            << there;
      }
    }
    return there;
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static std::map<std::string, Json> in_place_;  ///< by outline
};

TEST_F(InspectedElsewhere, IsInspectedWhereItWasShiftedTo) {
  render("shifted", {"sensor.seed=3", "camera.center_x_px=67", "camera.center_y_px=41"});
  for (const char* outline : {"auto", "threshold"}) {
    const Json moved = expect_as_in_place("shifted", outline)["moved"];
    EXPECT_NEAR(moved["shift_px"][0].get<double>(), 7.0, 0.1) << moved;
    EXPECT_NEAR(moved["shift_px"][1].get<double>(), -4.0, 0.1) << moved;
  }
  // The page shows the notes below what was found; names of variables are shortened there.
  EXPECT_THAT(read_file(*folder_ / (out_of("shifted") + "/report.html")),
              ContainsRegex("Photograph: [^`]*`[)],[A-Za-z_$]+[.]notes[.]length>0"));
}

// Edges inside the pictures are looked for within 8 px, and have no silhouette.
TEST_F(InspectedElsewhere, IsInspectedWhereInnerEdgesWereShiftedTo) {
  render("a_little", {"sensor.seed=3", "camera.center_x_px=63", "camera.center_y_px=43"});
  expect_as_in_place("a_little", "inner");
}

// 0.195 mm to a pixel instead of 0.2: 1.0256 times as large.
TEST_F(InspectedElsewhere, IsInspectedWhereItWasTurnedTo) {
  render("turned",
         {"sensor.seed=5",
          "camera.center_x_px=66",
          "camera.object_pixel_mm=0.195",
          "part.rotation_deg=[0,0,4]"});
  for (const char* outline : {"auto", "threshold"}) {
    const Json moved = expect_as_in_place("turned", outline)["moved"];
    EXPECT_NEAR(std::abs(moved["turn_deg"].get<double>()), 4.0, 0.2) << moved;
    EXPECT_NEAR(moved["scale"].get<double>(), 1.0256, 0.004) << moved;
    EXPECT_LT(moved["rest_px"].get<double>(), 0.2) << moved;
  }
}

}  // namespace
}  // namespace glint::test
