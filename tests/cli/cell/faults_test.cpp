// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cell` when something comes in between: Ctrl-C, stops and lost links, on the twin of a
// robot.
#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/robot/twin_proof.h"
#include "tests/cli/cell_text.h"
#include "tests/cli/program.h"
#include "tests/cli/served_twins.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// A twin whose side channel is asked and told.
class FaultyTwin {
 public:
  /// @param speedup  of the arm's clock
  explicit FaultyTwin(int speedup = 1) {
    write_file(folder_ / "cell.toml",
               cell_text(30004, 30001, 30002, 29999) +
                   fmt::format("[twin]\nmotion_speedup = {}\n", speedup));
    twins_.emplace(folder_, "robot", "cell.toml");
  }

  const TemporaryFolder& folder() const { return folder_; }

  std::string tell(const std::string& line) const {
    return ask_side_channel(twins_->of("robot")["side_channel"].get<std::string>(), line)
        .value_or("nothing");
  }

  void wait_for(const std::string& word) const {
    for (int i = 0; i < 1000 && tell("state").find(word) == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_THAT(tell("state"), HasSubstr(word));
  }

  static Arguments call(Arguments words) {
    words.insert(words.begin(), "cell");
    words.insert(words.end(), {"cell.toml", "--twin", "twin.json", "--json"});
    return words;
  }

  ProgramResult run(const Arguments& words) const { return glint_in(folder_, call(words)); }

 private:
  TemporaryFolder folder_;
  std::optional<ServedTwins> twins_;
};

TEST(CellInterrupt, StopsTheArmWhereItIs) {
  const FaultyTwin twin;
  Program program(twin.folder().path(),
                  FaultyTwin::call({"move", "--view", "left", "--move", "--speed_share", "0.02"}));
  twin.wait_for("moving");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.code, 130) << result.err;
  const json told = json::parse(result.out);
  EXPECT_EQ(told["status"], "interrupted");
  EXPECT_EQ(told["outcome"], "program_stopped");
  EXPECT_EQ(told["text"], "interrupted");
  const std::string state = twin.tell("state");
  EXPECT_THAT(state, HasSubstr("still"));
  const double joint_rad = std::stod(state.substr(state.find('[') + 1));
  EXPECT_GT(joint_rad, 0.0);
  EXPECT_LT(joint_rad, 0.15) << "the goal is at 0.17";
}

// What would end or halt a program that does not attend to an arm. The control is that of the first
// signal: it ends every program that does nothing about it.
TEST(CellMove, IsAttendedToTheEndWhateverTheTerminalDoes) {
  const FaultyTwin twin;
  Program program(twin.folder().path(),
                  FaultyTwin::call({"move", "--view", "left", "--move", "--speed_share", "0.3"}));
  twin.wait_for("moving");
  for (const int signal : {SIGPIPE, SIGTSTP, SIGTTOU}) {
    program.send(signal);
  }
  for (int i = 0; i < 3000 && program.is_running(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_FALSE(program.is_running()) << "it is halted";
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(json::parse(result.out)["outcome"], "done");
}

TEST(CellMove, NamesAStopAfterArrival) {
  const FaultyTwin twin;
  EXPECT_EQ(twin.tell("fault protective_stop still 0.05"), "ok");
  const ProgramResult result = twin.run({"move", "--view", "left", "--move"});
  EXPECT_EQ(result.code, 1) << result.err;
  const json told = json::parse(result.out);
  EXPECT_EQ(told["outcome"], "protective_stop");
  EXPECT_THAT(told["text"].get<std::string>(), HasSubstr("PROTECTIVE_STOP"));
  EXPECT_EQ(told["still"], nullptr);
}

/// The joints, of the text of a state.
std::string joints_of(const std::string& state) {
  return state.substr(state.find('['), state.find(']') - state.find('['));
}

// A controller goes on with a program that a safeguard stop has paused when the stop is reset.
TEST(CellMove, OfASafeguardStopEndsForGood) {
  const FaultyTwin twin;
  EXPECT_EQ(twin.tell("fault safeguard_stop moving 0.3"), "ok");
  const ProgramResult result =
      twin.run({"move", "--view", "left", "--move", "--speed_share", "0.05"});
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_EQ(json::parse(result.out)["outcome"], "safeguard_stop");
  EXPECT_EQ(twin.tell("fault release"), "ok");
  twin.wait_for("NORMAL");
  const std::string joints = joints_of(twin.tell("state"));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_EQ(joints_of(twin.tell("state")), joints);
}

// Its clock is so fast that the 5 s before which nobody may unlock it are soon over.
TEST(ProtectiveStop, IsToldKeepsThePowerOffAndIsUnlockedByHandAlone) {
  const FaultyTwin twin(20);
  EXPECT_EQ(twin.tell("fault protective_stop"), "ok");
  twin.wait_for("PROTECTIVE_STOP");
  const ProgramResult watched = twin.run({"watch"});
  EXPECT_EQ(watched.code, 1) << watched.err;
  EXPECT_EQ(json::parse(watched.out)["states"], 1);
  const ProgramResult power = twin.run({"power", "--move"});
  EXPECT_EQ(power.code, 1) << power.err;
  EXPECT_EQ(json::parse(power.out)["outcome"], "refused");
  EXPECT_THAT(twin.tell("state"), HasSubstr("PROTECTIVE_STOP")) << "nothing unlocks by itself";
  const ProgramResult unlocked = twin.run({"unlock", "--move"});
  EXPECT_EQ(unlocked.code, 0) << unlocked.out;
  twin.wait_for("NORMAL");
}

TEST(CellPower, ReleasesNoBrakesOfARobotThatIsLost) {
  const FaultyTwin twin;
  EXPECT_EQ(twin.tell("fault emergency_stop"), "ok");
  twin.wait_for("POWER_OFF");
  EXPECT_EQ(twin.tell("fault release"), "ok");
  twin.wait_for("NORMAL");
  EXPECT_EQ(twin.tell("fault old_stamps"), "ok");
  const ProgramResult lost = twin.run({"power", "--move"});
  EXPECT_EQ(lost.code, 1) << lost.err;
  const json told = json::parse(lost.out);
  EXPECT_EQ(told["outcome"], "lost");
  EXPECT_THAT(told["text"].get<std::string>(), HasSubstr("no new package"));
  EXPECT_EQ(told["replies"].size(), 1U);
  EXPECT_EQ(twin.tell("fault release"), "ok");
  const ProgramResult done = twin.run({"power", "--move"});
  EXPECT_EQ(done.code, 0) << done.out;
  EXPECT_EQ(json::parse(done.out)["outcome"], "done");
}

}  // namespace
}  // namespace glint::test
