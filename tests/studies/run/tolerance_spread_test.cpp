// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/tolerance_spread.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/thread_pool.h"
#include "studies/definition/manufacture.h"
#include "studies/definition/study_text.h"
#include "studies/run/run.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

const std::string kSearch = "schema = 1\n" + kPathPlate + kPathRing + R"(
[variables]
"lighting.ring.height_mm" = { min = 20, max = 60 }
"lighting.ring.radiance.0" = { min = 0.1, max = 0.2 }
[objective]
maximise = "homogeneity.mean"
[constraints]
"homogeneity.clipped_share" = { max = 0.5 }
"defects.min_cnr" = { min = -1 }
[search]
algorithm = "sobol"
[budget]
evaluations = 3
)";

Study study_of(const TemporaryFolder& folder, const std::string& tolerances) {
  write_file(folder / "study.toml", kSearch + tolerances);
  return load_study(folder / "study.toml", {});
}

std::string refusal(const std::string& tolerances) {
  const TemporaryFolder folder;
  try {
    study_of(folder, "[manufacture]\n" + tolerances);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// The picture is proportional to the radiance: spread evenly by 0.03 about 0.15 its mean has a
// standard deviation of 0.03 / 0.15 / sqrt(3) = 0.1155 of itself.
TEST(ToleranceSpread, IsThatOfAUniformKey) {
  const TemporaryFolder folder;
  const Study study =
      study_of(folder, "[manufacture]\n\"lighting.ring.radiance.0\" = { plus_minus = 0.03 }\n");
  ThreadPool pool(2);
  SceneStore store(pool);
  const Json spread = tolerance_spread(store, study, {40.0, 0.15});
  EXPECT_EQ(spread["designs"], 64);
  EXPECT_EQ(spread["failed"], 0);
  EXPECT_EQ(spread["distribution"], "uniform");
  EXPECT_EQ(spread["plus_minus"]["lighting.ring.radiance.0"], 0.03);
  EXPECT_EQ(spread["feasible_share"], 1.0);
  const Json& mean = spread["scores"]["homogeneity.mean"];
  const auto nominal = mean["nominal"].get<double>();
  EXPECT_NEAR(mean["mean"].get<double>() / nominal, 1.0, 0.01);
  EXPECT_NEAR(mean["sd"].get<double>() / nominal, 0.2 / std::sqrt(3.0), 0.005);
  EXPECT_NEAR(mean["low"].get<double>() / nominal, 1.0 - 0.9 * 0.2, 0.02);
  EXPECT_NEAR(mean["high"].get<double>() / nominal, 1.0 + 0.9 * 0.2, 0.02);
  EXPECT_EQ(spread, tolerance_spread(store, study, {40.0, 0.15}));
}

TEST(ToleranceSpread, StandsInResultAndReport) {
  const TemporaryFolder folder;
  const RunOptions options = {.out = folder / "run",
                              .threads = 2,
                              .jobs = 1,
                              .progress = Progress::Style::kNone,
                              .log_file = {}};
  // A key that is no variable, too.
  const Json result = run_study(
      study_of(folder, "[manufacture]\n\"lighting.ring.inner_radius_mm\" = { plus_minus = 2 }\n"),
      options);
  EXPECT_EQ(result["evaluations"], 3) << "counted apart";
  EXPECT_GT(result["manufacture"]["scores"]["homogeneity.mean"]["sd"].get<double>(), 0.0);
  EXPECT_THAT(read_file(folder / "run/report.html"), HasSubstr("As it will be built"));
  EXPECT_THAT(read_file(folder / "run/study.resolved.toml"), HasSubstr("plus_minus"));
}

TEST(ToleranceSpread, IsNotInStudiesWithoutIt) {
  const TemporaryFolder folder;
  const Study plain = study_of(folder, "");
  EXPECT_EQ(resolved_text(plain).find("manufacture"), std::string::npos);
  const Study built =
      study_of(folder, "[manufacture]\n\"lighting.ring.radiance.0\" = { plus_minus = 0.01 }\n");
  EXPECT_NE(config_hash(plain), config_hash(built));
  std::vector<Problem> errors;
  EXPECT_TRUE(read_tolerances(plain, errors).empty());
  EXPECT_TRUE(errors.empty());
}

TEST(ToleranceSpread, RefusesWhatHasNoMeaning) {
  const std::string radiance = "\"lighting.ring.radiance.0\" = ";
  EXPECT_THAT(refusal(radiance + "{ plus_minus = 0 }\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(refusal(radiance + "{ plus_minus = -1 }\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(refusal(radiance + "{ plus_minus = 0.06 }\n"), HasSubstr("beyond the variable's"));
  EXPECT_THAT(refusal(radiance + "0.01\n"), HasSubstr("must be a table"));
  EXPECT_THAT(refusal(radiance + "{ plus = 0.01 }\n"), HasSubstr("must be a table"));
  EXPECT_THAT(refusal("\"material.roughness\" = { plus_minus = 0.8 }\n"),
              HasSubstr("beyond the key's range"));
  EXPECT_THAT(refusal("\"material.type\" = { plus_minus = 1 }\n"), HasSubstr("a real number"));
  EXPECT_THAT(refusal("\"lighting.ring.heigth_mm\" = { plus_minus = 1 }\n"),
              HasSubstr("nearest one is \"lighting.ring.height_mm\""));
  EXPECT_EQ(refusal(radiance + "{ plus_minus = 0.05 }\n"), "");
}

}  // namespace
}  // namespace glint
