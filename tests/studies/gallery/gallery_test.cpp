// SPDX-License-Identifier: GPL-3.0-or-later
//
// Baseline, prototypes and variants of the gallery's studies, evaluated once each; the searches are
// in gallery_search_test.cpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "studies/evaluation/evaluation.h"
#include "studies/run/run.h"
#include "tests/studies/gallery/gallery_support.h"

namespace glint {
namespace {

using gallery::expect_printed_numbers;
using gallery::ExpectedScores;
using gallery::mesh_variant;
using gallery::Variant;
using ::testing::HasSubstr;

/// Compares the scores of one design with what expected.json has for it; returns how many.
int compare(const ExpectedScores& expected, const std::string& design, const Scores& scores) {
  int compared = 0;
  for (const auto& [name, row] : expected) {
    if (!name.starts_with(design + ".")) {
      continue;
    }
    const auto score = scores.find(name.substr(design.size() + 1));
    if (score == scores.end()) {
      ADD_FAILURE() << name << ": the design has no such score";
      continue;
    }
    EXPECT_NEAR(score->second, row.value, row.tolerance) << name;
    ++compared;
  }
  return compared;
}

/// Rows that need no search; those are in gallery_search_test.cpp.
int count_but_searches(const ExpectedScores& expected) {
  int count = 0;
  for (const auto& [name, row] : expected) {
    const bool is_of_search = std::ranges::any_of(
        std::array{"winner", "front_", "sbplx.", "slsqp.", "mma.", "lbfgs.", "no_slot_"},
        [&, key = name](const char* begin) { return key.starts_with(begin); });
    count += is_of_search ? 0 : 1;
  }
  return count;
}

/// With the trials that the study's goal asks for.
Scores promised_scores(SceneStore& store, const Study& study, const SceneSettings& scene) {
  return evaluate(store, scene, {}, wanted_by(study.goal).with_whole_scan()).scores;
}

/// The same of a design of the gallery, which is evaluated once, whichever tests ask for it.
/// @param design  "study.design"
const Scores& known_scores(SceneStore& store,
                           const std::string& design,
                           const Study& study,
                           const SceneSettings& scene) {
  static std::map<std::string, Scores> known;
  if (!known.contains(design)) {
    known[design] = promised_scores(store, study, scene);
  }
  return known.at(design);
}

Scores scores_of(SceneStore& store, const std::string& name, const Variant& variant) {
  const Study study = load_study(gallery::folder_of(name) / "study.toml", variant.sets);
  return promised_scores(store, study, study.scene);
}

/// Evaluates everything but what searches find, and wants each row of expected.json to have been
/// met.
void expect_promised_scores(const std::string& name, const std::vector<Variant>& variants) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const ExpectedScores expected = gallery::read_expected(name);
  const Study study = load_study(gallery::folder_of(name) / "study.toml", {});
  int compared =
      compare(expected, "baseline", known_scores(store, name + ".baseline", study, study.scene));
  for (const Prototype& prototype : study.prototypes) {
    const SceneSettings scene = scene_with(study, prototype.overrides);
    compared += compare(
        expected, prototype.name, known_scores(store, name + "." + prototype.name, study, scene));
  }
  for (const Variant& variant : variants) {
    compared += compare(expected, variant.design, scores_of(store, name, variant));
  }
  EXPECT_EQ(compared, count_but_searches(expected)) << "expected.json names an unknown design";
}

/// @param design  "baseline" or a prototype
Scores scores_of(const std::string& study, const std::string& design) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const Study loaded = load_study(gallery::folder_of(study) / "study.toml", {});
  const std::string name = study + "." + design;
  if (design == "baseline") {
    return known_scores(store, name, loaded, loaded.scene);
  }
  for (const Prototype& candidate : loaded.prototypes) {
    if (candidate.name == design) {
      return known_scores(store, name, loaded, scene_with(loaded, candidate.overrides));
    }
  }
  ADD_FAILURE() << study << " has no prototype " << design;
  return {};
}

const std::vector<Variant>& tunnel_variants() {
  static const std::vector<Variant> variants = {{"round_250",
                                                 {{"lighting.tunnel.shape", "semicylinder"},
                                                  {"lighting.tunnel.radius_mm", "250"},
                                                  {"lighting.tunnel.slot_mm", "25.8"}}},
                                                {"flat_cosine",
                                                 {{"lighting.tunnel.shape", "flat"},
                                                  {"lighting.tunnel.distance_mm", "36"},
                                                  {"lighting.tunnel.panel_height_mm", "410"},
                                                  {"lighting.tunnel.slot_mm", "0"},
                                                  {"lighting.tunnel.cosine_law", "true"}}}};
  return variants;
}

/// The commands of my_part/README.md.
Variant tuned(const std::string& file,
              const std::string& unit,
              const std::string& pixel_mm,
              const std::string& x_mm,
              const std::string& y_mm,
              const std::string& diameter_mm,
              const std::string& height_um,
              const std::string& tilt_deg = "15") {
  return mesh_variant(file,
                      file,
                      unit,
                      {{"camera.object_pixel_mm", pixel_mm},
                       {"part.rotation_deg", "[" + tilt_deg + ", 0, 0]"},
                       {"defects.dent.x_mm", "[" + x_mm + "]"},
                       {"defects.dent.y_mm", "[" + y_mm + "]"},
                       {"defects.dent.diameter_mm", diameter_mm},
                       {"defects.dent.height_um", height_um}});
}

std::vector<Variant> mesh_variants() {
  std::vector<Variant> variants = {
      tuned("fandisk.obj", "cm", "0.12", "0.014", "7.721", "0.72", "5.9", "30"),
      tuned("moveo_pivot_arm.stl", "mm", "0.11", "0.012", "0.693", "0.66", "5.4"),
      tuned("moveo_servo_gear.stl", "mm", "0.13", "-5.259", "0.428", "0.78", "6.4"),
      tuned("moveo_t3m1c.stl", "mm", "0.07", "0.009", "1.723", "0.42", "3.5"),
      tuned("odri_foot_structure.stl", "mm", "0.22", "4.397", "-5.876", "1.32", "10.9"),
      tuned("odri_pulley_at3_t30_output.stl", "mm", "0.065", "-7.081", "2.65", "0.39", "3.2"),
      tuned("rocker-arm.obj", "inch", "0.055", "0.006", "5.15", "0.33", "2.7", "30"),
      tuned("stanford-bunny.obj", "m", "0.38", "5.768", "9.723", "2.28", "18.8")};
  variants.back().sets.insert(variants.back().sets.end(),
                              {{"lighting.tunnel.radius_mm", "220"},
                               {"lighting.tunnel.slot_mm", "130"},
                               {"lighting.tunnel.length_mm", "1500"}});
  return variants;
}

TEST(GalleryTunnelShape, ScoresAreThePromisedOnes) {
  expect_promised_scores("tunnel_shape", tunnel_variants());
}

TEST(GalleryTunnelShape, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("tunnel_shape", 25);
}

// The published order, under both definitions of h, and the panels' layout tuned to 85.6 %.
TEST(GalleryTunnelShape, SemicylinderIsMoreEvenThanFlatPanels) {
  const Scores flat = scores_of("tunnel_shape", "flat");
  const Scores round = scores_of("tunnel_shape", "semicylinder");
  EXPECT_GT(round.at("homogeneity.h_rms"), flat.at("homogeneity.h_rms") + 0.03);
  EXPECT_GT(round.at("homogeneity.h_abs"), flat.at("homogeneity.h_abs") + 0.01);
  EXPECT_NEAR(flat.at("homogeneity.h_abs"), 0.856, 0.005);
}

TEST(GalleryGradientTunnel, ScoresAreThePromisedOnes) {
  expect_promised_scores("gradient_tunnel", {});
}

TEST(GalleryGradientTunnel, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("gradient_tunnel", 18);
}

// The same scene and search space, so that both searches can be compared.
TEST(GalleryGradientTunnel, DiffersFromTunnelShapeInSearchAndSlotLimitAlone) {
  const Study plain = load_study(gallery::folder_of("tunnel_shape") / "study.toml", {});
  const Study gradient = load_study(gallery::folder_of("gradient_tunnel") / "study.toml", {});
  EXPECT_EQ(to_toml(write_scene(gradient.scene)), to_toml(write_scene(plain.scene)));
  ASSERT_EQ(gradient.space.variables.size(), plain.space.variables.size());
  for (std::size_t i = 0; i < plain.space.variables.size(); ++i) {
    EXPECT_EQ(gradient.space.variables[i].name, plain.space.variables[i].name);
    EXPECT_EQ(gradient.space.variables[i].low, plain.space.variables[i].low);
    EXPECT_EQ(gradient.space.variables[i].high, plain.space.variables[i].high);
  }
  EXPECT_EQ(gradient.goal.objective.name, plain.goal.objective.name);
  ASSERT_EQ(gradient.goal.constraints.size(), plain.goal.constraints.size() + 1);
  EXPECT_EQ(gradient.goal.constraints.back().name, "view.slot_margin_mm");
}

TEST(GalleryTunnelTradeoff, ScoresAreThePromisedOnes) {
  expect_promised_scores("tunnel_tradeoff", {});
}

TEST(GalleryTunnelTradeoff, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("tunnel_tradeoff", 32);
}

// A semicylinder scaled down with its stripes left alone shows less of everything.
TEST(GalleryTunnelTradeoff, HalfTheSizeIsLessEvenAndShowsLess) {
  const Scores whole = scores_of("tunnel_tradeoff", "baseline");
  const Scores half = scores_of("tunnel_tradeoff", "half");
  EXPECT_EQ(whole.at("lighting.width_mm"), 2.0 * half.at("lighting.width_mm"));
  EXPECT_GT(whole.at("homogeneity.h_rms"), half.at("homogeneity.h_rms") + 0.1);
  EXPECT_GT(whole.at("defects.min_cnr"), 2.0 * half.at("defects.min_cnr"));
}

TEST(GalleryFringeDesign, ScoresAreThePromisedOnes) {
  expect_promised_scores("fringe_design", {});
}

TEST(GalleryFringeDesign, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("fringe_design", 20);
}

// Field survey 1d: period 1.3 to 2 times 2 L m = 2 x 120 mm x 0.01 = 2.4 mm, so 3.1 to 4.8 mm.
TEST(GalleryFringeDesign, ThePeriodOfTheRuleBeatsHalfAndDoubleOfIt) {
  const double rule = scores_of("fringe_design", "rule").at("defects.min_change");
  EXPECT_GT(rule, scores_of("fringe_design", "half").at("defects.min_change") + 0.1);
  EXPECT_GT(rule, scores_of("fringe_design", "double").at("defects.min_change") + 0.1);
}

// 10 x 0.75 = 7.5: half of the surface is bright in 7 pictures, half in 8, a standard deviation of
// 0.5 / 7.5 = 6.7 % at most.
TEST(GalleryFringeDesign, UnequalCountsMakeTheFlawlessSurfaceUneven) {
  const double h = scores_of("fringe_design", "uneven").at("homogeneity.h_rms");
  EXPECT_LT(h, 0.96);
  EXPECT_GT(h, 1.0 - 0.5 / 7.5 - 0.001);
}

TEST(GalleryWorstDent, ScoresAreThePromisedOnes) {
  expect_promised_scores("worst_dent", {});
}

TEST(GalleryWorstDent, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("worst_dent", 8);
}

TEST(GalleryRingGeometry, ScoresAreThePromisedOnes) {
  expect_promised_scores("ring_geometry", {});
}

TEST(GalleryRingGeometry, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("ring_geometry", 12);
}

// A dome lights every slope alike; a bar from one side does not.
TEST(GalleryRingGeometry, ABarShowsMoreThanADome) {
  const Scores dome = scores_of("ring_geometry", "dome");
  const Scores bar = scores_of("ring_geometry", "bar");
  const double errors =
      std::hypot(dome.at("defects.min_dprime.error"), bar.at("defects.min_dprime.error"));
  EXPECT_GT(bar.at("defects.min_dprime"), dome.at("defects.min_dprime") + 3.0 * errors);
}

/// The study at what its photograph was taken with.
Variant at_hidden_values() {
  Variant variant{.design = "hidden"};
  const auto file = gallery::folder_of("fit_to_real") / "hidden.toml";
  const Study hidden = load_study(file, {});
  const Study study = load_study(file.parent_path() / "study.toml", {});
  for (const Variable& variable : study.space.variables) {
    variant.sets.push_back({variable.name, shortest(hidden.root.at_path(variable.name)->number)});
  }
  return variant;
}

TEST(GalleryFitToReal, ScoresAreThePromisedOnes) {
  expect_promised_scores("fit_to_real", {at_hidden_values()});
}

TEST(GalleryFitToReal, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("fit_to_real", 8);
}

TEST(GalleryVisibleFirst, ScoresAreThePromisedOnes) {
  expect_promised_scores("visible_first", {});
}

TEST(GalleryVisibleFirst, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("visible_first", 12);
}

TEST(GalleryMyPart, ScoresAreThePromisedOnes) {
  if (!std::filesystem::exists(gallery::mesh_folder())) {
    GTEST_SKIP() << "the shared meshes are not here";
  }
  expect_promised_scores("my_part", mesh_variants());
}

TEST(GalleryMyPart, ReadmePrintsTheExpectedNumbers) {
  expect_printed_numbers("my_part", 20);
}

/// What a run of a gallery study leaves in its folder, at half the resolution.
struct SmallRun {
  explicit SmallRun(const std::string& study, std::vector<KeyValue> sets = {}) {
    sets.insert(sets.end(),
                {{"camera.width_px", "650"},
                 {"camera.height_px", "150"},
                 {"camera.object_pixel_mm", "0.3"},
                 {"budget.evaluations", "3"}});
    std::filesystem::remove_all(folder);
    run_study(load_study(gallery::folder_of(study) / "study.toml", sets),
              {.out = folder, .progress = Progress::Style::kNone});
  }

  ~SmallRun() { std::filesystem::remove_all(folder); }

  SmallRun(const SmallRun&) = delete;
  SmallRun& operator=(const SmallRun&) = delete;

  nlohmann::json read(const std::string& file) const {
    return nlohmann::json::parse(read_file(folder / file));
  }

  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("glint_small_{}", ::getpid());
};

TEST(GalleryRun, SaysHowEachDesignWasRendered) {
  const SmallRun run("tunnel_shape");
  for (const std::string design : {"baseline", "flat", "winner"}) {
    const nlohmann::json scores = run.read(design + "/scores.json");
    const nlohmann::json& rendering = scores.at("rendering");
    EXPECT_EQ(rendering.at("frames"), "integrated");
    EXPECT_EQ(rendering.at("search_form"), "table");
    EXPECT_GT(rendering.at("table_pixels"), 0);
    EXPECT_GT(rendering.at("frame_pixels"), 0);
    EXPECT_LT(std::abs(rendering.at("h_rms_difference_points").get<double>()), 1.0);
    EXPECT_THAT(scores.at("notes").dump(), HasSubstr("from a closed form"));
  }
  EXPECT_EQ(run.read("run.json").at("derivatives").size(), 0);
}

TEST(GalleryRun, SaysThatThePlainWayWasTaken) {
  const SmallRun run("tunnel_shape", {{"render.method", "sampled"}});
  EXPECT_EQ(run.read("baseline/scores.json").at("rendering"),
            nlohmann::json({{"frames", "sampled"}}));
}

TEST(GalleryRun, NamesWhatItsDerivativesLeaveOut) {
  const SmallRun run("gradient_tunnel");
  const nlohmann::json remarks = run.read("run.json").at("derivatives");
  ASSERT_GE(remarks.size(), 1);
  EXPECT_THAT(remarks.dump(), HasSubstr("are treated as constant (3 of 3 evaluations)"));
  const std::string report = read_file(run.folder / "report.html");
  const std::string line =
      "Derivatives of the search do not include: " + remarks[0].get<std::string>();
  const std::size_t first = report.find(line);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(report.find(line, first + 1), std::string::npos);
}

/// "92.0 %" or, with decimals, "0.65".
std::string printed(const std::string& study, const std::string& name, int decimals = -1) {
  const double value = gallery::read_expected(study).at(name).value;
  return decimals < 0 ? fmt::format("{:.1f} %", 100.0 * value)
                      : fmt::format("{:.{}f}", value, decimals);
}

TEST(GalleryPage, PrintsTheExpectedNumbers) {
  const std::string page =
      read_file(std::filesystem::path(GLINT_SOURCE_DIR) / "docs" / "gallery.md");
  for (const char* name : {"flat.homogeneity.h_abs",
                           "semicylinder.homogeneity.h_abs",
                           "winner.homogeneity.h_abs",
                           "winner.homogeneity.h_rms"}) {
    EXPECT_THAT(page, HasSubstr(printed("tunnel_shape", name))) << name;
  }
  for (const char* name : {"rule", "half", "double"}) {
    EXPECT_THAT(page,
                HasSubstr(printed("fringe_design", name + std::string(".defects.min_change"), 2)));
  }
  EXPECT_THAT(page,
              HasSubstr(printed("fringe_design", "winner.lighting.tunnel.period_mm", 1) + " mm"));
  for (const char* name : {"baseline.homogeneity.h_rms", "winner.homogeneity.h_rms"}) {
    EXPECT_THAT(page, HasSubstr(printed("my_part", name))) << name;
  }
  EXPECT_THAT(page, HasSubstr("CNR " + printed("tunnel_tradeoff", "front_300.defects.min_cnr", 1)));
  EXPECT_THAT(page, HasSubstr("CNR " + printed("tunnel_tradeoff", "half.defects.min_cnr", 1)));
  for (const char* name : {"slsqp", "sbplx"}) {
    const std::string needed = printed("gradient_tunnel", name + std::string(".evaluations"), 0);
    EXPECT_THAT(page, HasSubstr(needed + " evaluations")) << name;
  }
}

std::string refusal(const std::vector<KeyValue>& sets) {
  ThreadPool pool(2);
  SceneStore store(pool);
  try {
    scores_of(store, "my_part", {.design = "", .sets = sets});
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(GalleryMyPart, SaysWhatDoesNotFitTheScene) {
  EXPECT_THAT(refusal({{"lighting.tunnel.radius_mm", "40"}}), HasSubstr("smaller than the part"));
  EXPECT_THAT(refusal({{"lighting.tunnel.slot_mm", "300"}}), HasSubstr("smaller than the tunnel"));
  EXPECT_THAT(refusal({{"camera.working_distance_mm", "5"}}), HasSubstr("inside the part"));
  EXPECT_THAT(refusal({{"defects.dent.x_mm", "[70]"}}), HasSubstr("beside the part"));
}

}  // namespace
}  // namespace glint
