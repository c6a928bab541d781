// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run_closeups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/output/provenance.h"
#include "studies/run/results/scene_facts.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

/// A design whose dent lies at (50, 40) and shows best in the frames told.
class DesignFolder {
 public:
  DesignFolder() {
    const Json defect = {{"label", "dent"},
                         {"height_um", -5.0},
                         {"diameter_mm", 2.0},
                         {"window_px", {40, 30, 20, 20}},
                         {"pixel_mm", 0.1},
                         {"best_frames", {{"difference", 1}, {"change", 0}}},
                         {"scores", {{"cnr", 3.0}}}};
    write_file(folder_ / "defects.json", Json{{"defects", {defect}}}.dump());
    std::filesystem::create_directories(folder_ / "sequence");
    write_png(folder_ / "sequence/frame_000.png", ImageF(100, 80, 0.2F), PixelDepth::k8Bit);
    write_png(folder_ / "sequence/frame_001.png", ImageF(100, 80, 0.4F), PixelDepth::k8Bit);
  }

  Json closeup(const std::string& objective) const {
    ImageF aspect(100, 80, 0.5F);
    for (int x = 0; x < 100; ++x) {
      aspect(x, 40) = 0.9F;  // one row of the 41 of a close-up: more than the share left aside
    }
    return closeups_of(folder_.path(), aspect, objective).at(0);
  }

 private:
  TemporaryFolder folder_;
};

TEST(Closeups, ShowTheFrameThatDecidesAboutTheObjective) {
  const DesignFolder design;
  EXPECT_EQ(design.closeup("defects.min_best_frame")["picture"], "image 2");
  EXPECT_NEAR(design.closeup("defects.min_best_frame")["low"].get<double>(), 0.4, 0.003);
  EXPECT_EQ(design.closeup("defects.min_change")["picture"], "image 1");
  EXPECT_EQ(design.closeup("defects.dent.union")["picture"], "image 1");
  EXPECT_EQ(design.closeup("homogeneity.h_rms")["picture"], "mean image");
  EXPECT_EQ(design.closeup("")["picture"], "mean image");
}

TEST(Closeups, TellWhatIsBlackAndWhiteAndHowLargeAPixelIs) {
  const Json closeup = DesignFolder().closeup("defects.min_cnr");
  EXPECT_NEAR(closeup["low"].get<double>(), 0.5, 1e-6);
  EXPECT_NEAR(closeup["high"].get<double>(), 0.9, 1e-6);
  EXPECT_EQ(closeup["size_px"], Json({41, 41}));
  EXPECT_EQ(closeup["pixel_mm"], 0.1);
  EXPECT_EQ(closeup["size"], "2 mm wide, 5 \u00b5m deep");
}

TEST(Closeups, OfAFileThatWasCutShortNameIt) {
  const TemporaryFolder folder;
  write_file(folder / "defects.json", R"({"defects": [{"label": "de)");
  const auto closeups = [&] { closeups_of(folder.path(), ImageF(8, 8), "defects.min_cnr"); };
  EXPECT_THAT(text_thrown_by<IoError>(closeups), HasSubstr("defects.json: is damaged"));
  const auto widths = [&] { defect_widths(folder.path()); };
  EXPECT_THAT(text_thrown_by<IoError>(widths), HasSubstr("defects.json: is damaged"));
}

TEST(DefectSize, IsToldForLinesSpotsAndStains) {
  EXPECT_EQ(defect_size_text({{"height_um", -12.34}, {"length_mm", 5.0}, {"width_mm", 0.2}}),
            "5 mm long, 0.2 mm wide, 12.3 \u00b5m deep");
  EXPECT_EQ(defect_size_text({{"height_um", 0.5}, {"diameter_mm", 1.5}}),
            "1.5 mm wide, 0.5 \u00b5m high");
  EXPECT_EQ(defect_size_text({{"height_um", 0.0}, {"diameter_mm", 3.0}}), "3 mm wide");
}

TEST(Duration, IsToldAsAPersonSaysIt) {
  EXPECT_EQ(duration_words(0.2), "1 s");
  EXPECT_EQ(duration_words(59.6), "1 min 0 s");
  EXPECT_EQ(duration_words(67.0), "1 min 7 s");
  EXPECT_EQ(duration_words(7500.0), "2 h 5 min");
  EXPECT_EQ(utc_text(std::chrono::system_clock::time_point{}), "1970-01-01 00:00:00 UTC");
}

}  // namespace
}  // namespace glint
