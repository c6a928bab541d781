// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ctrl-C: the first finishes what runs, the second stops at once; both can be resumed.
#include <chrono>
#include <csignal>
#include <thread>

#include <nlohmann/json.hpp>

#include "tests/cli/record.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;

const Arguments kRun = {"run", "study.toml", "--json", "--quiet", "--out", "out"};

/// Waits until that many evaluations are recorded; false when the program ends before.
bool wait_for_evaluations(Program& program, const fs::path& out, std::size_t count) {
  while (program.is_running()) {
    if (recorded_evaluations(out).size() >= count) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST(Interrupt, FinishesExits130AndResumesToTheSameResult) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", slow_study());
  ASSERT_EQ(glint_in(folder, {"run", "study.toml", "--quiet", "--out", "whole"}).code, 0);

  Program program(folder.path(), kRun);
  ASSERT_TRUE(wait_for_evaluations(program, folder / "out", 3));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.code, 130);
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["status"], "interrupted");
  EXPECT_GE(json["evaluations"], 3);
  EXPECT_LT(json["evaluations"], 40);
  EXPECT_TRUE(fs::exists(folder / "out/report.html"));

  const ProgramResult resumed = glint_in(folder, kRun);
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  expect_same_files(folder / "out", folder / "whole");
}

TEST(Interrupt, TwiceStopsAtOnceAndLosesNothing) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", slow_study());
  ASSERT_EQ(glint_in(folder, {"run", "study.toml", "--quiet", "--out", "whole"}).code, 0);

  Program program(folder.path(), kRun);
  ASSERT_TRUE(wait_for_evaluations(program, folder / "out", 3));
  // Two of a kind might be delivered as one.
  program.send(SIGINT);
  program.send(SIGTERM);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.code, 130);
  EXPECT_EQ(result.out, "");
  EXPECT_FALSE(fs::exists(folder / "out/report.html"));
  const auto recorded = recorded_evaluations(folder / "out");
  EXPECT_GE(recorded.size(), 3U);

  const ProgramResult resumed = glint_in(folder, kRun);
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  expect_kept(recorded, recorded_evaluations(folder / "out"));
  expect_same_files(folder / "out", folder / "whole");
}

}  // namespace
}  // namespace glint::test
