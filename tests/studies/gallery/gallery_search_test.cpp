// SPDX-License-Identifier: GPL-3.0-or-later
//
// The searches of the gallery, each as its README tells it. Slow.
#include <algorithm>
#include <map>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "optimizer/storage/storage.h"
#include "studies/run/run.h"
#include "tests/studies/gallery/gallery_support.h"

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

// All twenty dents of the found depth show, and shallower ones than any prototype's.
TEST(GallerySearch, FindsHowShallowTheWorstDentMayBe) {
  const Json result = expect_winner("worst_dent");
  const Json& scores = result.at("best").at("scores");
  EXPECT_EQ(scores.at("defects.made").get<int>(), 20);
  EXPECT_GE(scores.at("defects.min_cnr").get<double>(), 3.0);
  EXPECT_LT(scores.at("defects.mean_depth_um").get<double>(), 1.5);
}

/// The usual order: the most even lighting that gives 20 dents of 2 um a CNR of 3.
const std::vector<KeyValue>& uniformity_first() {
  static const std::vector<KeyValue> sets = {{"objective.maximise", "homogeneity.h_rms"},
                                             {"constraints.\"homogeneity.h_rms\".min", "0"},
                                             {"constraints.\"defects.min_cnr\".min", "3"},
                                             {"defects.dent.height_um", "2"},
                                             {"defects.dent.count", "20"},
                                             {"search.algorithm", "cobyla"},
                                             {"budget.evaluations", "160"}};
  return sets;
}

/// Compares the rows "<design>.<score>" with numbers that were scored again on fresh parts.
void expect_fresh(const std::string& name, const std::string& design, const Json& rescored) {
  int compared = 0;
  for (const auto& [key, row] : gallery::read_expected(name)) {
    if (key.starts_with(design + ".")) {
      EXPECT_NEAR(
          rescored.at(key.substr(design.size() + 1)).get<double>(), row.value, row.tolerance)
          << key;
      ++compared;
    }
  }
  EXPECT_GE(compared, 1);
}

// Found on fresh parts too, by more than the noise of both rates.
TEST(GallerySearch, FindsMoreDentsWhenDetectionComesFirst) {
  const Json result = expect_winner("visible_first");
  const std::string rate = "inspection.detection_rate";
  const Json& found = result.at("rescored").at("best");
  const Json& even = result.at("prototypes").at("even_first").at("rescored");
  EXPECT_GT(found.at(rate + ".low").get<double>(), even.at(rate + ".high").get<double>());
  expect_fresh("visible_first", "winner_fresh", found);
  expect_fresh("visible_first", "winner_fresh_even", even);
  expect_winner("visible_first", "winner_even_first", uniformity_first());
}

TEST(GallerySearch, FindsARingThatShowsMoreThanDomeAndBar) {
  const Json result = expect_winner("ring_geometry");
  const std::string score = "defects.min_dprime";
  const Json& scores = result.at("best").at("scores");
  EXPECT_GT(scores.at(score).get<double>() - 3.0 * scores.at(score + ".error").get<double>(),
            best_prototype(result, score));
  expect_fresh("ring_geometry", "winner_fine", result.at("rescored").at("best"));
  expect_fresh("ring_geometry", "winner_fine_baseline", result.at("rescored").at("baseline"));
}

// hidden.toml tells what real.png was made with; the study does not read it.
TEST(GallerySearch, FindsWhatAPhotographWasTakenWith) {
  const Json found = expect_winner("fit_to_real").at("best").at("variables");
  const Study hidden = load_study(gallery::folder_of("fit_to_real") / "hidden.toml", {});
  const std::map<std::string, double> tolerances = {{"material.roughness", 0.02},
                                                    {"sensor.exposure", 0.03},
                                                    {"sensor.blur_px", 0.1},
                                                    {"lighting.ring.radiance.0", 0.5},
                                                    {"part.position_mm.1", 0.05},
                                                    {"part.position_mm.2", 0.05},
                                                    {"part.rotation_deg.0", 0.2}};
  EXPECT_EQ(found.size(), tolerances.size());
  for (const auto& [name, tolerance] : tolerances) {
    EXPECT_NEAR(found.at(name).get<double>(), hidden.root.at_path(name)->number, tolerance) << name;
  }
}

TEST(GallerySearch, FindsATunnelForThePartOfTheGallery) {
  const Json result = expect_winner("my_part");
  const double found = result.at("rescored").at("best").at("homogeneity.h_rms").get<double>();
  EXPECT_GT(found, best_prototype(result, "homogeneity.h_rms") + 0.1);
}

/// The most visible design of a front that is at most so wide and at least 65 % even.
const Json* most_visible(const Json& front, double width_mm) {
  const Json* best = nullptr;
  for (const Json& design : front) {
    const Json& scores = design.at("scores");
    const bool is_allowed = scores.at("lighting.width_mm").get<double>() <= width_mm &&
                            scores.at("homogeneity.h_rms").get<double>() >= 0.65;
    if (is_allowed && (best == nullptr || scores.at("defects.min_cnr").get<double>() >
                                              best->at("scores").at("defects.min_cnr"))) {
      best = &design;
    }
  }
  return best;
}

TEST(GallerySearch, FindsWhatASmallerTunnelCosts) {
  const Json result = expect_winner("tunnel_tradeoff");
  const gallery::ExpectedScores expected = gallery::read_expected("tunnel_tradeoff");
  int compared = 0;
  double visible = 0.0;
  for (const int width_mm : {200, 250, 300, 400}) {
    const Json* design = most_visible(result.at("front"), width_mm);
    ASSERT_NE(design, nullptr) << width_mm;
    const std::string name = fmt::format("front_{}.", width_mm);
    for (const auto& [key, row] : expected) {
      if (key.starts_with(name)) {
        const std::string what = key.substr(name.size());
        const Json& scores = design->at("scores");
        const Json& from = scores.contains(what) ? scores : design->at("variables");
        EXPECT_NEAR(from.at(what).get<double>(), row.value, row.tolerance) << key;
        ++compared;
      }
    }
    const double cnr = design->at("scores").at("defects.min_cnr").get<double>();
    EXPECT_GE(cnr, visible) << "more room shows no less";
    visible = cnr;
  }
  EXPECT_EQ(compared, 20);
  EXPECT_EQ(most_visible(result.at("front"), 130.0), nullptr);
  const gallery::Expected volume = expected.at("front_all.hypervolume");
  EXPECT_NEAR(result.at("hypervolume").get<double>(), volume.value, volume.tolerance);
  // As wide as the prototype of half the size, and clearer.
  const Json& half = result.at("prototypes").at("half").at("scores");
  EXPECT_GT(most_visible(result["front"], 200.0)->at("scores").at("defects.min_cnr").get<double>(),
            1.2 * half.at("defects.min_cnr").get<double>());
}

/// Best feasible objective after each evaluation; 0 before the first feasible one.
std::vector<double> best_so_far(const std::string& name, const std::vector<KeyValue>& sets = {}) {
  const auto out =
      std::filesystem::temp_directory_path() / fmt::format("glint_curve_{}", ::getpid());
  std::filesystem::remove_all(out);
  const Study study = load_study(gallery::folder_of(name) / "study.toml", sets);
  run_study(study, {.out = out, .threads = 2, .jobs = 2, .progress = Progress::Style::kNone});
  std::vector<double> curve;
  double best = 0.0;
  for (const Trial& trial : Storage::read(out / "study.sqlite").trials(TrialKind::kSearch)) {
    if (!trial.outcome) {
      continue;  // asked within the last batch, beyond the budget
    }
    if (!trial.outcome->is_failed && is_feasible(study.goal, trial.outcome->scores)) {
      best = std::max(best, trial.outcome->scores.at(study.goal.objective.name));
    }
    curve.push_back(best);
  }
  std::filesystem::remove_all(out);
  return curve;
}

/// Evaluations until the curve is there; 0: never.
int evaluations_to(const std::vector<double>& curve, double goal) {
  const auto there = std::ranges::lower_bound(curve, goal);
  return there == curve.end() ? 0 : static_cast<int>(there - curve.begin()) + 1;
}

/// The gallery's own rows about a search: its best and how many evaluations it needed.
void expect_search(const std::string& search, const std::vector<double>& curve, double goal) {
  const gallery::ExpectedScores expected = gallery::read_expected("gradient_tunnel");
  const gallery::Expected best = expected.at(search + ".homogeneity.h_rms");
  EXPECT_NEAR(curve.back(), best.value, best.tolerance) << search;
  const auto needed = expected.find(search + ".evaluations");
  if (needed == expected.end()) {
    EXPECT_EQ(evaluations_to(curve, goal), 0) << search;
  } else {
    EXPECT_NEAR(evaluations_to(curve, goal), needed->second.value, needed->second.tolerance)
        << search;
  }
}

TEST(GallerySearch, FindsTheTunnelByItsGradient) {
  const Json result = expect_winner("gradient_tunnel");
  EXPECT_GE(result.at("best").at("scores").at("view.slot_margin_mm").get<double>(), 0.0);
}

TEST(GallerySearch, NeedsFarFewerEvaluationsWithDerivatives) {
  const std::vector<double> by_trial = best_so_far("tunnel_shape");
  ASSERT_EQ(by_trial.size(), 300);
  const double goal = by_trial.back() - 0.001;  // 0.1 point
  const std::vector<double> by_gradient = best_so_far("gradient_tunnel");
  EXPECT_GT(evaluations_to(by_gradient, goal), 0);
  EXPECT_LE(4 * evaluations_to(by_gradient, goal), evaluations_to(by_trial, goal));
  expect_search("sbplx", by_trial, goal);
  expect_search("slsqp", by_gradient, goal);
  expect_search("mma", best_so_far("gradient_tunnel", {{"search.algorithm", "mma"}}), goal);
  expect_search("lbfgs", best_so_far("gradient_tunnel", {{"search.algorithm", "lbfgs"}}), goal);
  // What the wall hides is in the derivative: the search finds back from the slot's edge.
  const std::vector<KeyValue> no_limit = {{"constraints.\"view.slot_margin_mm\".min", "-100"}};
  expect_search("no_slot_limit", best_so_far("gradient_tunnel", no_limit), goal);
}

}  // namespace
}  // namespace glint
