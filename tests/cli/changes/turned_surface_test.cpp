// SPDX-License-Identifier: GPL-3.0-or-later
//
// A rendered turned surface beside photographs of ball screws by others: how many times as far it
// differs from them as they do from each other, where nobody marked pitting.
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "tests/cli/program.h"
#include "tests/studies/compare/sound_region.h"

namespace glint::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kSurfaces = fs::path(GLINT_SHARED_DIR) / "data/field/bsdata";

/// Rings of a lathe 400 mm from their axis, under a dome.
constexpr const char* kTurnedSurface =
    "schema = 1\n[part]\nshape = \"plate\"\nlength_mm = 60\nwidth_mm = 30\n"
    "[material]\ntype = \"conductor\"\ncolour_srgb = [196, 199, 199]\nroughness = 0.3\n"
    "[material.lay]\nkind = \"turned\"\ncenter_mm = [0, 400, 0]\n"
    "[material.pattern]\nkind = \"concentric\"\ndensity = 0.12\ncolour = 0.3\n"
    "[camera]\nwidth_px = 1130\nheight_px = 460\nobject_pixel_mm = 0.03\n"
    "working_distance_mm = 200\n"
    "[sensor]\nblur_px = 0.8\nfull_well_e = 10000\nread_noise_e = 10\n"
    "[lighting.dome]\nmount = \"camera\"\nposition_mm = [0, 0, 200]\nradius_mm = 150\n"
    "opening_mm = 40\n[render]\nmethod = \"paths\"\n[render.paths]\nsamples = 16\n";

class TurnedSurface : public ::testing::Test {
 protected:
  /// The photographs of 1130 x 460 pixels and where they are sound.
  std::vector<fs::path> photographs() const {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(kSurfaces)) {
      if (entry.path().extension() == ".jpg" &&
          linear_values(read_picture(entry.path()).pixels).width() == 1130) {
        files.push_back(entry.path());
      }
    }
    std::ranges::sort(files);
    return files;
  }

  /// Lines of --pairs, and the masks that they name.
  void write_pairs(const std::string& simulated, const std::vector<fs::path>& files) const {
    std::string lines = "simulated,real,mask\n";
    for (const fs::path& file : files) {
      fs::path labels = file;
      labels.replace_extension(".json");
      const std::string mask = "mask_" + file.stem().string() + ".png";
      const Mask sound = sound_region(labels, 1130, 460);
      ImageF picture(1130, 460);
      std::ranges::copy(sound.values(), picture.values().begin());
      write_png(folder_ / mask, picture, PixelDepth::k8Bit);
      lines += fmt::format("{},{},{}\n", simulated, file.stem().string(), mask);
    }
    write_file(folder_ / "pairs.csv", lines);
  }

  /// The yardstick of a picture or view against photographs.
  Json yardstick_of(const fs::path& simulated, const std::vector<fs::path>& files) const {
    write_pairs(simulated.stem().string(), files);
    Arguments arguments = {"compare", simulated.string()};
    for (const fs::path& file : files) {
      arguments.push_back(file.string());
    }
    arguments.insert(arguments.end(), {"--pairs", "pairs.csv", "--quiet", "--out", "out"});
    return json_of(folder_, arguments)["yardstick"];
  }

  TemporaryFolder folder_;
};

TEST_F(TurnedSurface, IsSomeTimesAsFarFromPhotographsAsTheyAreFromEachOther) {
  if (!fs::exists(kSurfaces)) {
    GTEST_SKIP() << kSurfaces << " is not there";
  }
  const std::vector<fs::path> files = photographs();
  ASSERT_EQ(files.size(), 5U);
  write_file(folder_ / "surface.toml", kTurnedSurface);
  ASSERT_EQ(glint_in(folder_, {"render", "surface.toml", "--quiet", "--out", "surface"}).code, 0);
  const Json rendered = yardstick_of(folder_ / "surface/baseline", files);
  // A photograph that is left out is of their kind.
  const Json kind = yardstick_of(files.front(), {files.begin() + 1, files.end()});
  std::printf("rendered: %s\na photograph: %s\n", rendered.dump().c_str(), kind.dump().c_str());
  ASSERT_TRUE(rendered.is_object());
  EXPECT_EQ(rendered["pairs"], 10);
  // As docs/compare.md has them.
  EXPECT_NEAR(rendered["multiple"].get<double>(), 14.7, 0.3 * 14.7);
  EXPECT_NEAR(kind["multiple"].get<double>(), 0.7, 0.3 * 0.7);
  EXPECT_GT(rendered["low"].get<double>(), kind["high"].get<double>());
}

}  // namespace
}  // namespace glint::test
