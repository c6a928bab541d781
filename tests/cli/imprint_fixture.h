// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/program.h"

namespace glint::test {

/// `glint imprint` in a folder of its own.
class ImprintVerb : public ::testing::Test {
 protected:
  /// A shaft of 20 mm with up to two dents and a scratch: a part takes some milliseconds.
  static constexpr const char* kShaft = R"(schema = 1

[part]
shape = "cylinder"
length_mm = 20
radius_mm = 8

[defects.dent]
realisation = "imprinted"
count = [1, 2]
diameter_mm = [1, 2]
height_um = [50, 150]
tool_level = 2

[defects.scratch]
realisation = "imprinted"
count = 1
length_mm = [3, 5]
width_mm = 0.3
height_um = 60

[imprint]
seed = 3
)";

  /// Closed, turned outwards, 1 mm wide, half of it below z = 0.
  static constexpr const char* kTetrahedron =
      "OFF\n4 4 0\n0 0 -0.5\n-0.5 -0.5 0.5\n0.5 -0.5 0.5\n0 0.5 0.5\n"
      "3 0 2 1\n3 0 3 2\n3 0 1 3\n3 1 2 3\n";
  static constexpr const char* kOpenTetrahedron =
      "OFF\n4 3 0\n0 0 -0.5\n-0.5 -0.5 0.5\n0.5 -0.5 0.5\n0 0.5 0.5\n"
      "3 0 2 1\n3 0 3 2\n3 0 1 3\n";

  void SetUp() override { write(kShaft); }

  void write(const std::string& scene) { write_file(folder_ / "study.toml", scene); }

  ProgramResult imprint(const std::string& out, const Arguments& more = {}) const {
    Arguments arguments = {"imprint", "study.toml", "--quiet", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return glint_in(folder_, arguments);
  }

  nlohmann::json imprint_json(const std::string& out, Arguments more = {}) const {
    more.emplace_back("--json");
    const ProgramResult result = imprint(out, more);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
  }

  /// One line on stderr, nothing on stdout, nothing left behind.
  void expect_refused(const std::string& scene,
                      int code,
                      const std::string& message,
                      const Arguments& more = {}) {
    write(scene);
    const std::ptrdiff_t files = folder_.count();
    const ProgramResult result = imprint("out/deeper/parts", more);
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, ::testing::MatchesRegex(message + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(folder_.count(), files) << "something is left behind";
  }

  TemporaryFolder folder_;
};

}  // namespace glint::test
