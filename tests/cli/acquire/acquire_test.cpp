// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint acquire` with the twins of a camera and a robot: whole, killed and resumed, stopped.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/rng.h"
#include "optimizer/storage/sqlite.h"
#include "tests/cli/acquire/arm_place.h"
#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/acquire/small_twins.h"
#include "tests/cli/program.h"
#include "tests/cli/served_twins.h"

#ifndef GLINT_NUM_KILLS
#define GLINT_NUM_KILLS 3
#endif

namespace glint::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Poses of both agree to half a millionth of their own sigma or better: a twin stands where it is
/// sent.
void expect_same_poses(const json& a, const json& b) {
  ASSERT_EQ(a["pictures"].size(), b["pictures"].size());
  for (std::size_t i = 0; i < a["pictures"].size(); ++i) {
    const json& one = a["pictures"][i];
    const json& other = b["pictures"][i];
    EXPECT_EQ(one["view"], other["view"]);
    EXPECT_EQ(one["sha256"], other["sha256"]);
    for (std::size_t k = 0; k < 6; ++k) {
      const double sigma = one[k < 3 ? "position_sigma_mm" : "rotation_sigma_rad"];
      EXPECT_NEAR(one["base_from_flange"][k], other["base_from_flange"][k], sigma);
    }
  }
}

/// The pictures of a folder are those of an undisturbed run, each once.
void expect_undisturbed(const SmallTwins& twins, const std::string& out) {
  const auto expected = twins.pictures("whole");
  const auto found = twins.pictures(out);
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, bytes] : expected) {
    EXPECT_TRUE(found.contains(name) && found.at(name) == bytes) << name;
  }
  expect_same_poses(twins.acquired("whole"), twins.acquired(out));
}

TEST(Acquire, TakesTheCellsViewsAndNothingTwice) {
  const SmallTwins twins;
  const ProgramResult result = glint_in(twins.folder, SmallTwins::acquire("whole"));
  ASSERT_EQ(result.code, 0) << result.err << result.out;
  const json acquired = json::parse(result.out);
  EXPECT_EQ(acquired["status"], "complete");
  EXPECT_EQ(acquired["twin"], true);
  EXPECT_EQ(acquired["counts"]["accepted"], 5);
  EXPECT_EQ(acquired["end"]["how"], "tour");
  EXPECT_EQ(acquired["end"]["where"], "above");
  EXPECT_EQ(twins.pictures("whole").size(), 10U);  // a frame and a mean for each view
  EXPECT_EQ(twins.acquired("whole")["pictures"][0]["lights"], json::array({"ring"}));
  EXPECT_EQ(twins.acquired("whole")["pictures"][3]["lights"], json::array({"ring", "bar"}));
  EXPECT_THAT(read_file(twins.folder / "whole/poses.csv"),
              HasSubstr("views/left/sequence/frame_000.png,"));
  twins.fault("protective_stop now");  // nobody who moves for it: it would be told
  const json again = json::parse(glint_in(twins.folder, SmallTwins::acquire("whole")).out);
  EXPECT_EQ(again["counts"]["taken_now"], 0);
  EXPECT_EQ(again["counts"]["resumed"], 5);
  EXPECT_EQ(again["status"], "complete");
}

int number_from(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atoi(text);
}

/// What a person does after a stop.
void unlock(const SmallTwins& twins) {
  std::this_thread::sleep_for(std::chrono::milliseconds(400));  // 8 s of the arm's clock
  glint_in(twins.folder, {"cell", "unlock", "cell.toml", "--twin", "twin.json", "--move"});
}

/// Runs until the folder is whole, with disturbances at random moments: kills, interrupts and
/// protective stops. @return how many there were
int acquire_disturbed(const SmallTwins& twins, const std::string& out, int most, Rng& random) {
  const Tour tour = tour_of_cell(twins.folder);
  int disturbances = 0;
  for (int tries = 0; tries < 60; ++tries) {
    Program program(twins.folder / "", SmallTwins::acquire(out));
    const auto patience = std::chrono::duration<double>(random.uniform(0.3, 4.3 + 0.3 * tries));
    const auto start = std::chrono::steady_clock::now();
    while (program.is_running() && std::chrono::steady_clock::now() - start < patience) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    bool is_stopped = false;
    if (program.is_running() && disturbances < most) {
      ++disturbances;
      const int kind = static_cast<int>(random.uniform(0, 4));
      is_stopped = kind == 0;
      if (is_stopped) {
        twins.fault("protective_stop now");
      } else {
        program.send(kind == 1 ? SIGINT : SIGKILL);
      }
    }
    const ProgramResult result = program.wait();
    expect_on_its_path(twins.folder, tour, result);
    if (is_stopped || result.code == 1) {
      unlock(twins);
    }
    if (result.code == 0) {
      return disturbances;
    }
    EXPECT_TRUE(result.code == 1 || result.code == 130 || result.signal == SIGKILL ||
                result.signal == SIGINT ||  // before anything was connected
                result.code == 137)
        << result.code << result.out << result.err;
  }
  ADD_FAILURE() << "it does not come to an end";
  return disturbances;
}

TEST(Acquire, KilledAndStoppedAndResumedItIsAsIfNothingHadBeen) {
  const SmallTwins twins;
  ASSERT_EQ(glint_in(twins.folder, SmallTwins::acquire("whole")).code, 0);
  // In parts: so many, by another seed.
  const int kills = number_from("GLINT_KILLS", GLINT_NUM_KILLS);
  Rng random(static_cast<std::uint64_t>(number_from("GLINT_KILL_SEED", 5)), Stream::kTest, 0);
  int disturbances = 0;
  int runs = 0;
  for (; disturbances < kills && !testing::Test::HasFailure(); ++runs) {
    const std::string out = fmt::format("disturbed_{}", runs);
    disturbances += acquire_disturbed(twins, out, kills - disturbances, random);
    expect_undisturbed(twins, out);
  }
  fmt::print("{} disturbances in {} acquisitions\n", disturbances, runs);
}

TEST(Acquire, BacksOutWhenAPictureCannotBeKept) {
  const SmallTwins twins;
  ASSERT_EQ(glint_in(twins.folder, SmallTwins::acquire("whole")).code, 0);
  fs::copy(twins.folder / "whole", twins.folder / "full", fs::copy_options::recursive);
  fs::remove_all(twins.folder / "full/views/right");
  write_file(twins.folder / "full/views/right", "in the way");
  const ProgramResult result = glint_in(twins.folder, SmallTwins::acquire("full"));
  EXPECT_EQ(result.code, 1) << result.err;
  const json acquired = json::parse(result.out);
  EXPECT_EQ(acquired["end"]["cause"], "disk");
  EXPECT_EQ(acquired["end"]["how"], "backed_out");
  EXPECT_EQ(acquired["end"]["where"], "above");
  fs::remove(twins.folder / "full/views/right");
  EXPECT_EQ(glint_in(twins.folder, SmallTwins::acquire("full")).code, 0);
  expect_undisturbed(twins, "full");
  fs::remove(twins.folder / "full/views/right/sequence/frame_000.png");
  Database(twins.folder / "full/journal.sqlite", Database::Access::kReadWrite)
      .run("CREATE TRIGGER full BEFORE UPDATE ON session BEGIN SELECT RAISE(ABORT, 'full'); END");
  const ProgramResult untold = glint_in(twins.folder, SmallTwins::acquire("full"));
  EXPECT_EQ(untold.code, 3) << untold.out;
  EXPECT_THAT(untold.err, HasSubstr("the arm is at above (tour)"));
}

// What the arm does not do as told ends everything where it is; what a person has seen to is then
// taken up again.
TEST(Acquire, StopsWhereAFaultOfTheArmStopsItAndGoesOnLater) {
  const SmallTwins twins;
  ASSERT_EQ(glint_in(twins.folder, SmallTwins::acquire("whole")).code, 0);
  twins.fault("protective_stop moving 0.6");
  const ProgramResult stopped = glint_in(twins.folder, SmallTwins::acquire("stopped"));
  EXPECT_EQ(stopped.code, 1) << stopped.err;
  const json acquired = json::parse(stopped.out);
  EXPECT_EQ(acquired["status"], "stopped");
  EXPECT_EQ(acquired["end"]["how"], "stopped");
  EXPECT_EQ(acquired["end"]["cause"], "robot");
  EXPECT_THAT(acquired["end"]["text"].get<std::string>(), HasSubstr("protective_stop"));
  EXPECT_THAT(acquired["end"]["where"].get<std::string>(), HasSubstr("between above and straight"));
  unlock(twins);
  const ProgramResult resumed = glint_in(twins.folder, SmallTwins::acquire("stopped"));
  EXPECT_EQ(resumed.code, 0) << resumed.out << resumed.err;
  expect_undisturbed(twins, "stopped");
}

TEST(Acquire, BacksOutWhenItIsInterrupted) {
  const SmallTwins twins;
  Program program(twins.folder / "", SmallTwins::acquire("interrupted"));
  for (int i = 0; i < 2000 && !fs::exists(twins.folder / "interrupted/views/straight/aspect.png");
       ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  if (result.code == 0) {
    GTEST_SKIP() << "it was ready before the interrupt came";
  }
  EXPECT_EQ(result.code, 130) << result.err;
  const json acquired = json::parse(result.out);
  EXPECT_EQ(acquired["end"]["how"], "backed_out");
  EXPECT_EQ(acquired["end"]["where"], "above");
}

/// A run by hand: two designs of the twins' own scene, under rings that are built differently.
void write_run(const TemporaryFolder& folder) {
  const std::string truth = read_file(folder / "truth.toml");
  const std::string scene = truth.substr(0, truth.find("[truth]"));
  fs::create_directories(folder / "run/narrow");
  fs::create_directories(folder / "run/wide");
  write_file(folder / "run/study.resolved.toml", scene);
  write_file(folder / "run/narrow/scene.toml", scene);
  write_file(
      folder / "run/wide/scene.toml",
      std::regex_replace(scene, std::regex("outer_radius_mm = [0-9.]+"), "outer_radius_mm = 77"));
}

// Nobody is at the terminal: what is not named stays as it is, and the arm where it is.
TEST(Acquire, TakesADesignWhenItsPrototypeIsSaidToBeMounted) {
  const SmallTwins twins;
  write_run(twins.folder);
  Arguments call = SmallTwins::acquire("result");
  call[0] = "validate";
  call.insert(call.end(), {"run", "--designs", "narrow,wide", "--mounted", "wide"});
  const ProgramResult result = glint_in(twins.folder, call);
  EXPECT_EQ(result.code, 1) << result.err;
  const json told = json::parse(result.out);
  EXPECT_EQ(told["status"], "waiting");
  EXPECT_EQ(told["design"], "narrow");
  EXPECT_THAT(told["next"]["text"].get<std::string>(), HasSubstr("prototype of narrow (ring)"));
  EXPECT_EQ(twins.acquired("acquired/wide")["status"], "complete");
  EXPECT_FALSE(fs::exists(twins.folder / "acquired/narrow"));
  EXPECT_EQ(told["next"]["in_place_of"], json::array({"wide"}));
  Arguments alone = SmallTwins::acquire("alone");
  alone.insert(alone.begin() + 1, "run/narrow");
  EXPECT_EQ(json::parse(glint_in(twins.folder, alone).out)["status"], "waiting");
  call.back() = "narrow";
  glint_in(twins.folder, call);  // the comparison of both sides is no matter here
  EXPECT_EQ(twins.acquired("acquired/narrow")["status"], "complete");
}

/// Two rings to be tried out, in a study that is rendered at once.
constexpr const char* kTwoRings = R"(schema = 2
material = {type = "diffuse"}
camera = {width_px = 32, height_px = 24, object_pixel_mm = 1, working_distance_mm = 180}
[part]
shape = "plate"
length_mm = 20
width_mm = 20
thickness_mm = 5
[sensor]
wavelengths_nm = [630]
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 80
radiance = [4]
[render.paths]
samples = 1
max_reflections = 1
[prototypes.narrow]
"lighting.ring.outer_radius_mm" = 50
[validate]
designs = "narrow"
)";

// The same glint run might search on: what goes on is the validation.
TEST(Acquire, OfARunThatWaitsForAPrototypeGoesOnByValidating) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", kTwoRings);
  const std::string cell =
      kGalleryCell / "cell.toml";  // nobody serves it, and nobody is looked for
  const ProgramResult result = glint_in(
      folder,
      {"run", "study.toml", "--out", "my o/run", "--cell", cell, "--confirmed", "ring", "--move"});
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("waiting: mount the prototype of narrow (ring)"),
                    HasSubstr("glint validate 'my o/run' --cell " + cell + " --out"),
                    HasSubstr("--confirmed ring --move with --mounted narrow\n")));
}

/// A strip under a tunnel whose stripes a stage moves, seen from one view.
void write_tunnel_cell(const TemporaryFolder& folder) {
  const std::string truth = read_file(kGalleryCell / "truth.toml");
  const std::string scene = R"(schema = 1
[part]
shape = "strip"
length_mm = 40
width_mm = 12
radius_along_mm = 400
radius_across_mm = 40
[camera]
width_px = 120
height_px = 60
object_pixel_mm = 0.4
working_distance_mm = 180
[render]
rays_per_axis = 1
[sensor]
full_well_e = 10000
read_noise_e = 6
bits = 8
[scan]
positions = 6
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 80
slot_mm = 24
length_mm = 400
period_mm = 12
)";
  write_file(folder / "scene.toml", scene);
  write_file(folder / "truth.toml", scene + truth.substr(truth.find("[truth]")));
  const std::string cell = fast_cell();
  write_file(folder / "tunnel_cell.toml",
             edited(cell.substr(0, cell.find("[[view]]\nname = \"left\"")),
                    {{"[lights.ring]\nkind = \"manual\"\n\n[lights.bar]",
                      "[stage]\nhost = \"127.0.0.1\"\nspeed_mm_s = 40\n\n[lights.tunnel]"},
                     {"lights = [\"ring\"]", "lights = [\"tunnel\"]"}}));
}

TEST(Acquire, TakesAScanWithItsStageKilledInBetween) {
  const TemporaryFolder folder;
  write_tunnel_cell(folder);
  const ServedTwins twins(folder, "both", "tunnel_cell.toml");
  Arguments call = {"acquire",
                    "scene.toml",
                    "--cell",
                    "tunnel_cell.toml",
                    "--twin",
                    "twin.json",
                    "--speed_share",
                    "1",
                    "--move",
                    "--out",
                    "scan"};
  {
    Program program(folder / "", call);
    for (int i = 0; i < 4000 && !fs::exists(folder / "scan/views/straight/sequence/frame_002.png");
         ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    program.send(SIGKILL);
    program.wait();
  }
  const json scan = json_of(folder, call);
  call.back() = "whole";
  const json whole = json_of(folder, call);
  EXPECT_EQ(scan["counts"]["accepted"], 6);
  EXPECT_GE(scan["counts"]["resumed"], 3);
  expect_same_poses(whole, scan);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(scan["pictures"][i]["position"], i);
    EXPECT_NEAR(scan["pictures"][i]["stage_mm"], 2.0 * static_cast<double>(i), 1e-9);
    EXPECT_NE(scan["pictures"][i]["sha256"], scan["pictures"][(i + 1) % 6]["sha256"]);
  }
  EXPECT_TRUE(fs::exists(folder / "scan/views/straight/aspect.png"));
}

TEST(Acquire, TellsWhatItWouldDoAndConnectsToNothing) {
  const TemporaryFolder folder;
  const std::string cell = kGalleryCell / "cell.toml";  // nobody serves it
  const json plan = json_of(folder, {"acquire", "--cell", cell, "--dry_run", "--out", "out"});
  EXPECT_EQ(plan["pictures"], 5);
  EXPECT_EQ(plan["views"][0]["view"], "straight");
  EXPECT_EQ(plan["legs"].size(), 6U);
  EXPECT_EQ(plan["next"]["lights"], json::array({"ring"}));
  EXPECT_FALSE(fs::exists(folder / "out"));
  EXPECT_THAT(glint_in(folder, {"acquire", "--cell", cell}).err, HasSubstr("--move"));
  EXPECT_EQ(glint_in(folder, {"acquire", "none.toml", "--cell", cell, "--dry_run"}).code, 3);
  EXPECT_THAT(glint_in(folder, {"validate", "run", "--pictures", "p", "--mounted", "wide"}).err,
              HasSubstr("--cell"));
  for (const char* option : {"--confirmed", "--mounted"}) {
    const Arguments call = {"acquire", "--cell", cell, "--dry_run", option, "ring", "none.toml"};
    EXPECT_THAT(glint_in(folder, call).err, HasSubstr("none.toml")) << option << " takes one name";
  }
}

}  // namespace
}  // namespace glint::test
