// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defect_metadata.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/units.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

DefectivePart one_dent_and_one_scratch() {
  RealisedDefect dent;
  dent.defect = {.label = "dents_1",
                 .group = "dents",
                 .id = 1,
                 .seed = 0xFFFFFFFFFFFFFFFFU,
                 .realisation = Realisation::kImprinted,
                 .place = {.centre_mm = {1.0, 2.0, 3.0}},
                 .triangle = 17,
                 .depth_mm = 0.05,
                 .wanted_depth_mm = 0.08,
                 .wall_mm = 0.1,
                 .diameter_mm = 0.8,
                 .angle_rad = 30.0 * kRadPerDeg,
                 .tool = "dent"};
  dent.is_made = true;
  dent.attempts = 2;
  dent.jitters = 3;
  dent.refusals = {{"the cut does not close", 4}};
  dent.removed_volume_mm3 = 0.25;
  dent.faces = 321;
  dent.seconds = 0.123;
  RealisedDefect scratch;
  scratch.defect = {.label = "scratches_1",
                    .group = "scratches",
                    .id = 2,
                    .type = DefectType::kScratch,
                    .triangle = -1,
                    .wall_mm = std::numeric_limits<double>::infinity(),
                    .length_mm = 3.0,
                    .width_mm = 0.3};
  scratch.reason = "no place keeps the distance";
  scratch.attempts = 20;
  scratch.refusals = {{"the cut does not close", 1}, {"too near", 19}};
  scratch.removed_volume_mm3 = 7.0;
  DefectivePart part;
  part.defects = {dent, scratch};
  part.limited_vertices = 12;
  return part;
}

std::vector<NamedGroup> two_groups() {
  return {{"dents", {.count = Interval(1, 8), .height_mm = Interval(0.05, 0.1)}},
          {"scratches", {.type = DefectType::kScratch, .tilt_rad = 5.0 * kRadPerDeg}}};
}

Json metadata() {
  return defects_json(one_dent_and_one_scratch(),
                      two_groups(),
                      {.seed = 4},
                      9,
                      {.translation_mm = {0.0, 0.0, 2.0}});
}

TEST(DefectsJson, TellsTheTablesWithTheKeysAndUnitsOfTheSceneFile) {
  const Json json = metadata();
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["seed"], 9);
  EXPECT_EQ(json["imprint"]["seed"], 4);
  EXPECT_EQ(json["limited_vertices"], 12);
  EXPECT_EQ(json["imprint"]["processing"]["levels"], 0);
  EXPECT_EQ(json["groups"]["dents"]["count"], Json({1.0, 8.0}));
  EXPECT_EQ(json["groups"]["dents"]["height_um"], Json({50.0, 100.0}));
  EXPECT_EQ(json["groups"]["scratches"]["type"], "scratch");
  EXPECT_DOUBLE_EQ(json["groups"]["scratches"]["tilt_deg"].get<double>(), 5.0);
}

TEST(DefectsJson, TellsWhatWasDrawnAndWhatCameOfIt) {
  const Json json = metadata();
  const Json& dent = json["defects"][0];
  EXPECT_EQ(dent["label"], "dents_1");
  EXPECT_EQ(dent["type"], "dent");
  EXPECT_EQ(dent["realisation"], "imprinted");
  EXPECT_EQ(dent["made"], true);
  EXPECT_FALSE(dent.contains("reason"));
  EXPECT_EQ(dent["place"]["scene_mm"], Json({1.0, 2.0, 3.0}));
  EXPECT_EQ(dent["place"]["part_mm"], Json({1.0, 2.0, 1.0}));
  EXPECT_EQ(dent["place"]["triangle"], 17);
  EXPECT_DOUBLE_EQ(dent["depth_um"].get<double>(), 50.0);
  EXPECT_DOUBLE_EQ(dent["wanted_depth_um"].get<double>(), 80.0);
  EXPECT_DOUBLE_EQ(dent["angle_deg"].get<double>(), 30.0);
  EXPECT_EQ(dent["diameter_mm"], 0.8);
  EXPECT_FALSE(dent.contains("length_mm"));
  EXPECT_EQ(dent["seed"].get<std::uint64_t>(), 0xFFFFFFFFFFFFFFFFU);
  EXPECT_EQ(dent["faces"], 321);
  EXPECT_EQ(dent["attempts"], 2);
  EXPECT_EQ(dent["jitters"], 3);
  EXPECT_EQ(dent["refusals"]["the cut does not close"], 4);
}

TEST(DefectsJson, TellsWhyADefectWasGivenUp) {
  const Json json = metadata();
  const Json& scratch = json["defects"][1];
  EXPECT_EQ(scratch["made"], false);
  EXPECT_EQ(scratch["reason"], "no place keeps the distance");
  EXPECT_TRUE(scratch["place"].is_null());
  EXPECT_TRUE(scratch["wall_mm"].is_null());
  EXPECT_EQ(scratch["width_mm"], 0.3);
  EXPECT_FALSE(scratch.contains("diameter_mm"));
  EXPECT_EQ(json["made"], 1);
  EXPECT_EQ(json["given_up"], 1);
  EXPECT_EQ(json["removed_volume_mm3"], 0.25);  // of the made one only
  EXPECT_EQ(json["refusals"], Json({{"the cut does not close", 5}, {"too near", 19}}));
}

TEST(DefectsJson, HoldsNoTimesAndReadsBackTheSame) {
  DefectivePart slower = one_dent_and_one_scratch();
  slower.defects[0].seconds = 99.0;
  const Json json =
      defects_json(slower, two_groups(), {.seed = 4}, 9, {.translation_mm = {0.0, 0.0, 2.0}});
  EXPECT_EQ(json.dump(2), metadata().dump(2));
  EXPECT_EQ(Json::parse(json.dump(2)).dump(2), json.dump(2));
  EXPECT_THAT(json.dump(), ::testing::Not(::testing::HasSubstr("second")));
}

TEST(DefectsJson, OfNoDefectsIsEmptyLists) {
  const Json json = defects_json({}, {}, {}, 1);
  EXPECT_EQ(json["defects"], Json::array());
  EXPECT_EQ(json["groups"], Json::object());
  EXPECT_EQ(json["refusals"], Json::object());
  EXPECT_EQ(json["made"], 0);
}

}  // namespace
}  // namespace glint
