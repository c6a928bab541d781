// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study.h"
#include "studies/definition/study_text.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A study file that is removed again.
class StudyFile {
 public:
  explicit StudyFile(const std::string& text) { write_file(path(), text); }

  fs::path path() const { return folder_ / "s.toml"; }

 private:
  TemporaryFolder folder_;
};

std::string error_of(const std::string& text, const std::vector<KeyValue>& sets = {}) {
  const StudyFile file(text);
  try {
    load_study(file.path(), sets);
  } catch (const ConfigError& error) {
    std::string message = error.what();
    const auto folder = message.find(file.path().string());
    return folder == 0 ? "s.toml" + message.substr(file.path().string().size()) : message;
  }
  return "";
}

constexpr const char* kSound = R"([lighting.tunnel]
shape = "free"
[defects.dent]
x_mm = [5]
y_mm = [10]
[variables]
"lighting.tunnel.control_mm.1" = { min = 60, max = 200 }
"scan.positions" = { min = 8, max = 24 }
"lighting.tunnel.shape" = { choices = ["semicylinder", "free"] }
"lighting.tunnel.radius_mm" = { min = 60, max = 200, when = "lighting.tunnel.shape == semicylinder" }
"lighting.tunnel.blocks_view" = {}
[objective]
maximise = "homogeneity.h_rms"
[constraints]
"defects.dent_1.cnr" = { min = 3 }
[prototypes.round]
title = "Round"
"lighting.tunnel.shape" = "semicylinder"
[budget]
evaluations = 10
wall_clock = "1h30m"
)";

TEST(Study, DerivativesAreForTheGaussianProcessUnderATunnel) {
  const std::string sound = std::string(kSound) + "[search]\n";
  EXPECT_EQ(error_of(sound + "derivatives = true\n"), "");
  EXPECT_EQ(error_of(sound + "derivatives = true\nalgorithm = \"gp\"\n"), "");
  EXPECT_EQ(error_of(sound + "derivatives = false\nalgorithm = \"bobyqa\"\n"), "");
  EXPECT_THAT(error_of(sound + "derivatives = true\nalgorithm = \"bobyqa\"\n"),
              AllOf(StartsWith("s.toml:23:"),
                    HasSubstr("search.derivatives: is available only with search.algorithm = "
                              "\"auto\" or \"gp\", not with \"bobyqa\"")));
  EXPECT_THAT(error_of(sound + "derivatives = true\nalgorithm = \"slsqp\"\n"),
              HasSubstr("not with \"slsqp\", which takes derivatives in any case"));
  EXPECT_THAT(error_of(sound + "derivatives = true\n[render]\nmethod = \"paths\"\n"),
              HasSubstr("search.derivatives: asks for derivatives, which path-traced scenes do not "
                        "have; allowed is false"));
  EXPECT_THAT(error_of(sound + "derivatives = true\n[sensor]\nexpose_to = 0.9\n"),
              HasSubstr("not known where sensor.expose_to sets the exposure"));
}

/// Studies without the key are what they were, to the last byte.
TEST(Study, DerivativesAreWrittenWhereTheyAreAskedFor) {
  const StudyFile plain(kSound);
  EXPECT_THAT(resolved_text(load_study(plain.path(), {})), Not(HasSubstr("derivatives")));
  const StudyFile asking(std::string(kSound) + "[search]\nderivatives = true\n");
  const Study study = load_study(asking.path(), {});
  EXPECT_TRUE(wants_derivatives(study));
  EXPECT_THAT(resolved_text(study), HasSubstr("derivatives = true"));
}

TEST(Study, ReadsVariablesOfEveryKind) {
  const StudyFile file(kSound);
  const Study study = load_study(file.path(), {});
  ASSERT_EQ(study.space.variables.size(), 5U);
  EXPECT_EQ(study.space.variables[0].kind, Variable::Kind::kFloat);
  EXPECT_EQ(study.space.variables[1].kind, Variable::Kind::kInteger);
  EXPECT_EQ(study.space.variables[2].kind, Variable::Kind::kChoice);
  EXPECT_EQ(study.space.variables[3].when_value, "semicylinder");
  EXPECT_EQ(study.space.variables[4].choices, (std::vector<std::string>{"false", "true"}));
  EXPECT_DOUBLE_EQ(study.budget.wall_clock_s, 5400.0);
  EXPECT_EQ(study.prototypes.at(0).title, "Round");
}

TEST(Study, APointBecomesTheSceneItStandsFor) {
  const StudyFile file(kSound);
  const Study study = load_study(file.path(), {});
  const SceneSettings round =
      scene_with(study, overrides_of(study, canonical(study.space, Point{77, 12, 0, 90, 0})));
  EXPECT_EQ(round.tunnel.shape, TunnelSettings::Shape::kSemicylinder);
  EXPECT_DOUBLE_EQ(round.tunnel.radius_mm, 90.0);
  EXPECT_DOUBLE_EQ(round.tunnel.control_mm[1], 77.0);
  EXPECT_EQ(round.scan.positions, 12);
  EXPECT_FALSE(round.tunnel.blocks_view);
  // The radius is not active for a free cross-section: it keeps the file's value.
  const SceneSettings free =
      scene_with(study, overrides_of(study, canonical(study.space, Point{77, 12, 1, 90, 1})));
  EXPECT_DOUBLE_EQ(free.tunnel.radius_mm, TunnelSettings{}.radius_mm);
}

TEST(Study, TheBaselineIsTheSceneItself) {
  const StudyFile file(kSound);
  const Study study = load_study(file.path(), {});
  const Point point = baseline_point(study);
  EXPECT_DOUBLE_EQ(point[0], 100.0);
  EXPECT_DOUBLE_EQ(point[1], 24.0);
  EXPECT_DOUBLE_EQ(point[2], 1.0);
}

TEST(Study, TheResolvedTextIsTheSameStudy) {
  const StudyFile file(kSound);
  const Study study = load_study(file.path(), {});
  const StudyFile resolved(resolved_text(study));
  const Study again = load_study(resolved.path(), {});
  EXPECT_EQ(resolved_text(study), resolved_text(again));
  EXPECT_EQ(config_hash(study), config_hash(again));
}

TEST(Study, AFileThatDescribesNoSceneIsRefused) {
  for (const char* text : {"", "# nothing\n", "schema = 1\n", "schema = 1\ntitle = \"Mine\"\n"}) {
    EXPECT_THAT(error_of(text),
                StartsWith("s.toml: describes no scene; it must hold at least one "
                           "of the tables [part] [material]"))
        << text;
  }
  EXPECT_EQ(error_of("[part]\n"), "");
  EXPECT_EQ(error_of("", {{"part.shape", "plate"}}), "") << "what is set counts as well";
}

// What leaves the machine says nothing about its folders.
TEST(Study, TheShownTextNamesFilesWithoutTheirFolders) {
  const TemporaryFolder folder;
  write_file(folder / "gear part.stl", "solid gear\nendsolid gear\n");
  const StudyFile file("title = \"/of/mine\"\n[part]\nfile = \"" +
                       (folder / "gear part.stl").string() + "\"\n");
  const Study study = load_study(file.path(), {});
  const std::string name = folder.path().string();
  EXPECT_THAT(resolved_text(study), HasSubstr(name));
  EXPECT_THAT(shown_text(study), Not(HasSubstr(name)));
  EXPECT_THAT(shown_text(study), HasSubstr("file = \"gear part.stl\""));
  EXPECT_THAT(shown_text(study), HasSubstr("title = \"/of/mine\""));
  EXPECT_EQ(without_folders("no " + name + "/gear part.stl", study), "no gear part.stl");
}

TEST(Study, TheHashLeavesOutTheBudgetOnly) {
  const StudyFile file(kSound);
  const Study study = load_study(file.path(), {});
  const Study longer = load_study(file.path(), {{"budget.evaluations", "500"}});
  const Study other = load_study(file.path(), {{"sensor.gain", "1.7"}});
  EXPECT_EQ(config_hash(study), config_hash(longer));
  EXPECT_NE(config_hash(study), config_hash(other));
}

// Lights that stay in the scene were called "part" before; runs begun then go on. Lights that move
// with the part are new where it is posed.
TEST(Study, TheHashKnowsTheFormerNameOfLightsInTheScene) {
  const auto hash_of = [](const std::string& mount, const std::string& pose) {
    const StudyFile file("[part]\nshape = \"plate\"\n" + pose + "[lighting.bar]\nmount = \"" +
                         mount + "\"\n");
    return config_hash(load_study(file.path(), {}));
  };
  const std::string pose = "position_mm = [0, 0, -20]\n";
  EXPECT_EQ(hash_of("scene", ""), hash_of("part", "")) << "the same picture";
  EXPECT_NE(hash_of("scene", pose), hash_of("part", pose));
  EXPECT_NE(hash_of("scene", pose), hash_of("camera", pose));
  const StudyFile file("[part]\nshape = \"plate\"\nposition_mm = [0, 0, -20]\n[lighting.bar]\n");
  Study former = load_study(file.path(), {});
  EXPECT_EQ(config_hash(former), hash_of("scene", pose)) << "the default";
  former.resolved.find("lighting")->items[0].find("mount")->text = "part";
  EXPECT_NE(config_hash(former), hash_of("scene", pose)) << "moves now";
}

TEST(Study, TheHashChangesWithEveryFileOfTheScene) {
  const TemporaryFolder folder;
  const fs::path table = folder / "metal.csv";
  const StudyFile file(kSound);
  Study study = load_study(file.path(), {});
  study.scene.material.nk_file = table;
  write_file(table, "one");
  const std::string hash = config_hash(study);
  EXPECT_EQ(config_hash(study), hash);
  write_file(table, "two");
  EXPECT_NE(config_hash(study), hash);
}

TEST(Study, APoseThatASetMakesIsNoVariable) {
  const std::string message = error_of(R"(
[lighting.ring]
[viewpoints]
source = "sphere"
[variables]
"viewpoint.0.position_mm.2" = { min = 500, max = 700 }
[objective]
maximise = "homogeneity.h_rms"
[budget]
evaluations = 10
)");
  EXPECT_THAT(
      message,
      ::testing::HasSubstr("s.toml:6:1: variables: viewpoint.0.position_mm.2: has no effect"));
}

TEST(Study, OverridesReachEveryKey) {
  const StudyFile file(kSound);
  const Study study = load_study(file.path(),
                                 {{"lighting.tunnel.control_mm.2", "123"},
                                  {"sensor.gain", "2.5"},
                                  {"lighting.tunnel.shape", "ellipse"}});
  EXPECT_DOUBLE_EQ(study.scene.sensor.gain, 2.5);
  EXPECT_EQ(study.scene.tunnel.shape, TunnelSettings::Shape::kEllipse);
}

TEST(StudyErrors, RefuseAScoreThatIsOnlyTold) {
  EXPECT_THAT(error_of("[variables]\n\"sensor.gain\" = { min = 1, max = 2 }\n"
                       "[objective]\nmaximise = \"rays.max_cells\"\n"),
              ::testing::HasSubstr("is reported only where it is below 16"));
}

// A ring in the place of a tunnel: what is left of the tunnel comes up at once.
TEST(StudyErrors, TellVariablesOfALightThatIsGoneWithTheScenesOwn) {
  const std::string told = error_of(
      "[lighting.ring]\nradius_mm = 60\n"
      "[variables]\n\"lighting.tunnel.slot_mm\" = { min = 1, max = 2 }\n"
      "\"lighting.ring.tilt_deg\" = { min = 1, max = 2 }\n"
      "[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  EXPECT_THAT(told, ::testing::HasSubstr("s.toml:2:1: lighting.ring.radius_mm: unknown key"));
  EXPECT_THAT(told,
              ::testing::HasSubstr("s.toml:4:1: variables: lighting.tunnel.slot_mm: the scene has "
                                   "no table [lighting.tunnel]"));
  EXPECT_THAT(told, ::testing::Not(::testing::HasSubstr("lighting.ring.tilt_deg")));
}

TEST(StudyErrors, NameTheirPlaceAndTheNearestKey) {
  EXPECT_THAT(error_of("[sensor]\ngian = 2\n"),
              ::testing::StartsWith("s.toml:2:1: sensor.gian: unknown key, the nearest known one "
                                    "is \"gain\""));
  EXPECT_THAT(error_of("[sensr]\ngain = 2\n"),
              ::testing::HasSubstr("unknown table, the nearest known one is \"sensor\""));
  EXPECT_THAT(error_of("[variables]\n\"sensor.gian\" = { min = 1, max = 2 }\n"
                       "[objective]\nmaximise = \"homogeneity.h_rms\"\n"),
              ::testing::HasSubstr("sensor.gian: the scene has no such key, the nearest one is "
                                   "\"sensor.gain\""));
  EXPECT_THAT(error_of("[variables]\n\"sensor.gain\" = { min = 3, max = 2 }\n"
                       "[objective]\nmaximise = \"homogeneity.h_rms\"\n"),
              ::testing::HasSubstr("s.toml:2:1: variables: sensor.gain: min 3 is above max 2"));
  EXPECT_THAT(error_of("[objective]\nmaximise = \"homogeneity.h_rsm\"\n"),
              ::testing::HasSubstr("homogeneity.h_rms"));
  EXPECT_THAT(error_of("[budget]\nwall_clock = \"tomorrow\"\n"),
              ::testing::HasSubstr("must be a duration"));
}

TEST(StudyErrors, AllOfThemComeInOnePass) {
  const std::string errors = error_of("[sensor]\ngain = -1\nbits = 9\n[part]\nlenght_mm = 3\n");
  EXPECT_THAT(errors, ::testing::HasSubstr("sensor.gain"));
  EXPECT_THAT(errors, ::testing::HasSubstr("sensor.bits"));
  EXPECT_THAT(errors, ::testing::HasSubstr("length_mm"));
}

TEST(StudyErrors, VariableLimitsBeyondTheKeysRangeAreRefused) {
  EXPECT_THAT(error_of("[variables]\n\"lighting.tunnel.duty\" = { min = 0.2, max = 1.5 }\n"
                       "[objective]\nmaximise = \"homogeneity.h_rms\"\n"),
              ::testing::HasSubstr("lighting.tunnel.duty: is 1.5, must be in [0, 1]"));
}

/// What a variable of a study with a ring is refused for.
std::vector<Problem> problems_of_variable(const std::string& name, const std::string& limits) {
  const StudyFile file("[lighting.ring]\n[variables]\n\"" + name + "\" = " + limits +
                       "\n[objective]\nmaximise = \"homogeneity.h_rms\"\n");
  try {
    load_study(file.path(), {});
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

// Told by kind and key: what the messages say is of no account.
TEST(StudyErrors, AVariableIsRefusedForItsKeysOwnRangeOnly) {
  const struct {
    const char* name;
    const char* limits;
  } refused[] = {{"sensor.gain", "{ min = 1, max = 1e300 }"},
                 {"sensor.gain", "{ min = -1, max = 2 }"},
                 {"scan.positions", "{ min = 0, max = 9 }"},
                 {"camera.working_distance_mm", "{ min = -5, max = 900 }"},
                 {"sensor.wavelengths_nm.0", "{ min = -5, max = 600 }"},
                 {"part.shape", R"({ choices = ["strip", "cube"] })"},
                 {"lighting.ring.type", R"({ choices = ["ring", "torch"] })"}};

  for (const auto& [name, limits] : refused) {
    const std::vector<Problem> problems = problems_of_variable(name, limits);
    ASSERT_EQ(problems.size(), 1U) << name;
    EXPECT_EQ(problems[0].kind, Problem::Kind::kOutOfRange) << name;
    EXPECT_EQ(problems[0].key, name);
    EXPECT_EQ(problems[0].place.line, 3) << name;
  }
  // Smaller than inner_radius_mm it may be: that may be a variable too.
  EXPECT_THAT(problems_of_variable("lighting.ring.outer_radius_mm", "{ min = 1, max = 90 }"),
              ::testing::IsEmpty());
}

TEST(Study, HomogeneityNeverComesWithoutLimitsAgainstAWhitePicture) {
  const std::string head = "[objective]\nmaximise = \"homogeneity.h_rms\"\n";
  const StudyFile bare(head);
  const Study without = load_study(bare.path(), {});
  ASSERT_EQ(without.goal.constraints.size(), 1U);
  EXPECT_EQ(without.goal.constraints[0].name, "homogeneity.clipped_share");
  const StudyFile dented(head + "[defects.dent]\nx_mm = [5]\ny_mm = [5]\n");
  EXPECT_EQ(load_study(dented.path(), {}).goal.constraints.back().name, "defects.min_cnr");
  const StudyFile own(head + "[constraints]\n\"homogeneity.clipped_share\" = { max = 0.5 }\n");
  const Study kept = load_study(own.path(), {});
  ASSERT_EQ(kept.goal.constraints.size(), 1U);
  EXPECT_DOUBLE_EQ(*kept.goal.constraints[0].max, 0.5);
}

TEST(Duration, IsReadAsPeopleWriteIt) {
  EXPECT_EQ(parse_duration_s("40s"), 40.0);
  EXPECT_EQ(parse_duration_s("8h"), 28800.0);
  EXPECT_EQ(parse_duration_s("1h30m"), 5400.0);
  EXPECT_EQ(parse_duration_s("12.5"), 12.5);
  EXPECT_FALSE(parse_duration_s("8 hours").has_value());
  EXPECT_FALSE(parse_duration_s("").has_value());
  EXPECT_FALSE(parse_duration_s("-3s").has_value());
}

// What a verb must not overwrite: also what an include, a prototype or a group of defects names.
TEST(InputFiles, AreAllThatAStudyIsReadFrom) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "tools");
  for (const char* name : {"wear.png", "other.png", "faces.ply", "tools/a.stl"}) {
    write_file(folder / name, "x");
  }
  write_file(folder / "base.toml", "[camera]\nwidth_px = 40\n");
  write_file(folder / "s.toml", R"(include = ["base.toml"]
[material.texture]
colour_file = "wear.png"
[lighting.ring]
[defects.dent]
count = 2
tool_folder = "tools"
region = "faces"
region_file = "faces.ply"
[prototypes.worn]
"material.texture.colour_file" = "other.png"
)");
  std::vector<std::string> names;
  for (const fs::path& file : input_files(load_study(folder / "s.toml", {}))) {
    names.push_back(file.filename().string());
  }
  EXPECT_THAT(names,
              ::testing::UnorderedElementsAre(
                  "s.toml", "base.toml", "wear.png", "other.png", "faces.ply", "tools"));
}

}  // namespace
}  // namespace glint
