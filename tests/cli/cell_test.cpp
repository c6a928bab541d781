// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cell`: what must not be sent, and the twin of a robot from beginning to end.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <regex>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/cell_text.h"
#include "tests/cli/counting_peer.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A study with [validate] whose scene lies in the cell: when its only design is rendered, a run of
/// it with --move acquires that design's pictures.
constexpr const char* kValidatedStudy = R"(schema = 2
[part]
shape = "plate"
length_mm = 20
width_mm = 20
thickness_mm = 5
[material]
type = "diffuse"
[camera]
width_px = 32
height_px = 24
object_pixel_mm = 1
working_distance_mm = 180
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
[calibration.flange_from_camera]
translation_mm = [0, 40, 30]
rotation_vector_deg = [0, 0, 0]
[cell.base_from_part]
translation_mm = [300, 0, 100]
rotation_vector_deg = [0, 0, 0]
[validate]
)";

/// A call that may move, and how it ends without --move.
struct MovingVerb {
  Arguments arguments;
  int code = 2;  ///< refused; `glint run` plans the views and tells how to go on
};

// A verb that may move gets a row here.
const std::vector<MovingVerb> kMovingVerbs = {
    {{"cell", "move", "cell.toml", "--view", "left"}},
    {{"cell", "move", "cell.toml", "--view", "left", "--line"}},
    {{"cell", "safe", "cell.toml"}},
    {{"cell", "safe", "cell.toml", "--line"}},
    {{"cell", "unlock", "cell.toml"}},
    {{"cell", "power", "cell.toml"}},
    {{"cell", "power", "cell.toml", "--off"}},
    {{"acquire", "--cell", "cell.toml"}},
    {{"validate", "run", "--cell", "cell.toml"}},
    {{"calibrate", "--cell", "cell.toml", "--board", "board.toml"}},
    {{"calibrate", "--cell", "cell.toml", "--part", "part.toml", "--camera", "camera"}},
    {{"run", "study.toml", "--cell", "cell.toml", "--out", "named/run", "--quiet"}, 0},
    {{"run", "in_cell.toml", "--out", "own/run", "--quiet"}, 0}};

// What the shells complete: verbs with an option --move, and there are no others.
TEST(CellSafety, EveryVerbThatTakesMoveHasARow) {
  const TemporaryFolder folder;
  const std::string options = glint_in(folder, {"help", "--completion", "fish"}).out;
  const std::regex option("subcommand_from (\\w+)' -l move ");
  std::set<std::string> verbs;
  for (std::sregex_iterator match(options.begin(), options.end(), option), end; match != end;
       ++match) {
    verbs.insert((*match)[1]);
  }
  std::set<std::string> rows;
  for (const MovingVerb& verb : kMovingVerbs) {
    rows.insert(verb.arguments[0]);
  }
  EXPECT_EQ(verbs, rows);
}

/// The same with the cell named by the study.
std::string study_in_cell() {
  return edited(kValidatedStudy, {{"[cell.base", "[cell]\nfile = \"cell.toml\"\n[cell.base"}});
}

/// What the rows read, in a folder: their robot only counts who calls it.
class CountedCell {
 public:
  CountedCell() {
    write_file(folder_ / "cell.toml",
               cell_text(robot_.rtde.port(),
                         robot_.primary.port(),
                         robot_.secondary.port(),
                         robot_.dashboard.port()));
    write_file(folder_ / "study.toml", kValidatedStudy);
    write_file(folder_ / "in_cell.toml", study_in_cell());
  }

  const TemporaryFolder& folder() const { return folder_; }

  void expect_not_called() const { robot_.expect_not_called(); }

 private:
  TemporaryFolder folder_;
  CountingRobot robot_;
};

/// The rows with these words behind each.
std::vector<Arguments> moving_calls(const Arguments& more) {
  std::vector<Arguments> calls;
  for (const MovingVerb& verb : kMovingVerbs) {
    calls.push_back(verb.arguments);
    calls.back().insert(calls.back().end(), more.begin(), more.end());
  }
  return calls;
}

TEST(CellSafety, WithoutMoveNobodyIsEvenCalled) {
  const CountedCell cell;
  const std::vector<ProgramResult> results = glint_at_once(cell.folder(), moving_calls({}));
  for (std::size_t i = 0; i < results.size(); ++i) {
    const MovingVerb& verb = kMovingVerbs[i];
    EXPECT_EQ(results[i].code, verb.code)
        << verb.arguments[0] << ' ' << verb.arguments[1] << results[i].err;
    EXPECT_EQ(results[i].out, "");
    if (verb.code == 2) {
      EXPECT_THAT(results[i].err, HasSubstr("--move"));
    }
  }
  for (const char* plan : {"named/plan/baseline/plan.json", "own/plan/baseline/plan.json"}) {
    EXPECT_TRUE(std::filesystem::exists(cell.folder() / plan))
        << "the run comes to its end: " << plan;
  }
  cell.expect_not_called();
}

// The ready file is of a camera alone: the robot that is left is the cell's own.
TEST(CellSafety, WithTwinTheCellsOwnRobotIsNotEvenCalled) {
  const CountedCell cell;
  write_file(cell.folder() / "twin.json",
             R"({"pid": 1, "twins": [{"kind": "camera", "address": "127.0.0.5"}]})");
  const Arguments with_twin = {"--twin", "twin.json", "--move"};
  std::vector<Arguments> calls = moving_calls(with_twin);
  calls.push_back({"cell", "status", "cell.toml", "--twin", "twin.json"});
  calls.push_back({"cell", "watch", "cell.toml", "--twin", "twin.json"});
  const std::vector<ProgramResult> results = glint_at_once(cell.folder(), calls);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].code, 2) << calls[i][0] << ' ' << calls[i][1] << results[i].err;
    if (std::ranges::find(calls[i], "cell.toml") != calls[i].end()) {
      EXPECT_THAT(results[i].err, HasSubstr("twin.json: has no twin of the cell's robot"));
    }
  }
  cell.expect_not_called();
}

// As a ready file of twins that have ended, whose ports a robot has now.
TEST(CellSafety, WithTwinWhatDoesNotProveToBeOneIsNotDriven) {
  const TemporaryFolder folder;
  const CountingRobot robot;
  write_file(folder / "cell.toml", cell_text(30004, 30001, 30002, 29999));
  write_file(folder / "twin.json",
             fmt::format(R"({{"pid": 1, "twins": [{{"kind": "robot", "address": "127.0.0.1",
"rtde_port": {}, "primary_port": {}, "secondary_port": {}, "dashboard_port": {}, "token": 5}}]}})",
                         robot.rtde.port(),
                         robot.primary.port(),
                         robot.secondary.port(),
                         robot.dashboard.port()));
  std::vector<Arguments> calls = moving_calls({"--twin", "twin.json", "--move"});
  std::erase_if(calls, [](const Arguments& call) { return call[0] != "cell"; });
  calls.push_back({"cell", "status", "cell.toml", "--twin", "twin.json"});
  calls.push_back({"cell", "watch", "cell.toml", "--twin", "twin.json"});
  for (const ProgramResult& result : glint_at_once(folder, calls)) {
    EXPECT_EQ(result.code, 3) << result.err;
    EXPECT_THAT(result.err, HasSubstr("does not prove that it is a twin"));
  }
  robot.expect_not_called();
}

// Views are planned for them all the same.
TEST(CellSafety, NoPicturesAreTakenWhereLightsAreSwitchedTogether) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(1, 2, 3, 4) + "[lights.a]\n[lights.b]\n");
  write_file(folder / "study.toml", kValidatedStudy);
  Arguments run = {"run", "study.toml", "--cell", "cell.toml", "--out", "run"};
  EXPECT_EQ(glint_in(folder, run).code, 0);
  run.emplace_back("--move");
  const ProgramResult result = glint_in(folder, run);
  EXPECT_EQ(result.code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("lights.b.output: is 0, as that of lights.a"));
}

// Designs are planned as they are built, whatever the study's own scene is: the wide ring is in the
// arm's way.
TEST(Cell, ARunPlansEachDesignForTheStudysCellAndTellsHowToAcquireIt) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(1, 2, 3, 4));
  write_file(folder / "study.toml",
             study_in_cell() + "designs = \"narrow,wide\"\n[prototypes.narrow]\n" +
                 "\"lighting.ring.outer_radius_mm\" = 50\n[prototypes.wide]\n" +
                 "\"lighting.ring.outer_radius_mm\" = 400\n");
  const ProgramResult result = glint_in(folder, {"run", "study.toml", "--out", "run"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("narrow: 1 of 1 views can be taken"));
  EXPECT_THAT(result.out, HasSubstr("wide: 0 of 1 views can be taken"));
  for (const char* design : {"narrow", "wide"}) {
    EXPECT_THAT(result.out,
                HasSubstr(fmt::format("glint acquire run/{}/scene.toml --cell ", design)));
  }
  EXPECT_THAT(result.out, HasSubstr("glint validate run --pictures acquired"));
  const std::string plan = read_file(folder / "plan/narrow/plan.json");
  EXPECT_EQ(json::parse(plan)["views"][0]["outcome"], "planned");
}

// What the commands that follow are to be driven with.
TEST(Cell, ARunThatMovesNothingNeedsNoTwinsYet) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(1, 2, 3, 4));
  write_file(folder / "study.toml", study_in_cell());
  const ProgramResult result =
      glint_in(folder, {"run", "study.toml", "--out", "run", "--twin", "twin.json"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr(" --twin twin.json --move\n"));
}

// As a shell takes it: a slash at the run's end does not put the pictures into it, and what was
// typed of how to drive is not lost.
TEST(Cell, ARunTellsHowToAcquireAsItIsToBePasted) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(1, 2, 3, 4));
  write_file(folder / "study.toml", study_in_cell());
  const ProgramResult result = glint_in(folder,
                                        {"run",
                                         "study.toml",
                                         "--out",
                                         "my o/run/",
                                         "--speed_share",
                                         "0.25",
                                         "--confirmed",
                                         "left ring"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("  glint acquire 'my o/run/baseline/scene.toml' --cell "));
  EXPECT_THAT(
      result.out,
      HasSubstr(" --out 'my o/acquired/baseline' --speed_share 0.25 --confirmed 'left ring' "
                "--move\n"));
  EXPECT_THAT(
      result.out,
      HasSubstr("  glint validate 'my o/run' --pictures 'my o/acquired' --out 'my o/validate'\n"));
  EXPECT_TRUE(std::filesystem::exists(folder / "my o/plan/baseline/plan.json"));
}

// What is wrong with the study's own cell comes up before the search, not after it.
TEST(Cell, OfAStudyIsReadBeforeTheRunBegins) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", edited(cell_text(1, 2, 3, 4), {{"\"ur3\"", "\"ur4\""}}));
  write_file(folder / "study.toml", study_in_cell());
  const ProgramResult result = glint_in(folder, {"run", "study.toml", "--out", "run", "--quiet"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("ur4"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

TEST(Cell, ARunIsToldWhereADesignCannotBePlanned) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(1, 2, 3, 4));
  write_file(folder / "study.toml",
             study_in_cell() + "designs = \"first,second\"\n[prototypes.first]\n" +
                 "\"sensor.exposure\" = 0.5\n[prototypes.second]\n\"sensor.exposure\" = 0.6\n");
  std::filesystem::create_directories(folder / "plan/first");
  write_file(folder / "plan/first/plan.json", "somebody's own");
  const ProgramResult result = glint_in(folder, {"run", "study.toml", "--out", "run"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("first: not planned: "));
  EXPECT_THAT(result.out, HasSubstr("second: 1 of 1 views can be taken"));
  EXPECT_THAT(result.out, HasSubstr("report: "));
}

// The control: with --move somebody is called, so the peers above would have counted.
TEST(CellSafety, WithMoveThePeerIsCalled) {
  const TemporaryFolder folder;
  const CountingPeer rtde;
  const CountingPeer primary;
  write_file(folder / "cell.toml", cell_text(rtde.port(), primary.port(), 1, 2));
  const ProgramResult result =
      glint_in(folder, {"cell", "move", "cell.toml", "--view", "left", "--move"});
  EXPECT_EQ(result.code, 3) << "a peer that says nothing is no robot";
  EXPECT_GT(rtde.bytes(), 0);
  EXPECT_EQ(primary.bytes(), 0) << "no script before the state is known";
}

/// Reading verbs on the twin's own RTDE and dashboard; the ports that take scripts count.
void expect_reading_sends_no_script(const TemporaryFolder& folder, const json& twin) {
  const CountingPeer primary;
  const CountingPeer secondary;
  write_file(
      folder / "counted.toml",
      cell_text(twin["rtde_port"], primary.port(), secondary.port(), twin["dashboard_port"]));
  const json status = json_of(folder, {"cell", "status", "counted.toml"});
  EXPECT_EQ(status["twin"], true);
  EXPECT_EQ(status["movable"], true) << status["not_movable_because"];
  EXPECT_EQ(status["rate_hz"], 125.0);
  EXPECT_EQ(json_of(folder, {"cell", "watch", "counted.toml", "--duration_s", "0.2"})["ok"], true);
  EXPECT_EQ(primary.connections(), 0);
  EXPECT_EQ(secondary.connections(), 0);
}

void expect_motions_arrive(const TemporaryFolder& folder) {
  const auto call = [&](const Arguments& arguments) {
    Arguments words = {"cell"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    words.insert(words.end(), {"--twin", "out/twin.json", "--move"});
    return json_of(folder, words);
  };
  const json moved = call({"move", "cell.toml", "--view", "left"});
  EXPECT_EQ(moved["outcome"], "done");
  EXPECT_NEAR(moved["still"]["joints_deg"][0].get<double>(), 10.0, 1e-3);
  EXPECT_GE(moved["still"]["packages"], 25);
  // A line ends where the joints' motion does, here from 0.1 rad away.
  const json straight = call({"safe", "cell.toml", "--line"});
  EXPECT_EQ(straight["outcome"], "done") << straight["text"];
  const json home = call({"safe", "cell.toml"});
  EXPECT_EQ(home["outcome"], "done");
  for (const std::size_t i : {0U, 1U, 2U}) {
    EXPECT_NEAR(straight["still"]["base_from_tcp"]["translation_mm"][i].get<double>(),
                home["still"]["base_from_tcp"]["translation_mm"][i].get<double>(),
                1e-3);
  }
}

TEST(Cell, ATwinIsServedReadMovedAndStopped) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml",
             cell_text(30004, 30001, 30002, 29999) + "[twin]\nmotion_speedup = 10\n");
  const json ready = json_of(folder,
                             {"cell",
                              "twin",
                              "robot",
                              "cell.toml",
                              "--port",
                              "0",
                              "--detach",
                              "--ready_file",
                              "out/twin.json"});
  expect_reading_sends_no_script(folder, ready["twins"][0]);
  expect_motions_arrive(folder);
  const json stopped = json_of(folder, {"cell", "twin", "stop", "out/twin.json"});
  EXPECT_EQ(stopped["was_running"], true);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/twin.json"));
}

/// The robot of a ready file that appears while a twin is served from this port on; null: somebody
/// else has taken one of the four.
json served_from(const TemporaryFolder& folder, int first) {
  Program program(folder.path(),
                  {"cell",
                   "twin",
                   "robot",
                   "cell.toml",
                   "--port",
                   std::to_string(first),
                   "--ready_file",
                   "twin.json"});
  while (program.is_running() && !std::filesystem::exists(folder / "twin.json")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (!program.is_running()) {
    return nullptr;
  }
  const json ready = json::parse(read_file(folder / "twin.json"));
  program.send(SIGTERM);
  program.wait();
  return ready["twins"][0];
}

TEST(Cell, ATwinTakesFourPortsFromTheGivenOneOn) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(30004, 30001, 30002, 29999));
  int first = 0;
  json twin;
  for (int i = 0; i < 10 && twin.is_null(); ++i) {
    first = LoopbackListener().port();
    twin = served_from(folder, first);
  }
  ASSERT_FALSE(twin.is_null());
  EXPECT_EQ(twin["rtde_port"], first);
  EXPECT_EQ(twin["primary_port"], first + 1);
  EXPECT_EQ(twin["secondary_port"], first + 2);
  EXPECT_EQ(twin["dashboard_port"], first + 3);
}

TEST(Cell, ATwinThatCannotServeSaysWhy) {
  const TemporaryFolder folder;
  const CountingPeer taken;
  write_file(folder / "cell.toml", cell_text(taken.port(), 1, 2, 3));
  const ProgramResult result = glint_in(
      folder, {"cell", "twin", "robot", "cell.toml", "--detach", "--ready_file", "twin.json"});
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr(fmt::format("127.0.0.1:{}", taken.port())));
  EXPECT_FALSE(std::filesystem::exists(folder / "twin.json"));
}

TEST(Cell, SlipsAreNamed) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", cell_text(30004, 30001, 30002, 29999));
  const std::vector<ProgramResult> results =
      glint_at_once(folder,
                    std::vector<Arguments>{{"cell", "jump", "cell.toml"},
                                           {"cell", "status"},
                                           {"cell", "move", "cell.toml", "--view", "7", "--move"},
                                           {"cell", "twin", "robot", "cell.toml", "--detach"},
                                           {"cell", "twin", "stop", "cell.toml"},
                                           {"cell", "twin", "stop", "absent.json"}});
  EXPECT_THAT(results[0].err, HasSubstr("status, watch"));
  EXPECT_EQ(results[1].code, 2);
  EXPECT_THAT(results[2].err, HasSubstr("1 to 1"));
  EXPECT_THAT(results[3].err, HasSubstr("--ready_file"));
  EXPECT_THAT(results[4].err, HasSubstr("is no ready file"));
  EXPECT_EQ(results[5].code, 3);
}

}  // namespace
}  // namespace glint::test
