// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/check_study.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/studies/imaging/path_support.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

nlohmann::ordered_json check_of(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", text);
  const Study study = load_study(folder / "study.toml", {});
  return check_study(study, {.threads = 1, .jobs = 1, .progress = Progress::Style::kNone});
}

/// The notes on the baseline of a study, as one text.
std::string notes_of_check(const std::string& text) {
  return check_of(text).at("baseline").at("notes").dump();
}

// Each flank of a dent 1 um deep and 3 mm wide reflects what lies 1 mrad beside: black, as all
// else.
TEST(CheckStudy, TellsOfADefectThatTheStudysOwnSceneHides) {
  const std::string shallow = replaced(kScene, "height_um = 100", "height_um = 1");
  const std::string mirror =
      replaced(shallow, "type = \"conductor\"\nroughness = 0.3", "type = \"mirror\"");
  EXPECT_THAT(notes_of_check(mirror),
              AllOf(HasSubstr("No design here shows the worst defect: smallest CNR is 0 at most"),
                    HasSubstr("is a mirror without roughness")));
  const std::string plain = shallow.substr(0, shallow.find("[defects.dent]"));
  EXPECT_THAT(notes_of_check(plain), Not(HasSubstr("shows the worst defect")));
}

// The prototype is rough and its dent deep: whatever its CNR is, it is more than 0.
TEST(CheckStudy, TellsOfAHiddenDefectBesideThePrototypes) {
  const std::string shallow = replaced(kScene, "height_um = 100", "height_um = 1");
  const std::string mirror =
      replaced(shallow, "type = \"conductor\"\nroughness = 0.3", "type = \"mirror\"");
  const auto check = check_of(mirror +
                              "[prototypes.rough]\n\"material.type\" = \"conductor\"\n"
                              "\"material.roughness\" = 0.3\n"
                              "\"defects.dent.height_um\" = 100\n");
  EXPECT_GT(check.at("prototypes").at("rough").at("scores").at("defects.min_cnr"), 0.0);
  const std::string notes = check.at("baseline").at("notes").dump();
  EXPECT_THAT(notes, AnyOf(HasSubstr("another design reached"), HasSubstr("No design here shows")));
  EXPECT_THAT(notes, Not(HasSubstr("smallest CNR is 0 at most")));
}

/// The scene under its ring, its bar or a tunnel, which it begins with.
std::string choice_of_light(const std::string& objective) {
  return replaced(kScene, "title = \"Plate\"\n", "lighting_use = \"tunnel\"\n") +
         "[scan]\npositions = 4\n[lighting.tunnel]\nradius_mm = 60\nblocks_view = false\n"
         "[variables]\n\"lighting_use\" = { choices = [\"ring\", \"tunnel\", \"bar\"] }\n"
         "[objective]\n" +
         objective + "\n[search]\nalgorithm = \"sobol\"\n[budget]\nevaluations = 4\n";
}

// One picture under ring and bar, the first and the last choice, and a scan of four under the
// tunnel between them. The dent is one under all of them.
TEST(CheckStudy, CallsAnObjectiveFlatWhereNothingElseTellsOtherwise) {
  const auto is_flat = [](const std::string& objective) {
    return check_of(choice_of_light(objective)).at("is_objective_flat").get<bool>();
  };
  EXPECT_FALSE(is_flat("minimise = \"scan.frames\""));
  EXPECT_TRUE(is_flat("maximise = \"defects.made\""));
}

// The width of a light needs no picture, and its search makes none; a race makes one for each of
// its 8 + 4 * 40 replicates, and all else that is scored again takes a few dozen. CPU times vary:
// the bar is far below that.
TEST(CheckStudy, CountsThePicturesOfTheRace) {
  const auto rescoring_s = [](const std::string& race) {
    const std::string text = "schema = 1\n" + kPathPlate + kPathRing +
                             "[variables]\n\"lighting.ring.outer_radius_mm\" = { min = 25, max = "
                             "35 }\n[objective]\nminimise = \"lighting.width_mm\"\n[search]\n"
                             "algorithm = \"sobol\"\n[budget]\nevaluations = 4\nrace = " +
                             race + "\n";
    return check_of(text).at("predicted_cpu_s").at("rescoring").get<double>();
  };
  EXPECT_GT(rescoring_s("40"), 1.5 * rescoring_s("0"));
}

// 0.3 mm a pixel: the first dent is 10 pixels wide, the second two.
TEST(CheckStudy, TellsOfDefectsThatAreNarrowerThanThreePixels) {
  EXPECT_THAT(notes_of_check(kScene), Not(HasSubstr("Narrower than three pixels")));
  const std::string small =
      replaced(kScene, "diameter_mm = 3\nheight_um = 100\n", "diameter_mm = 0.6\nheight_um = 10\n");
  EXPECT_THAT(notes_of_check(small), HasSubstr("Narrower than three pixels: dent_1 "));
}

}  // namespace
}  // namespace glint
