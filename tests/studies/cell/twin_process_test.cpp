// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/twin_process.h"

#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/wall_clock.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

/// Still renders a picture when it shall end.
class SlowTwin final : public ServingTwin {
 public:
  SlowTwin() = default;

  ~SlowTwin() override { std::this_thread::sleep_for(std::chrono::seconds(30)); }

  SlowTwin(const SlowTwin&) = delete;
  SlowTwin& operator=(const SlowTwin&) = delete;

  nlohmann::ordered_json description() const override { return {{"kind", "camera"}}; }

  bool has_ended() const override { return true; }
};

ServingTwins slow_twins() {
  ServingTwins twins;
  twins.push_back(std::make_unique<SlowTwin>());
  return twins;
}

TEST(ServeTwins, EndsWithoutWaitingForAPicture) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // other tests have left threads behind
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EXIT(serve_twins(slow_twins, {}, [](const auto&) {}), testing::ExitedWithCode(0), "");
  EXPECT_LT(seconds_since(begin), 20.0);
}

// The file appears when the twins serve, and goes with them: a study of that name would be lost.
TEST(ServeTwins, LeaveAFileThatIsNoReadyFileAlone) {
  const TemporaryFolder folder;
  const auto problem = [&](const char* file) {
    return text_thrown_by<ConfigError>([&] {
      serve_twins([]() -> ServingTwins { throw ConfigError("twins are made"); },
                  {.ready_file = folder / file},
                  [](const auto&) {});
    });
  };
  write_file(folder / "cell.toml", "[robot]\n");
  EXPECT_THAT(problem("cell.toml"),
              testing::HasSubstr("cell.toml: exists and is no ready file of twins; give "
                                 "--ready_file another name"));
  EXPECT_EQ(read_file(folder / "cell.toml"), "[robot]\n");
  write_file(folder / "twin.json", R"({"pid": 1, "twins": []})");
  EXPECT_EQ(problem("twin.json"), "twins are made");
  EXPECT_EQ(problem("to_come.json"), "twins are made");
}

// Each of the ready files would be refused when it is read.
TEST(RobotTwinPort, IsNoneThatLeadsWhatOnlyAsksToScripts) {
  Cell cell;
  cell.robot.emplace();
  const auto problem = [&cell](int port) {
    return text_thrown_by<ConfigError>([&] { check_robot_twin_port(cell, port); });
  };
  for (const int rtde : {30001, 30002, 30003, 30020}) {
    EXPECT_THAT(problem(rtde), testing::HasSubstr("rtde_port of the robot's twin is")) << rtde;
    EXPECT_THAT(problem(rtde - 3), testing::HasSubstr("dashboard_port of the robot's twin is"))
        << rtde;
  }
  for (const int port : {0, 29997, 30004, 40000}) {
    EXPECT_NO_THROW(check_robot_twin_port(cell, port)) << port;
  }
  EXPECT_NO_THROW(check_robot_twin_port(cell, std::nullopt));
}

}  // namespace
}  // namespace glint
