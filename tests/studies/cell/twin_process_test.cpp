// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/twin_process.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/wall_clock.h"

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
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EXIT(serve_twins(slow_twins, {}, [](const auto&) {}), testing::ExitedWithCode(0), "");
  EXPECT_LT(seconds_since(begin), 20.0);
}

}  // namespace
}  // namespace glint
