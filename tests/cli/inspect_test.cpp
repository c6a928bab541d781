// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint inspect`: files, grades, learning.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/rng.h"
#include "core/units.h"
#include "tests/cli/inspect_fixture.h"
#include "tests/support/page_data.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

TEST_F(InspectVerb, FindsAHoleAndAScratch) {
  write_part("part");
  const Json result = inspect_json({"part"});
  EXPECT_EQ(result["schema"], 1);
  EXPECT_EQ(result["status"], "done");
  EXPECT_EQ(result["has_limits"], false);
  EXPECT_EQ(result["grades"], nullptr);
  ASSERT_EQ(result["parts"].size(), 1U);
  const Json& part = result["parts"][0];
  EXPECT_EQ(part["name"], "part");
  EXPECT_EQ(part["grade"], nullptr);
  EXPECT_EQ(part["pictures"], 4);
  EXPECT_EQ(part["mask"], "silhouette");
  ASSERT_EQ(part["defects"].size(), 2U) << part["defects"];
  const Json& scratch = part["defects"][0];  // its first pixel lies higher
  const Json& hole = part["defects"][1];
  EXPECT_EQ(hole["kind"], "hole");
  EXPECT_EQ(hole["is_bright"], false);
  EXPECT_NEAR(hole["x_px"].get<double>(), 60.5, 0.6);
  EXPECT_NEAR(hole["y_px"].get<double>(), 50.5, 0.6);
  EXPECT_EQ(scratch["kind"], "scratch");
  EXPECT_EQ(scratch["is_bright"], false);
  EXPECT_NEAR(scratch["angle_deg"].get<double>(), 26.6, 3.0);
  EXPECT_EQ(part["holes"]["biggest"], hole["area_px"]);
  EXPECT_EQ(part["scratches"]["sum"], scratch["area_px"]);
}

TEST_F(InspectVerb, WritesItsFiles) {
  write_part("part");
  const Json result = inspect_json({"part"});
  EXPECT_EQ(result["report"], "out/report.html");
  Json written = Json::parse(read_file(folder_ / "out/result.json"));
  EXPECT_EQ(written["report"], "report.html");
  EXPECT_EQ(written["parts"], result["parts"]);
  const std::string csv = read_file(folder_ / "out/defects.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3) << csv;
  EXPECT_THAT(csv, HasSubstr("part,2,hole,"));
  EXPECT_EQ(read_picture(folder_ / "out/part/aspect.png").width(), kWidth);
  const Picture overlay = read_picture(folder_ / "out/part/overlay.png");
  EXPECT_EQ(overlay.channels, 3);
  EXPECT_EQ(overlay.width() % kWidth, 0) << "enlarged by a whole factor";
  const Json page = page_data(read_file(folder_ / "out/report.html"));
  EXPECT_EQ(page["verdict"]["sentence"], "2 defects found on 1 part.");
  const Json& shown = page["inspection"]["parts"][0];
  EXPECT_EQ(shown["defects"].size(), 2U);
  for (const Json& defect : shown["defects"]) {
    EXPECT_THAT(defect["outline"].get<std::string>(),
                MatchesRegex("[0-9.]+,[0-9.]+( [0-9.]+,[0-9.]+)+"));
  }
  EXPECT_GE(shown["defects"][0]["area_px"], shown["defects"][1]["area_px"]);
  double pixels = 0.0;
  for (const Json& count : shown["histogram"]["counts"]) {
    pixels += count.get<double>();
  }
  EXPECT_EQ(pixels, result["parts"][0]["region_px"]);
  EXPECT_TRUE(shown.contains("image"));
  EXPECT_TRUE(Json::parse(read_file(folder_ / "out/run.json")).contains("timings"));
}

// Four steps of a sine of period 40 px, 0.5 + 0.4 sin; a bent place moves it by 0.1 periods.
TEST_F(InspectVerb, WritesThePhasesOfShiftedStripes) {
  std::filesystem::create_directories(folder_ / "stripes");
  for (int k = 0; k < 4; ++k) {
    ImageF frame(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool is_bent = std::hypot(x - 40, y - 30) < 3.0;
        const double turns = x / 40.0 - k / 4.0 + (is_bent ? 0.1 : 0.0);
        frame(x, y) = static_cast<float>(0.5 + 0.4 * std::sin(2.0 * kPi * turns));
      }
    }
    write_png(folder_ / fmt::format("stripes/frame_{}.png", k), frame, PixelDepth::k16Bit);
  }
  const Json result = inspect_json({"stripes"},
                                   {"--set",
                                    "inspection.filter=phase",
                                    "--set",
                                    "inspection.polarity=bright",
                                    "--set",
                                    "inspection.threshold=fixed",
                                    "--set",
                                    "inspection.threshold_grey=0.03",
                                    "--set",
                                    "inspection.kernel_px=15",
                                    "--set",
                                    "inspection.erosion_px=8"});
  const Json& part = result["parts"][0];
  ASSERT_EQ(part["defects"].size(), 1U) << result.dump(1);
  EXPECT_NEAR(part["defects"][0]["x_px"].get<double>(), 40.5, 0.5);
  EXPECT_NEAR(part["defects"][0]["y_px"].get<double>(), 30.5, 0.5);
  const auto picture = [&](const char* key) {
    return read_image(folder_ / "out" / part[key].get<std::string>());
  };
  EXPECT_NEAR(picture("modulation")(70, 10), 0.8, 1e-3);  // 0.4 over 0.5
  // A quarter of a period is 10 px.
  EXPECT_NEAR(
      std::abs(std::remainder(
          static_cast<double>(picture("phase")(80, 10) - picture("phase")(70, 10)), 2.0 * kPi)),
      0.5 * kPi,
      1e-3);
  EXPECT_GT(std::abs(picture("response")(40, 30)), 0.03F);
}

TEST_F(InspectVerb, GivesTheSameBytesForAnyNumberOfThreads) {
  write_part("part");
  inspect_json({"part"}, {"--threads", "1"});
  const auto one = files_below(folder_ / "out");
  inspect_json({"part"}, {"--threads", "5"});
  EXPECT_EQ(files_below(folder_ / "out"), one);
}

TEST_F(InspectVerb, TakesFilesInNaturalOrder) {
  write_part("part");
  const Json folder = inspect_json({"part"});
  const Json files = inspect_json(
      {"part/frame_3.png", "part/frame_0.png", "part/frame_2.png", "part/frame_1.png"});
  EXPECT_EQ(files["parts"][0]["defects"], folder["parts"][0]["defects"]);
  EXPECT_EQ(files["parts"][0]["first_picture"], "part/frame_0.png");
  EXPECT_THAT(files["parts"][0]["notes"].dump(), HasSubstr("not in the order given"));
}

TEST_F(InspectVerb, FindsTheSameIn16Bits) {
  write_part("part");
  write_part("deep", true, PixelDepth::k16Bit);
  const Json result = inspect_json({"part", "deep"});
  ASSERT_EQ(result["parts"].size(), 2U);
  EXPECT_EQ(result["parts"][1]["bits"], 16);
  ASSERT_EQ(result["parts"][1]["defects"].size(), 2U);
  EXPECT_NEAR(result["parts"][1]["defects"][1]["x_px"].get<double>(),
              result["parts"][0]["defects"][1]["x_px"].get<double>(),
              0.2);
}

TEST_F(InspectVerb, ReadsColours) {
  ImageF grey = plain_part(1);
  add_spot(grey, 60, 50, 3, -0.2F);
  ImageRgb colour(kWidth, kHeight);
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const auto code = static_cast<std::uint8_t>(std::lround(255.0F * grey.values()[i]));
    colour.values()[i] = {code, code, code};
  }
  write_file(folder_ / "a.png", png_bytes(colour));
  write_mask_png(folder_ / "mask.png", Mask(kWidth, kHeight, 1));
  Mask mask(kWidth, kHeight);
  for (int y = 22; y < kHeight - 22; ++y) {
    std::fill_n(mask.row(y) + 22, kWidth - 44, static_cast<unsigned char>(1));
  }
  write_mask_png(folder_ / "mask.png", mask);
  const Json result =
      inspect_json({"a.png"}, {"--mask", "mask.png", "--set", "inspection.filter=gaussian"});
  const Json& part = result["parts"][0];
  EXPECT_EQ(part["channels"], 3);
  EXPECT_EQ(part["mask"], "file");
  EXPECT_EQ(part["defects"].size(), 1U);
  EXPECT_THAT(part["notes"].dump(), HasSubstr("luminance"));
}

TEST_F(InspectVerb, TakesOnePictureForAnAspectImage) {
  ImageF picture(kWidth, kHeight);
  Rng rng(5, Stream::kTest, 0);
  for (float& value : picture.values()) {
    value = static_cast<float>(0.5 + rng.uniform(-0.01, 0.01));
  }
  add_spot(picture, 60, 50, 3, -0.2F);
  write_png(folder_ / "one.png", picture, PixelDepth::k8Bit);
  const Json result = inspect_json({"one.png"});
  const Json& part = result["parts"][0];
  EXPECT_EQ(part["name"], "one");
  EXPECT_EQ(part["mask"], "picture");
  EXPECT_EQ(part["defects"].size(), 1U);
  EXPECT_THAT(part["notes"].dump(), HasSubstr("whole picture"));
  EXPECT_THAT(part["notes"].dump(), HasSubstr("No scan was given"));
  // What is set holds: the filter of scans, which names dark what is dark.
  const Json scan = inspect_json(
      {"one.png"}, {"--set", "inspection.filter=gaussian", "--set", "inspection.max_reports=0"});
  ASSERT_EQ(scan["parts"][0]["defects"].size(), 1U);
  EXPECT_EQ(scan["parts"][0]["defects"][0]["is_bright"], false);
}

// Sixty specks: a photograph's report is as long as one can look through.
TEST_F(InspectVerb, ReportsFewPlacesOfAPhotograph) {
  ImageF picture(600, 400, 0.5F);
  for (int i = 0; i < 60; ++i) {
    add_spot(picture,
             30 + 60 * (i % 10),
             30 + 65 * (i / 10),
             1,
             -0.05F - 0.002F * static_cast<float>(i));
  }
  write_png(folder_ / "one.png", picture, PixelDepth::k8Bit);
  const ProgramResult told = glint_in(folder_, {"inspect", "one.png", "--out", "out"});
  EXPECT_EQ(told.code, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("The 20 places that stand out most are reported"));
}

TEST_F(InspectVerb, InspectsBothSidesOfADarkBand) {
  fs::create_directories(folder_ / "cut");
  for (int frame = 0; frame < 2; ++frame) {
    ImageF picture = plain_part(static_cast<std::uint64_t>(frame) + 1);
    for (int y = 46; y < 54; ++y) {
      std::fill_n(picture.row(y), kWidth, 0.02F);
    }
    add_spot(picture, 60, 33, 3, -0.2F);
    add_spot(picture, 110, 66, 3, -0.2F);
    write_png(folder_ / fmt::format("cut/{}.png", frame), picture, PixelDepth::k8Bit);
  }
  const Json part = inspect_json({"cut"})["parts"][0];
  EXPECT_EQ(part["mask"], "silhouette");
  EXPECT_EQ(part["defects"].size(), 2U) << part["defects"];
  EXPECT_EQ(part["region_px"], 2 * 112 * 18);
  // 120 x 52 px are bright but for the spots of 37 px, which are not.
  EXPECT_NEAR(part["bright_share"].get<double>(), (4032.0 - 74.0) / (6240.0 - 74.0), 0.01);
  EXPECT_THAT(part["notes"].dump(), HasSubstr("found in 2 pieces"));
  EXPECT_THAT(part["notes"].dump(), HasSubstr("Only 64."));
  const ProgramResult told = glint_in(folder_, {"inspect", "cut", "--out", "out"});
  EXPECT_THAT(told.out, HasSubstr(" inspected\n"));
  EXPECT_THAT(told.out, HasSubstr(" 64."));
}

// The reference is whole; the part it is laid onto is cut by the band, and beside it lies
// something.
TEST_F(InspectVerb, LaysAReferenceMaskOntoAPartInPieces) {
  ImageF picture = plain_part(1);
  for (int y = 46; y < 54; ++y) {
    std::fill_n(picture.row(y), kWidth, 0.02F);
  }
  ImageF reference(kWidth, kHeight);
  for (int y = 20; y < kHeight - 20; ++y) {
    std::fill_n(reference.row(y) + 20, kWidth - 40, 1.0F);
  }
  write_png(folder_ / "cut.png", picture, PixelDepth::k8Bit);
  write_png(folder_ / "reference.png", reference, PixelDepth::k8Bit);
  const Json part = inspect_json({"cut.png"}, {"--reference_mask", "reference.png"})["parts"][0];
  // Of one half alone it would be 120 x 26 px less its rim, 2016.
  EXPECT_GT(part["region_px"].get<double>(), 0.8 * 112.0 * 52.0);
}

TEST_F(InspectVerb, TakesEachPictureForAPart) {
  write_part("part");
  const Json result = inspect_json({"part"}, {"--each"});
  ASSERT_EQ(result["parts"].size(), 4U);
  EXPECT_EQ(result["parts"][3]["name"], "frame_3");
}

TEST_F(InspectVerb, LaysAReferenceMaskOntoThePart) {
  write_part("part");
  ImageF reference(120, 90);  // the same outline of 120 x 60 px, half as large, elsewhere
  for (int y = 40; y < 70; ++y) {
    for (int x = 30; x < 90; ++x) {
      reference(x, y) = 1.0F;
    }
  }
  write_png(folder_ / "reference.png", reference, PixelDepth::k8Bit);
  const Json result = inspect_json({"part"}, {"--reference_mask", "reference.png"});
  const Json& part = result["parts"][0];
  EXPECT_EQ(part["mask"], "reference");
  // 112 x 52 px are left of 120 x 60 without a rim of 4 px.
  EXPECT_NEAR(part["region_px"].get<double>(), 112.0 * 52.0, 250.0);
  EXPECT_EQ(part["defects"].size(), 2U);
}

TEST_F(InspectVerb, GradesByLimitsAndTellsRejectionByItsExitCode) {
  write_part("part");
  write_part("good", false);
  write_file(folder_ / "limits.toml",
             "[inspection.holes]\nacceptable_biggest = 60\nacceptable_sum = 60\n"
             "[inspection.scratches]\nacceptable_biggest = 200\nacceptable_sum = 200\n");
  const Json passed = inspect_json({"part", "good"}, {"--settings", "limits.toml"});
  EXPECT_EQ(passed["parts"][0]["grade"], "Acceptable");
  EXPECT_EQ(passed["parts"][0]["holes"]["grade"], "Acceptable");
  EXPECT_EQ(passed["parts"][1]["grade"], "Perfect");
  EXPECT_EQ(passed["grades"], Json({{"Perfect", 1}, {"Acceptable", 1}, {"Rejected", 0}}));
  const Json failed =
      inspect_json({"part", "good"},
                   {"--settings", "limits.toml", "--set", "inspection.holes.acceptable_sum=2"},
                   1);
  EXPECT_EQ(failed["parts"][0]["grade"], "Rejected");
  EXPECT_EQ(failed["status"], "done");
}

TEST_F(InspectVerb, LearnsLimitsThatItCanUse) {
  write_part("bad");
  write_part("good", false);
  write_file(folder_ / "labels.csv", "part,grade\ngood,perfect\nbad,Rejected\n");
  const Json learned = inspect_json({"bad", "good"}, {"--labels", "labels.csv", "--learn"});
  EXPECT_EQ(learned["learned"]["parts"], 2);
  EXPECT_EQ(learned["learned"]["wrong"], 0);
  EXPECT_EQ(learned["parts"][0]["grade"], "Rejected");
  EXPECT_EQ(learned["parts"][1]["grade"], "Perfect");
  fs::rename(folder_ / "out/grading.toml", folder_ / "grading.toml");
  const Json used =
      inspect_json({"bad", "good"}, {"--settings", "grading.toml", "--labels", "labels.csv"}, 1);
  EXPECT_EQ(used["agreement"], Json({{"parts", 2}, {"equal", 2}}));
  const Json page = page_data(read_file(folder_ / "out/report.html"))["inspection"];
  EXPECT_EQ(page["parts"][0]["label"], "Rejected");
  EXPECT_EQ(page["limits"]["holes"].size(), 4U);
}

TEST_F(InspectVerb, TakesTheThresholdFromFlawlessParts) {
  write_part("part");
  write_part("good", false);
  const Arguments setting = {"--set", "inspection.threshold=false_alarms"};
  expect_refused(
      {"part"}, 2, R"(part: inspection\.threshold: "false_alarms" .*--flawless.*)", setting);
  Arguments more = setting;
  more.insert(more.end(), {"--flawless", "good"});
  const Json result = inspect_json({"part", "good"}, more);
  EXPECT_EQ(result["parts"][0]["defects"].size(), 2U);
  EXPECT_EQ(result["parts"][1]["defects"].size(), 0U);
  EXPECT_EQ(result["parts"][0]["threshold"], result["parts"][1]["threshold"]);
}

TEST_F(InspectVerb, ComparesARunWithItsTruth) {
  write_file(folder_ / "study.toml", small_study());
  ASSERT_EQ(glint_in(folder_, {"run", "study.toml", "--quiet", "--out", "run"}).code, 0);
  const Json result = inspect_json({"run"});
  ASSERT_GE(result["parts"].size(), 2U);
  EXPECT_EQ(result["parts"][0]["name"], "baseline");
  EXPECT_EQ(result["parts"][1]["name"], "winner");
  const Json page = page_data(read_file(folder_ / "out/report.html"));
  Json shown;  // on the page, by name
  for (const Json& part : page["inspection"]["parts"]) {
    shown[part["name"].get<std::string>()] = part;
  }
  int known = 0;
  for (const Json& part : result["parts"]) {
    EXPECT_EQ(part["mask"], "design");
    const Json& truth = part["truth"];
    EXPECT_EQ(truth["found"].get<int>() + truth["missed"].get<int>(), truth["defects"]);
    EXPECT_EQ(truth["list"].size(), truth["defects"]);
    int other_kind = 0;
    for (const Json& defect : truth["list"]) {
      if (!defect["found_as"].is_null()) {
        const Json& blob = part["defects"][defect["found_as"].get<std::size_t>() - 1];
        other_kind += (defect["kind"] == "scratch") != (blob["kind"] == "scratch") ? 1 : 0;
      }
    }
    EXPECT_EQ(truth["other_kind"], other_kind);
    EXPECT_EQ(std::ranges::count_if(
                  shown[part["name"].get<std::string>()]["defects"],
                  [](const Json& defect) { return defect["known_as"] == "false alarm"; }),
              truth["false_alarms"]);
    EXPECT_EQ(shown[part["name"].get<std::string>()]["missed"].size(), truth["missed"]);
    known += truth["defects"].get<int>();
  }
  EXPECT_EQ(result["truth"]["defects"], known);
  fs::remove_all(folder_ / "out");  // holds the inspection of more parts
  EXPECT_EQ(inspect_json({"run/winner"})["parts"][0]["defects"], result["parts"][1]["defects"]);
}

TEST_F(InspectVerb, LeavesResultsOfAnotherKindAlone) {
  write_part("part");
  fs::create_directories(folder_ / "out");
  write_file(folder_ / "out/result.json", "{}");
  const ProgramResult result = inspect({"part"});
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(
      result.err,
      "out: holds a result.json that is not of `glint inspect`; choose another output folder\n");
  EXPECT_EQ(folder_.count(), 2);
}

TEST_F(InspectVerb, InterruptedExits130AndLeavesNothing) {
  fs::create_directories(folder_ / "many");
  write_png(folder_ / "many/0.png", plain_part(1), PixelDepth::k8Bit);
  for (int i = 1; i < 300; ++i) {
    fs::copy_file(folder_ / "many/0.png", folder_ / "many" / fmt::format("{}.png", i));
  }
  Program program(folder_.path(), {"inspect", "many", "--each", "--quiet", "--out", "out"});
  while (program.is_running() && !fs::exists(folder_ / "out")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  program.send(SIGINT);
  EXPECT_EQ(program.wait().code, 130);
  EXPECT_EQ(folder_.count(), 1) << "only the pictures";
}

TEST_F(InspectVerb, PrintsATableForPeople) {
  write_part("part");
  const ProgramResult result = glint_in(folder_, {"inspect", "part", "--out", "out"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("not graded"));
  EXPECT_THAT(result.out, HasSubstr(" px "));
  EXPECT_EQ(result.out.find("e+"), std::string::npos);
  EXPECT_THAT(result.out, HasSubstr("report: out/report.html\n"));
  EXPECT_THAT(glint_in(folder_, {"inspect", "--help"}).out, HasSubstr("Example:\n  glint inspect"));
}

}  // namespace
}  // namespace glint::test
