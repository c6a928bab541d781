// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of ball screws by others: how far they differ among each other, in windows of 256 px
// beside the pitting that people marked.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/image_io.h"
#include "studies/compare/yardstick.h"
#include "tests/studies/compare/sound_region.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

const fs::path kSurfaces = fs::path(GLINT_SHARED_DIR) / "data/field/bsdata";

/// Photographs of one size belong together.
std::map<std::pair<int, int>, std::vector<TextureSample>> surfaces_by_size() {
  std::map<std::pair<int, int>, std::vector<TextureSample>> groups;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(kSurfaces)) {
    if (entry.path().extension() == ".jpg") {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    const ImageF grey = linear_values(read_picture(file).pixels);
    fs::path labels = file;
    labels.replace_extension(".json");
    const Mask region = sound_region(labels, grey.width(), grey.height());
    SurfaceTexture texture = texture_of(grey, region);
    if (texture.windows > 0 && texture.window_px == 256) {
      groups[{grey.width(), grey.height()}].push_back(
          texture_sample(file.stem().string(), grey, region, std::move(texture)));
    }
  }
  return groups;
}

// An independent computation over the same photographs found between images: grey 0.063, spectra
// 0.31 to 0.42 (rms of log10), contrasts of neighbours 0.09 to 0.22. Windows differ, so do figures.
TEST(RealSurfaces, DifferAmongEachOtherAsOthersFound) {
  if (!fs::exists(kSurfaces)) {
    GTEST_SKIP() << kSurfaces << " is not there";
  }
  std::vector<std::size_t> groups;
  for (const auto& [size, samples] : surfaces_by_size()) {
    if (samples.size() < 3) {
      continue;
    }
    groups.push_back(samples.size());
    const auto stick = measure_yardstick(samples, {});
    ASSERT_TRUE(stick.has_value());
    const std::string name = fmt::format("{}x{}_{}", size.first, size.second, samples.size());
    for (const YardstickRow& row : stick->rows) {
      RecordProperty(
          name + "_" + row.name,
          fmt::format("{:.3f} ({:.3f} to {:.3f})", row.real, row.real_low, row.real_high));
    }
    EXPECT_GT(stick->rows[0].real, 0.02);
    EXPECT_LT(stick->rows[0].real, 0.15);
    EXPECT_GT(stick->rows[1].real, 0.1);
    EXPECT_LT(stick->rows[1].real, 0.6);
    EXPECT_LT(stick->rows[2].real, 0.5);
  }
  EXPECT_THAT(groups, ::testing::UnorderedElementsAre(5U, 4U));
}

}  // namespace
}  // namespace glint
