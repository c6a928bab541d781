// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint validate` on pictures that are there: what it tells, and its exit codes.
#include <filesystem>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/program.h"
#include "tests/cli/ring_or_bar.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// Each test has a copy of one run.
class Validate : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = std::make_unique<TemporaryFolder>();
    write_file(*made_ / "study.toml", kRingOrBar + "[validate]\ndesigns = \"bar\"\n");
    const ProgramResult run = glint_in(*made_, {"run", "study.toml", "--quiet", "--out", "run"});
    ASSERT_EQ(run.code, 0) << run.err;
  }

  static void TearDownTestSuite() { made_.reset(); }

  void SetUp() override {
    std::filesystem::copy(made_->path(), folder_.path(), std::filesystem::copy_options::recursive);
  }

  /// Photographs whose exposure is so many times that of the design.
  void photograph(const std::string& exposure) {
    const ProgramResult taken = glint_in(folder_,
                                         {"render",
                                          "run/bar/scene.toml",
                                          "--set",
                                          "sensor.seed=9",
                                          "--set",
                                          "sensor.exposure=" + exposure,
                                          "--quiet",
                                          "--out",
                                          "photos/bar"});
    ASSERT_EQ(taken.code, 0) << taken.err;
  }

  ProgramResult validate(const Arguments& more) {
    Arguments call = {"validate", "run", "--pictures", "photos", "--out", "out"};
    call.insert(call.end(), more.begin(), more.end());
    return glint_in(folder_, call);
  }

  TemporaryFolder folder_;

 private:
  inline static std::unique_ptr<TemporaryFolder> made_;
};

TEST_F(Validate, AgreesWithExitCodeZero) {
  photograph("0.5");
  const ProgramResult result = validate({"--json"});
  EXPECT_EQ(result.code, 0) << result.err << result.out;
  EXPECT_NE(Json::parse(result.out)["agreement"], "does_not_agree");
}

TEST_F(Validate, DisagreesWithExitCodeOne) {
  photograph("0.3");
  const ProgramResult result = validate({});
  EXPECT_EQ(result.code, 1) << result.err << result.out;
  EXPECT_THAT(result.out, HasSubstr("Simulation and reality do not agree: exposure"));
  EXPECT_EQ(Json::parse(read_file(folder_ / "out/result.json"))["agreement"], "does_not_agree");
}

TEST_F(Validate, RefusesToMoveWithoutACell) {
  const ProgramResult result = validate({"--move"});
  EXPECT_EQ(result.code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr("--move requires --cell"));
}

// The cell, which is not there, is asked after what the results need.
TEST_F(Validate, TellsOfResultsThatCannotBeBeforeTheCellIsAsked) {
  const auto error = [&](const Arguments& more) {
    Arguments call = {"validate", "run", "--cell", "none.toml", "--move"};
    call.insert(call.end(), more.begin(), more.end());
    const ProgramResult result = glint_in(folder_, call);
    EXPECT_NE(result.code, 0);
    return result.err;
  };
  EXPECT_THAT(error({"--out", "run"}), HasSubstr("run: holds results of `glint run`"));
  write_file(folder_ / "lens.toml", "[lens]\nfocal_mm = 8\n");
  EXPECT_THAT(error({"--calibration", "lens.toml"}), HasSubstr("lens.toml: is no calibration"));
  EXPECT_THAT(error({}), HasSubstr("none.toml"));
}

// The ring is dark in the only design that was photographed: where it is nobody can tell.
TEST_F(Validate, TellsWhatARefitCannotDetermineInTextFileAndPage) {
  photograph("0.5");
  const ProgramResult result = validate({"--refit"});
  EXPECT_EQ(result.code, 0) << result.err << result.out;
  const Json told = Json::parse(read_file(folder_ / "out/result.json"));
  bool has_ring = false;
  for (const Json& number : told["undetermined"]) {
    has_ring = has_ring || (number["name"] == "light_place" && number["of"] == "ring");
    const std::string text = number["text"].get<std::string>();
    EXPECT_THAT(text, HasSubstr("undetermined"));
    EXPECT_THAT(result.out, HasSubstr(text));
    EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr(text));
  }
  EXPECT_TRUE(has_ring) << told["undetermined"];
  const Json& inspected = told["designs"][0]["inspection"];
  for (const char* side : {"simulated", "real"}) {
    const bool is_found = inspected[std::string("found_") + side].get<int>() > 0;
    EXPECT_EQ(inspected[std::string("right_class_") + side].is_object(), is_found) << inspected;
  }
}

}  // namespace
}  // namespace glint::test
