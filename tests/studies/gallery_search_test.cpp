// SPDX-License-Identifier: GPL-3.0-or-later
//
// The searches of the gallery, each as its README tells it. Slow.
#include <gtest/gtest.h>
#include <unistd.h>

#include "studies/run.h"
#include "tests/studies/gallery_support.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json run_gallery(const std::string& name, const std::vector<KeyValue>& sets) {
  const auto out =
      std::filesystem::temp_directory_path() / fmt::format("glint_gallery_{}", ::getpid());
  std::filesystem::remove_all(out);
  const Study study = load_study(gallery::folder_of(name) / "study.toml", sets);
  Json result =
      run_study(study, {.out = out, .threads = 2, .jobs = 2, .progress = Progress::Style::kNone});
  std::filesystem::remove_all(out);
  return result;
}

/// Compares scores and variables of the winner with the rows "<design>.<name>"; returns the result.
Json expect_winner(const std::string& name,
                   const std::string& design = "winner",
                   const std::vector<KeyValue>& sets = {}) {
  Json result = run_gallery(name, sets);
  EXPECT_EQ(result.at("status"), "done");
  int compared = 0;
  for (const auto& [key, row] : gallery::read_expected(name)) {
    if (!key.starts_with(design + ".")) {
      continue;
    }
    const std::string what = key.substr(design.size() + 1);
    const Json& best = result.at("best");
    const Json& from = best.at("variables").contains(what) ? best["variables"] : best["scores"];
    EXPECT_NEAR(from.at(what).get<double>(), row.value, row.tolerance) << key;
    ++compared;
  }
  EXPECT_GE(compared, 3);
  return result;
}

double best_prototype(const Json& result, const std::string& score) {
  double best = -1e9;
  for (const auto& [name, prototype] : result.at("prototypes").items()) {
    best = std::max(best, prototype.at("scores").at(score).get<double>());
  }
  return best;
}

TEST(GallerySearch, FindsAMoreEvenTunnelThanThePrototypes) {
  const Json result = expect_winner("tunnel_shape");
  const double found = result.at("rescored").at("best").at("homogeneity.h_rms").get<double>();
  EXPECT_GT(found, best_prototype(result, "homogeneity.h_rms") + 0.03);
}

TEST(GallerySearch, FindsThePeriodThatTheRuleGives) {
  const Json result = expect_winner("fringe_design");
  const double found = result.at("best").at("scores").at("defects.min_change").get<double>();
  EXPECT_GT(found, best_prototype(result, "defects.min_change"));
  expect_winner("fringe_design", "winner_5_mrad", {{"defects.dent.height_um", "1.649"}});
  expect_winner("fringe_design", "winner_20_mrad", {{"defects.dent.height_um", "6.595"}});
}

TEST(GallerySearch, FindsATunnelForThePartOfTheGallery) {
  const Json result = expect_winner("my_part");
  const double found = result.at("rescored").at("best").at("homogeneity.h_rms").get<double>();
  EXPECT_GT(found, best_prototype(result, "homogeneity.h_rms") + 0.1);
}

}  // namespace
}  // namespace glint
