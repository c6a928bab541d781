// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of a study with several objectives in a browser, used as a reader does.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/rng.h"
#include "optimizer/front/front.h"
#include "studies/report/report.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kBrowser = "chromium";
constexpr int kTrials = 1000;
constexpr std::array kObjectives = {"homogeneity.h_rms", "defects.min_cnr", "lighting.width_mm"};

/// Stripes over noise, so that it takes as much room as a real picture.
ImageF stripes(int width, int height, int seed) {
  Rng rng(static_cast<std::uint64_t>(seed), Stream::kTest, 0);
  ImageF image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image(x, y) =
          static_cast<float>(0.5 + 0.3 * std::sin(x / (6.0 + seed % 9)) + 0.05 * rng.uniform());
    }
  }
  return image;
}

Json variable(const char* name, double low, double high) {
  return {{"name", name}, {"kind", "float"}, {"low", low}, {"high", high}, {"log", false}};
}

/// A wide tunnel is even and hides the defect; every trial with its noise.
Json trial_of(int number) {
  Rng rng(1, Stream::kTest, static_cast<std::uint64_t>(number));
  const double radius = rng.uniform(60.0, 250.0);
  const double duty = rng.uniform(0.2, 0.8);
  const double even = 0.3 + 0.5 * radius / 250.0 - 0.4 * std::abs(duty - 0.5) + 0.01 * rng.normal();
  const double cnr =
      8.0 - 3.0 * std::pow(radius / 250.0, 2) - 6.0 * std::abs(duty - 0.4) + 0.1 * rng.normal();
  const bool is_feasible = duty < 0.75;
  return {{"number", number},
          {"kind", "gp"},
          {"values", {radius, duty}},
          {"failed", false},
          {"feasible", is_feasible},
          {"objective", even},
          {"scores",
           {{kObjectives[0], even},
            {kObjectives[1], cnr},
            {kObjectives[2], 2.0 * radius},
            {"homogeneity.clipped_share", is_feasible ? 0.0 : 0.02}}}};
}

/// A member as a run writes it, with pictures: in full, or a small one.
Json member_of(const Json& trial, bool is_full) {
  const int number = trial["number"];
  const std::string drawing = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 300 200\"><text x=\"20\" y=\"100\">"
      "drawing {}</text></svg>",
      number);
  Json json = {{"trial", number},
               {"variables",
                {{"lighting.tunnel.radius_mm", trial["values"][0]},
                 {"lighting.tunnel.duty", trial["values"][1]}}},
               {"scores", trial["scores"]},
               {"errors", {{kObjectives[1], 0.1}}},
               {"contribution", 0.1},
               {"shown", is_full ? "full" : "thumbnail"},
               {"folder", fmt::format("front/trial_{:03}", number)},
               {"drawing", drawing}};
  if (!is_full) {
    json["thumbnail"] = report_png(stripes(240, 56, number), 240);
    return json;
  }
  json["rescored"] = json["scores"];
  json["rescored_errors"] = {{kObjectives[0], 0.002}, {kObjectives[1], 0.05}};
  json["keeps_limits"] = true;
  json["probability_on_front"] = 0.8;
  json["aspect"] = report_png(stripes(650, 150, number), 700);
  json["closeups"] = {{{"label", "dent"}, {"image", report_png(stripes(41, 41, number), 41)}}};
  return json;
}

Json front_of_page(const Json& trials, std::size_t num_objectives) {
  std::vector<std::vector<double>> rows;
  for (const Json& trial : trials) {
    std::vector<double> row;
    for (std::size_t i = 0; i < num_objectives; ++i) {
      row.push_back((i < 2 ? -1.0 : 1.0) * trial["scores"][kObjectives[i]].get<double>());
    }
    rows.push_back(trial["feasible"].get<bool>() ? row : std::vector<double>{});
  }
  for (auto& row : rows) {
    row.resize(num_objectives, NAN);
  }
  Json designs = Json::array();
  for (const std::size_t k : front_of(rows)) {
    designs.push_back(member_of(trials[k], designs.size() < 12));
  }
  Json objectives = Json::array();
  for (std::size_t i = 0; i < num_objectives; ++i) {
    objectives.push_back(
        {{"score", kObjectives[i]}, {"direction", i < 2 ? "maximise" : "minimise"}});
  }
  Json history = Json::array();
  for (std::size_t k = 0; k < trials.size(); ++k) {
    history.push_back(1.0 - 1.0 / (1.0 + static_cast<double>(k)));
  }
  const int chosen = designs[designs.size() / 2]["trial"];
  return {{"objectives", objectives},
          {"designs", designs},
          {"hypervolume", 1.0},
          {"history", history},
          {"noise_history", {{500, 0.02}, {1000, 0.02}}},
          {"rescored", {{"designs", 12}, {"hypervolume", 0.97}, {"searched", 1.0}}},
          {"outside", 0},
          {"chosen", {{"trial", chosen}, {"by", "knee"}, {"reason", "nearest to the best"}}}};
}

Json design_of(const std::string& key, const Json& trial) {
  return {{"key", key},
          {"title", key},
          {"feasible", true},
          {"trial", trial["number"]},
          {"scores", trial["scores"]},
          {"rescored", trial["scores"]},
          {"variables", {{"lighting.tunnel.radius_mm", trial["values"][0]}}},
          {"aspect", report_png(stripes(650, 150, 3), 700)}};
}

Json page_data(int num_trials, std::size_t num_objectives) {
  Json trials = Json::array();
  for (int k = 1; k <= num_trials; ++k) {
    trials.push_back(trial_of(k));
  }
  Json front = front_of_page(trials, num_objectives);
  const int chosen = front["chosen"]["trial"];
  return {{"title", "Trade-off"},
          {"status", "done"},
          {"objective", {{"name", kObjectives[0]}, {"sense", "maximise"}}},
          {"constraints", {{{"name", "homogeneity.clipped_share"}, {"max", 0.01}}}},
          {"variables",
           {variable("lighting.tunnel.radius_mm", 60, 250),
            variable("lighting.tunnel.duty", 0.2, 0.8)}},
          {"designs",
           {design_of("winner", trials[static_cast<std::size_t>(chosen - 1)]),
            design_of("baseline", trials[0]),
            design_of("flat", trials[1])}},
          {"trials", trials},
          {"front", std::move(front)}};
}

/// What a script of tests/ tells of a page.
Json told_by(const std::string& script, const std::filesystem::path& page) {
  const std::string command = fmt::format("node '" GLINT_SOURCE_DIR "/tests/{}' {} '{}'",
                                          script,
                                          kBrowser,
                                          std::filesystem::absolute(page).string());
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> block{};
  for (std::size_t count = 0; (count = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
    text.append(block.data(), count);
  }
  pclose(pipe);
  return Json::parse(text, nullptr, false);
}

class FrontPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system((std::string("command -v ") + kBrowser + " >/dev/null").c_str()) != 0) {
      GTEST_SKIP() << "there is no Chromium; script/bootstrap --browser installs it";
    }
  }

  std::filesystem::path write(const Json& data) const {
    write_file(folder_ / "page.html", render_report(complete_report(data)));
    return folder_ / "page.html";
  }

  TemporaryFolder folder_;
};

/// All parts of the page show what is chosen.
void expect_chosen(const Json& shown, const Json& counts, std::size_t on_front) {
  EXPECT_GT(counts.get<int>(), 0);
  EXPECT_EQ(shown["evaluations"], counts);
  EXPECT_EQ(shown["points"]["count"], counts);
  EXPECT_EQ(shown["lines"]["count"], counts);
  EXPECT_GT(shown["points"]["pixels"], 1000);
  EXPECT_GT(shown["lines"]["pixels"], 1000);
  EXPECT_GT(shown["designs"].get<std::size_t>(), 0U);
  EXPECT_EQ(shown["designs"].get<std::size_t>() + shown["dimmed"].get<std::size_t>(), on_front);
}

TEST_F(FrontPage, FollowsAReaderInAllItsPartsWithin100MsForAThousandTrials) {
  const Json data = page_data(kTrials, 3);
  const std::filesystem::path page = write(data);
  EXPECT_LT(std::filesystem::file_size(page), 30'000'000U);
  const Json seen = told_by("studies/report/front_page.mjs", page);
  ASSERT_TRUE(seen.is_object());
  const std::size_t on_front = data["front"]["designs"].size();

  EXPECT_EQ(seen["first"]["title"],
            fmt::format("Evaluation {}", data["front"]["chosen"]["trial"].get<int>()));
  EXPECT_EQ(seen["clicked"]["title"],
            fmt::format("Evaluation {}", seen["clicked"]["wanted"].get<int>()));
  EXPECT_EQ(seen["clicked"]["pictures"], (Json{"img.frame", "img.closeup", ".drawing svg"}));
  EXPECT_NE(seen["far"]["title"], seen["clicked"]["title"]);
  EXPECT_EQ(seen["far"]["pictures"], Json::array({".no-picture"}));

  expect_chosen(seen["framed"], seen["framed"]["inside"], on_front);
  expect_chosen(seen["axis"], seen["axis"]["inside"], on_front);
  for (const char* gone : {"cleared", "unfiltered"}) {
    EXPECT_EQ(seen[gone]["evaluations"], kTrials);
    EXPECT_EQ(seen[gone]["designs"], on_front);
    EXPECT_EQ(seen[gone]["dimmed"], 0);
    EXPECT_TRUE(seen[gone]["lines"]["count"].is_null());
  }
  const auto infeasible = std::ranges::count_if(
      data["trials"], [](const Json& trial) { return !trial["feasible"].get<bool>(); });
  EXPECT_EQ(seen["filtered"]["points"]["count"], infeasible);
  EXPECT_EQ(seen["filtered"]["designs"], 0);

  const auto down = seen["sorted"]["down"].get<std::vector<double>>();
  EXPECT_EQ(down.size(), on_front);
  EXPECT_TRUE(std::ranges::is_sorted(down, std::greater<>()));
  EXPECT_TRUE(std::ranges::is_sorted(seen["sorted"]["up"].get<std::vector<double>>()));
  EXPECT_THAT(seen["set"].get<std::string>(),
              ::testing::MatchesRegex("--set lighting.tunnel.radius_mm=[0-9.]+ --set "
                                      "lighting.tunnel.duty=[0-9.]+"));

  std::printf("a brush takes %.0f ms of CPU time in all processes, %.0f ms by the clock at best\n",
              seen["cpu_ms"].get<double>(),
              seen["ms"][0].get<double>());
  EXPECT_LE(seen["cpu_ms"].get<double>(), 100.0);
}

TEST_F(FrontPage, IsPrintedOnEightPagesWithNothingOverNothing) {
  for (const std::size_t num_objectives : {std::size_t{2}, std::size_t{3}}) {
    const Json paper = told_by("cli/printed_page.mjs",
                               write(page_data(num_objectives == 2 ? 120 : 400, num_objectives)));
    ASSERT_TRUE(paper.is_object());
    EXPECT_GE(paper["pages"], 2);
    EXPECT_LE(paper["pages"], 8);
    EXPECT_GT(paper["boxes"], 100);
    EXPECT_EQ(paper["overlaps"], Json::array()) << num_objectives << " objectives";
  }
}

}  // namespace
}  // namespace glint
