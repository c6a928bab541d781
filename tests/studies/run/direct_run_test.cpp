// SPDX-License-Identifier: GPL-3.0-or-later
//
// render.method = "direct" in `glint check`, `glint run` and `glint render`.
#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/run/check_study.h"
#include "studies/run/render_files.h"
#include "studies/run/run.h"
#include "studies/run/study_search.h"
#include "tests/studies/imaging/direct/lamp_scene.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/page_data.h"
#include "tests/support/temporary_folder.h"

namespace glint::lamp_test {
namespace {
namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

std::string direct_study(const std::string& lights) {
  return "schema = 1\n" + kSteel + "alpha = [0.2]\n" + kPlate + kDirect + lights;
}

std::string check_error(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", text);
  ThreadPool pool(2);
  SceneStore store(pool);
  try {
    check_everything(store, load_study(folder / "study.toml", {}));
    return "";
  } catch (const ConfigError& error) {
    return error.what();
  }
}

// Before a search begins, not after it.
TEST(DirectRun, IsRefusedAtOnceWhereLampsMayHideEachOther) {
  EXPECT_EQ(check_error(direct_study(kRing)), "");
  EXPECT_THAT(check_error(direct_study(kRing + kDome)),
              ContainsRegex("study.toml:[0-9]+:[0-9]+: lighting.ring: may be hidden"));
}

// One bar before the other.
TEST(DirectRun, IsRefusedAtOnceWhereLampsOfAPrototypeMayHideEachOther) {
  const std::string bars = direct_study(kBar + kOtherBar);
  EXPECT_EQ(check_error(bars), "");
  EXPECT_THAT(check_error(bars + "[prototypes.near]\n\"lighting.other.position_mm.0\" = -20\n"
                                 "\"lighting.other.position_mm.1\" = 0\n"
                                 "\"lighting.other.position_mm.2\" = 33\n"),
              AllOf(HasSubstr("near"), HasSubstr("may be hidden")));
}

/// A ring of sectors that is tilted until it stands before itself.
const std::string kTiltedSectors = R"([lighting.ring]
inner_radius_mm = 2
outer_radius_mm = 6
height_mm = 10
segments = 4
separate_segments = true
[variables]
"lighting.ring.tilt_deg" = { min = 0, max = 75 }
[objective]
maximise = "homogeneity.mean"
)";

// A search that [accuracy] has rendered by sums goes on where one design's lamp hides itself.
TEST(DirectRun, FollowsPathsForADesignWhoseLampMayHideItself) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             "schema = 1\n" + kSteel + "alpha = [0.2]\n" + kPlate + kTiltedSectors);
  const Study study = load_study(folder / "study.toml", {});
  const std::vector<RenderRung> ladder = render_ladder(study.scene, {});
  const RenderRung sums = *std::ranges::find(ladder, "direct sum", &RenderRung::level);
  ThreadPool pool(2);
  SceneStore store(pool);
  const Point steep = {75.0};
  EXPECT_EQ(evaluate_candidate(store, study, steep, &sums).scores,
            evaluate_candidate(store, study, steep).scores)
      << "its own samples";
  const Point flat = {0.0};
  EXPECT_NE(evaluate_candidate(store, study, flat, &sums).scores,
            evaluate_candidate(store, study, flat).scores);
}

Json rendered(const fs::path& folder, const std::string& lights, RenderOptions options = {}) {
  return render(folder, direct_study(lights), options);
}

TEST(DirectRender, TellsNoStandardError) {
  const TemporaryFolder folder;
  rendered(folder.path(), kRing);
  const fs::path stale = folder / "out/baseline/standard_error.exr";
  EXPECT_FALSE(fs::exists(stale));
  write_file(stale, "of an earlier rendering by paths");
  const Json result = rendered(folder.path(), kRing);
  EXPECT_FALSE(fs::exists(stale));
  EXPECT_TRUE(result["views"][0]["relative_error"].is_null()) << result["views"][0].dump();
  const Json page = test::page_data(read_file(folder / "out/report.html"));
  EXPECT_EQ(page["verdict"]["sentence"], "1 view of 40 x 30 pixels by sums of direct light.");
  EXPECT_TRUE(page["rendered"]["views"][0]["relative_error"].is_null());
}

// Masks hold no light that could be hidden.
TEST(DirectRender, GivesMasksUnderAnyLamps) {
  const TemporaryFolder folder;
  const Json result = rendered(folder.path(), kRing + kDome, {.has_light = false});
  EXPECT_EQ(result["status"], "done");
  EXPECT_TRUE(fs::exists(folder / "out/baseline/mask.png"));
  EXPECT_THROW(rendered(folder.path(), kRing + kDome), ConfigError);
}

TEST(DirectRun, ShowsItsOnePictureOnce) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", direct_study(kRing));
  const Json result = run_study(load_study(folder / "study.toml", {}),
                                {.out = folder / "run",
                                 .threads = 2,
                                 .jobs = 2,
                                 .progress = Progress::Style::kNone,
                                 .log_file = {}});
  EXPECT_EQ(result["status"], "done");
  const Json page = test::page_data(read_file(folder / "run/report.html"));
  const std::string designs = page.dump();
  EXPECT_THAT(designs, HasSubstr("\"frames\":[\"iVBOR"));
  EXPECT_THAT(designs, Not(HasSubstr("\"aspect\":\"iVBOR")));
}

/// A film of ten samples a pixel, of which one shows the defect in each of so many pixels.
Film film_with_tenths(int pixels) {
  Film film;
  film.width_px = 12;
  film.height_px = 1;
  film.samples = Image<std::int32_t>(12, 1, 10);
  DefectSums defect;
  defect.samples = Image<std::uint16_t>(12, 1);
  for (int x = 0; x < pixels; ++x) {
    defect.samples(x, 0) = 1;
  }
  film.defects.push_back(defect);
  return film;
}

TEST(SeenDefects, AreThoseOfTenTenthsOfAPixel) {
  const Film ten = film_with_tenths(10);
  EXPECT_LT(area_px(ten, ten.defects[0]), 1.0) << "else nothing is tested";
  EXPECT_TRUE(is_seen(ten, ten.defects[0]));
  const Film nine = film_with_tenths(9);
  EXPECT_FALSE(is_seen(nine, nine.defects[0]));
}

}  // namespace
}  // namespace glint::lamp_test
