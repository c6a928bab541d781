// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gallery's scenes that are rendered by path tracing, at the sizes that their READMEs name.
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/image/image_io.h"
#include "studies/run/render_views.h"
#include "tests/studies/gallery/gallery_support.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// A scene of the gallery rendered into a folder that is gone afterwards.
class RenderedScene {
 public:
  RenderedScene(const std::string& name, const std::vector<KeyValue>& sets, bool has_light)
      : out_(std::filesystem::temp_directory_path() /
             fmt::format("glint_{}_{}", name, ::getpid())) {
    std::filesystem::remove_all(out_);
    result_ = render_views(
        load_study(gallery::folder_of(name) / "scene.toml", sets),
        {.out = out_, .threads = 2, .has_light = has_light, .progress = Progress::Style::kNone});
  }

  ~RenderedScene() { std::filesystem::remove_all(out_); }

  RenderedScene(const RenderedScene&) = delete;
  RenderedScene& operator=(const RenderedScene&) = delete;

  const Json& views() const { return result_.at("views"); }

  std::filesystem::path folder(std::size_t view) const {
    return out_ / views().at(view).at("folder").get<std::string>();
  }

  /// Labels of the defects that a view shows at least one pixel of.
  std::set<std::string> seen(std::size_t view) const {
    const Json json = Json::parse(read_file(folder(view) / "defects.json"));
    std::set<std::string> labels;
    for (const Json& defect : json.at("defects")) {
      if (defect.at("area_px").get<double>() >= 1.0) {
        labels.insert(defect.at("label").get<std::string>());
      }
    }
    return labels;
  }

 private:
  std::filesystem::path out_;
  Json result_;
};

void expect_row(const gallery::ExpectedScores& expected, const std::string& name, double value) {
  const auto row = expected.find(name);
  ASSERT_NE(row, expected.end()) << name;
  EXPECT_NEAR(value, row->second.value, row->second.tolerance) << name;
}

struct GreyOfPart {
  double share_of_picture = 0.0;
  double mean = 0.0;
  double clipped_share = 0.0;
};

GreyOfPart grey_of_part(const std::filesystem::path& folder) {
  const ImageF image = read_image(folder / "image.png");
  const ImageF mask = read_image(folder / "part_mask.png");
  double count = 0.0;
  GreyOfPart grey;
  for (std::size_t i = 0; i < image.size(); ++i) {
    if (mask.values()[i] > 0.5F) {
      count += 1.0;
      grey.mean += double{image.values()[i]};
      grey.clipped_share += image.values()[i] >= 1.0F ? 1.0 : 0.0;
    }
  }
  grey.share_of_picture = count / static_cast<double>(image.size());
  grey.mean /= count;
  grey.clipped_share /= count;
  return grey;
}

TEST(GalleryGearRing, ShowsTheGearAndItsDefectsAsPromised) {
  const RenderedScene scene("gear_ring",
                            {{"camera.width_px", "612"},
                             {"camera.height_px", "512"},
                             {"camera.pixel_um", "13.8"},
                             {"render.paths.samples", "16"}},
                            true);
  const auto expected = gallery::read_expected("gear_ring");
  const GreyOfPart grey = grey_of_part(scene.folder(0));
  expect_row(expected, "part.share", grey.share_of_picture);
  expect_row(expected, "part.mean_grey", grey.mean);
  expect_row(expected, "part.clipped_share", grey.clipped_share);
  expect_row(expected, "defects.seen", static_cast<double>(scene.seen(0).size()));
  const ImageF both = read_image(scene.folder(0) / "side_by_side.png");
  EXPECT_GT(both.width(), 2 * 612);
}

TEST(GalleryViewpoints, SeesEveryDefectFromSomeOfTwelvePoses) {
  const RenderedScene scene(
      "viewpoints", {{"render.paths.samples", "4"}, {"render.paths.batches", "1"}}, false);
  const auto expected = gallery::read_expected("viewpoints");
  ASSERT_EQ(scene.views().size(), 12);
  std::set<std::string> all;
  std::size_t maximum = 0;
  for (std::size_t i = 0; i < scene.views().size(); ++i) {
    const std::set<std::string> seen = scene.seen(i);
    expect_row(expected, fmt::format("view_{:02}.seen", i + 1), static_cast<double>(seen.size()));
    maximum = std::max(maximum, seen.size());
    all.insert(seen.begin(), seen.end());
  }
  expect_row(expected, "all.seen", static_cast<double>(all.size()));
  EXPECT_LT(maximum, all.size()) << "one pose would be enough";
}

}  // namespace
}  // namespace glint
