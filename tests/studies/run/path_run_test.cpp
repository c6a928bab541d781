// SPDX-License-Identifier: GPL-3.0-or-later
//
// Searches over path-traced scenes.
#include "studies/run/run.h"

#include <chrono>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

const std::string kPathSearch = "schema = 1\n" + kPathPlate + kPathRing + kPathBar + R"(
[prototypes.dim]
"lighting.ring.radiance.0" = 0.1
[variables]
"lighting.ring.height_mm" = { min = 20, max = 40 }
"lighting.left.radiance.0" = { min = 0.2, max = 5.0 }
[objective]
maximise = "defects.min_weber"
[constraints]
"homogeneity.mean" = { max = 0.9 }
[search]
algorithm = "crs2"
[budget]
evaluations = 8
)";

Study study_from(const std::filesystem::path& folder, const std::string& text) {
  const std::filesystem::path file = folder / "study.toml";
  write_file(file, text);
  return load_study(file, {});
}

Json run_path_study(const std::filesystem::path& out,
                    const Study& study,
                    const std::atomic<int>* interrupt = nullptr) {
  return run_study(study,
                   {.out = out,
                    .threads = 2,
                    .jobs = 2,
                    .progress = Progress::Style::kNone,
                    .log_file = {},
                    .interrupt = interrupt});
}

TEST(PathRun, SearchesAndReportsStandardErrors) {
  const TemporaryFolder folder;
  const Study study = study_from(folder / ".", kPathSearch);
  const Json result = run_path_study(folder / "run", study);
  EXPECT_EQ(result.at("status"), "done") << result.dump(2);
  const std::string trials = read_file(folder / "run" / "trials.csv");
  EXPECT_THAT(trials, HasSubstr("defects.min_weber.error"));
  const std::string scores = read_file(folder / "run" / "baseline" / "scores.json");
  EXPECT_THAT(scores, HasSubstr("homogeneity.residual.error"));
  EXPECT_THAT(read_file(folder / "run" / "report.html"), HasSubstr("standard error"));
}

TEST(PathRun, GoesOnAfterInterruptsAsIfThereHadBeenNone) {
  const TemporaryFolder folder;
  const Study study = study_from(folder / ".", kPathSearch);
  run_path_study(folder / "whole", study);
  int interrupts = 0;
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> interrupt = 0;
    std::jthread bell([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(120 + 60 * round));
      interrupt = 1;
    });
    const Json result = run_path_study(folder / "pieces", study, &interrupt);
    if (result.at("status") != "interrupted") {
      break;
    }
    ++interrupts;
  }
  EXPECT_GE(interrupts, 1);
  EXPECT_EQ(read_file(folder / "pieces" / "trials.csv"),
            read_file(folder / "whole" / "trials.csv"));
  for (const char* design : {"baseline", "dim", "winner"}) {
    EXPECT_EQ(read_file(folder / "pieces" / design / "aspect.exr"),
              read_file(folder / "whole" / design / "aspect.exr"))
        << design;
  }
}

std::string study_error(const std::string& text) {
  const TemporaryFolder folder;
  try {
    study_from(folder / ".", text);
    return "";
  } catch (const ConfigError& error) {
    return error.what();
  }
}

std::string with(std::string text, const std::string& old, const std::string& now) {
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), now);
}

TEST(PathStudy, RefusesWhatPathTracedScenesDoNotHave) {
  EXPECT_EQ(study_error(kPathSearch), "");
  EXPECT_THAT(study_error(with(kPathSearch, "crs2", "slsqp")),
              HasSubstr("search.algorithm: \"slsqp\" needs derivatives"));
  for (const char* score : {"view.slot_margin_mm", "fringe.modulation", "homogeneity.ripple"}) {
    EXPECT_THAT(study_error(with(kPathSearch, "defects.min_weber", score)),
                HasSubstr("needs a tunnel"));
  }
  EXPECT_THAT(study_error(with(kPathSearch, "defects.min_weber", "rays.blocked_share")),
              HasSubstr("has no such score"));
  EXPECT_THAT(study_error(with(kPathSearch, "defects.min_weber", "defects.min_weber.error")),
              HasSubstr("is a standard error"));
}

}  // namespace
}  // namespace glint
