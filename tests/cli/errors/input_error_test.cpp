// SPDX-License-Identifier: GPL-3.0-or-later
//
// Wrong input: one line that says where, what and what is allowed; exit 2 or 3; nothing left
// behind.
#include <algorithm>

#include "tests/cli/program.h"

namespace glint::test {
namespace {

using Replacements = std::vector<std::pair<std::string, std::string>>;

using ::testing::MatchesRegex;

constexpr int kUsage = 2;
constexpr int kIo = 3;

/// A folder with study.toml and meshes, where runs are refused.
class InputError : public ::testing::Test {
 protected:
  void SetUp() override {
    write_file(folder_ / "rectangle.stl", rectangle_stl(0.2, 0.04));
    write_file(folder_ / "empty.stl", "solid a\nendsolid a\n");
    write_file(folder_ / "nothing.stl", "");
    write_file(folder_ / "nan.stl",
               edited(rectangle_stl(40, 12), {{"20.000000 6.000000", "20.0 nan"}}));
  }

  void write_study(const std::string& study) { write_file(folder_ / "study.toml", study); }

  /// Runs the study with other text in it and expects the message.
  void expect_refused(const std::string& study, int code, const std::string& message) {
    write_study(study);
    expect_call_refused({"run", "study.toml", "--out", "out/deeper/run"}, code, message);
  }

  void expect_call_refused(const Arguments& arguments, int code, const std::string& message) {
    const std::ptrdiff_t files = folder_.count();
    const ProgramResult result = glint_in(folder_, arguments);
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, MatchesRegex(message + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(folder_.count(), files) << "something is left behind";
  }

  static std::string small(const Replacements& replacements) {
    return edited(small_study(), replacements);
  }

  static std::string with_mesh(const std::string& keys) {
    return small({{"shape = \"strip\"", "shape = \"mesh\"\n" + keys}});
  }

  TemporaryFolder folder_;
};

TEST_F(InputError, MissingStudyFile) {
  expect_call_refused({"run", "nowhere.toml", "--out", "out"},
                      kIo,
                      "nowhere\\.toml: cannot be read: No such file or directory");
}

TEST_F(InputError, StudyThatIsAFolder) {
  expect_call_refused({"check", "."}, kIo, "\\.: cannot be read: it is a folder");
}

TEST_F(InputError, MissingPartFile) {
  const std::string study = with_mesh("file = \"nowhere.stl\"");
  expect_refused(
      study,
      kUsage,
      place_of(study, "file =") + "part\\.file: the file [^ ]*nowhere\\.stl does not exist");
}

TEST_F(InputError, MetresGivenAsMillimetres) {
  const std::string study = with_mesh("file = \"rectangle.stl\"");
  expect_refused(study,
                 kUsage,
                 place_of(study, "part]") +
                     "part\\.unit: rectangle\\.stl is 0\\.2 mm large: is the file in m\\? The unit "
                     "\"m\" makes it 200 mm; allowed: 1 to 5000 mm");
}

TEST_F(InputError, EmptyMesh) {
  expect_refused(with_mesh("file = \"empty.stl\""), kUsage, ".*empty\\.stl: it holds no triangle");
  expect_refused(with_mesh("file = \"nothing.stl\""), kUsage, ".*nothing\\.stl: the file is empty");
}

TEST_F(InputError, MeshWithNan) {
  expect_refused(with_mesh("file = \"nan.stl\""),
                 kUsage,
                 R"(.*nan\.stl:6:[0-9]+: vertex 2 is not finite \(20 nan 0\))");
}

// Metres: 200 x 40 mm, a flat sheet. Nothing sees its back, so that it is open does not matter.
TEST_F(InputError, OpenMeshIsNoError) {
  write_study(
      edited(small_study(),
             {{"shape = \"strip\"", "shape = \"mesh\"\nfile = \"rectangle.stl\"\nunit = \"m\""},
              {"length_mm = 400", "length_mm = 900"},
              {"slot_mm = 14", "slot_mm = 40"}}));
  const ProgramResult result = glint_in(folder_, {"check", "study.toml"});
  EXPECT_EQ(result.code, 0) << result.err;
  const ProgramResult part = glint_in(folder_, {"part", "rectangle.stl", "--unit", "m"});
  EXPECT_EQ(part.code, 0);
  EXPECT_THAT(part.out, ::testing::HasSubstr("not watertight: 4 open edges"));
}

TEST_F(InputError, UnknownKeyNamesTheNearest) {
  const std::string study = small({{"radius_mm = 80", "raduis_mm = 80"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "raduis_mm") +
                     "lighting\\.tunnel\\.raduis_mm: unknown key, the nearest known one is "
                     "\"radius_mm\"");
}

TEST_F(InputError, UnknownTableNamesTheNearest) {
  const std::string study = small({{"[sensor]", "[senser]"}});
  expect_refused(
      study,
      kUsage,
      place_of(study, "senser]") + "senser: unknown table, the nearest known one is \"sensor\"");
}

TEST_F(InputError, ValueOutOfRangeAndOfWrongKind) {
  std::string study = small({{"positions = 8", "positions = 0"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "positions") + "scan\\.positions: is 0, must be in \\[[0-9]+, .*");
  study = small({{"gain = 1.5", "gain = \"much\""}});
  expect_refused(study, kUsage, place_of(study, "gain") + "sensor\\.gain: must be a number, .*");
  study = small({{"title = \"Small\"", "title = 5"}});
  expect_refused(study, kUsage, place_of(study, "title") + "title: must be a text in quotes");
}

TEST_F(InputError, SeveralProblemsGiveALineEach) {
  write_study(small({{"gain = 1.5", "gain = -1"}, {"positions = 8", "positions = -8"}}));
  const ProgramResult result = glint_in(folder_, {"check", "study.toml"});
  EXPECT_EQ(result.code, kUsage);
  EXPECT_THAT(result.err,
              MatchesRegex("study\\.toml:[^\n]*sensor\\.gain: [^\n]*\n"
                           "study\\.toml:[^\n]*scan\\.positions: [^\n]*\n"));
}

TEST_F(InputError, MinAboveMax) {
  const std::string study = small({{"min = 60", "min = 160"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "\"lighting.tunnel.radius_mm\"") +
                     "variables: lighting\\.tunnel\\.radius_mm: min 160 is above max 120");
}

TEST_F(InputError, UnknownVariablePathNamesTheNearest) {
  const std::string study = small({{"tunnel.radius_mm\"", "tunnel.raduis_mm\""}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "\"lighting.tunnel.raduis_mm\"") +
                     "lighting\\.tunnel\\.raduis_mm: the scene has no such key, the nearest one is "
                     "\"lighting\\.tunnel\\.radius_mm\"");
}

TEST_F(InputError, VariableBeyondItsKeysRange) {
  const std::string study =
      small({{"tunnel.base_mm\" = { min = -10, max = 10", "tunnel.duty\" = { min = 0.1, max = 3"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "\"lighting.tunnel.duty\"") +
                     R"(variables: lighting\.tunnel\.duty: is 3, must be in \[0, 1\])");
}

TEST_F(InputError, UnknownFieldOfAVariable) {
  const std::string study = small({{"min = 60", "minimum = 60"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "minimum") +
                     "variables: lighting\\.tunnel\\.radius_mm: minimum "
                     "is not allowed here; min, max, step, log, when are");
}

TEST_F(InputError, CameraInsideThePart) {
  std::string study = small({{"working_distance_mm = 300", "working_distance_mm = 1"}});
  study = edited(study, {{"shape = \"strip\"", "shape = \"strip\"\nthickness_mm = 30"}});
  expect_refused(
      study,
      kUsage,
      place_of(study, "working_distance_mm") +
          "camera\\.working_distance_mm: puts the camera at \\(0, 0, 1\\) mm, inside the "
          "part; it must be outside of the part, which reaches up to z = .* mm");
  study = small({{"[render]", "[[viewpoint]]\nposition_mm = [3, 0, -0.5]\n\n[render]"}});
  expect_refused(
      study,
      kUsage,
      place_of(study, "position_mm") +
          "viewpoint\\.0\\.position_mm: puts the camera at \\(3, 0, -0\\.5\\) mm, inside "
          "the part; .*");
}

TEST_F(InputError, PartOutsideTheImage) {
  const std::string study =
      small({{"[render]", "[[viewpoint]]\nposition_mm = [200, 0, 300]\n\n[render]"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "camera]") +
                     "camera: the part is outside the image: no camera ray hits it; check .*");
}

TEST_F(InputError, TunnelSmallerThanThePart) {
  std::string study = small({{"radius_mm = 80\nslot_mm = 14", "radius_mm = 5\nslot_mm = 2"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "shape = \"semi") +
                     "lighting\\.tunnel\\.shape: the tunnel is smaller than the part: the part's "
                     "point at y -?6\\.0 mm, z -?[0-9.]+ mm lies outside the cross-section");
  study = small({{"length_mm = 400", "length_mm = 30"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "length_mm = 30") +
                     "lighting\\.tunnel\\.length_mm: the tunnel is 30 mm long and smaller than the "
                     "part, which reaches from x -20\\.0 to 20\\.0 mm");
}

TEST_F(InputError, SlotWiderThanTheTunnel) {
  const std::string study = small({{"slot_mm = 14", "slot_mm = 200"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "slot_mm") +
                     "lighting\\.tunnel\\.slot_mm: is 200, must be smaller than the tunnel, which "
                     "is 160 mm wide");
}

TEST_F(InputError, DefectBesideThePart) {
  const std::string study = small({{"x_mm = [2]", "x_mm = [25]"}});
  expect_refused(study,
                 kUsage,
                 "study\\.toml:[0-9]+:[0-9]+: defects\\.dent: place 1 at x 25 mm, y 1 mm is beside "
                 "the part; the part reaches over 40 x 12 mm; x 19\\.[0-9]+ mm, y [0-9.]+ mm is on "
                 "it");
}

// The defect out of sight is of the second table; the first has one that is seen.
TEST_F(InputError, DefectOutOfSightNamesItsOwnTableAndWhatToDo) {
  const std::string study =
      small({{"[variables]",
              "[defects.dent2]\ntype = \"dent\"\nat_mm = [5, 0, 1.9, 16, 0, 1.7]\n\n[variables]"},
             {"width_px = 200", "width_px = 100"}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "dent2]") +
                     "defects\\.dent2: dent2_2 is outside the image; give it a place .*at_mm.*"
                     "facing_deg.*");
}

TEST_F(InputError, DistortionThatFolds) {
  const std::string study = small({{"height_px = 60", "height_px = 60\nk1 = -800"}});
  expect_refused(
      study,
      kUsage,
      place_of(study, "k1") +
          "camera\\.k1: the radial distortion folds the image at x/z radius [0-9.]+, before "
          "the pixel .*; allowed are .*");
}

TEST_F(InputError, UnknownScoreNamesTheNearest) {
  std::string study = small({{"\"homogeneity.h_rms\"", "\"homogenity.h_rms\""}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "maximise") +
                     "objective\\.maximise: \"homogenity\\.h_rms\" is no score, did you mean "
                     "\"homogeneity\\.h_rms\"\\?");
  study = small({{"\"homogeneity.clipped_share\"", "\"defects.dent_2.cnr\""}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "\"defects.dent_2") +
                     "constraints: \"defects\\.dent_2\\.cnr\" is no score, did you mean "
                     "\"defects\\.dent_1\\.cnr\"\\?");
}

TEST_F(InputError, MissingObjective) {
  const std::string study = small({{"[objective]\nmaximise = \"homogeneity.h_rms\"\n", ""}});
  expect_refused(study,
                 kUsage,
                 place_of(study, "variables]") +
                     "objective: a search needs \\[objective\\] with maximise or minimise = "
                     "\"score\"");
}

TEST_F(InputError, TablesThatAreNone) {
  const std::string scene = small_study().substr(0, small_study().find("[variables]"));
  for (const std::string name : {"variables", "prototypes", "objective", "constraints"}) {
    expect_refused(name + " = 3\n" + scene,
                   kUsage,
                   "study\\.toml:1:1: " + name + ": must be a table, like \\[" + name + "\\]");
  }
}

TEST_F(InputError, PrototypeWithUnknownPath) {
  const std::string study =
      small_study() + "\n[prototypes.flat]\n\"lighting.tunnel.distnce_mm\" = 40\n";
  expect_refused(study,
                 kUsage,
                 place_of(study, "\"lighting.tunnel.distnce_mm\"") +
                     "prototypes\\.flat: lighting\\.tunnel\\.distnce_mm: the scene has no such "
                     "key, the nearest one is \"lighting\\.tunnel\\.distance_mm\"");
}

TEST_F(InputError, PrototypeThatCannotBe) {
  std::string study = small_study() + "\n[prototypes.tight]\n\"lighting.tunnel.slot_mm\" = 170\n";
  expect_refused(study,
                 kUsage,
                 place_of(study, "\"lighting.tunnel.slot_mm\"") +
                     "prototypes\\.tight: lighting\\.tunnel\\.slot_mm: is 170, must be smaller "
                     "than the tunnel, which is 160 mm wide");
  study = small_study() +
          "\n[prototypes.tight]\n\"lighting.tunnel.radius_mm\" = 5\n"
          "\"lighting.tunnel.slot_mm\" = 1\n";
  expect_refused(study,
                 kUsage,
                 place_of(study, "tight]") +
                     "prototypes\\.tight: lighting\\.tunnel\\.shape: the "
                     "tunnel is smaller than the part: .*");
}

TEST_F(InputError, PrototypeWhoseNameIsNoFolder) {
  const std::string study = small_study() + "\n[prototypes.winner]\n\"scan.positions\" = 4\n";
  expect_refused(study,
                 kUsage,
                 place_of(study, "winner]") +
                     "prototypes: \"winner\" is to be the name of a folder; allowed are .*");
}

TEST_F(InputError, TomlSyntax) {
  const std::string study = small({{"[render]", "[render"}});
  expect_refused(study, kUsage, "study\\.toml:17:8: Error while parsing table header: .*");
}

TEST_F(InputError, RegionOfInterestWithoutPixels) {
  const std::string study = small_study() + "\n[metrics]\nerosion_px = 40\n";
  expect_refused(
      study,
      kUsage,
      place_of(study, "erosion_px") + "metrics\\.erosion_px: no pixel is left of [0-9]+ .*");
}

}  // namespace
}  // namespace glint::test
