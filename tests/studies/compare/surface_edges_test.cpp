// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface_edges.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/file.h"
#include "core/image/exr_layers.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 160;

constexpr const char* kScene = R"(schema = 1
[part]
shape = "plate"
[camera]
width_px = 200
height_px = 160
pixel_um = 10
focal_mm = 100
object_pixel_mm = 0
working_distance_mm = 1000
[lens]
focus_mm = 1000
[[viewpoint]]
position_mm = [10, 8, 1000]
direction = [0, 0, -1]
up = [0, 1, 0]
[lighting.dome]
radius_mm = 250
radiance = [0.5]
)";

/// A plane z = 0 that reaches to x < end_px, seen from 1000 mm. The lens of 100 mm has its picture
/// 111.1 mm behind it: 0.09 mm a pixel.
class SurfaceEdges : public CompareFiles {
 protected:
  ListedEdges edges(const ImageF& simulated, const ImageF& real, int end_px) const {
    write_file(folder() / "scene.toml", kScene);
    write_geometry(end_px);
    const CompareSource first = {.name = "s",
                                 .picture = write("s.png", simulated),
                                 .geometry = folder() / "geometry.exr",
                                 .scene = folder() / "scene.toml"};
    return surface_edges(
        compare_pair({.simulated = first, .real = {.name = "r", .picture = write("r.png", real)}},
                     {.outline = OutlineChoice::kThreshold}));
  }

 private:
  void write_geometry(int end_px) const {
    constexpr std::array<const char*, 7> kNames = {"position_mm.x",
                                                   "position_mm.y",
                                                   "position_mm.z",
                                                   "normal.x",
                                                   "normal.y",
                                                   "normal.z",
                                                   "depth_mm"};
    std::vector<ImageF> images(kNames.size(), ImageF(kWidth, kHeight));
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < end_px; ++x) {
        images[0](x, y) = 0.09F * (static_cast<float>(x) + 0.5F);
        images[1](x, y) = 0.09F * (static_cast<float>(y) + 0.5F);
        images[5](x, y) = 1.0F;
        images[6](x, y) = 1000.0F;
      }
    }
    std::vector<ExrChannel> channels;
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      channels.push_back(exr_channel(kNames[k], images[k]));
    }
    write_exr_channels(folder() / "geometry.exr", kWidth, kHeight, channels);
  }
};

/// Bright to the left of a line.
ImageF lit_to(double edge_px, std::uint64_t index) {
  ImageF picture = drawn(kWidth, kHeight, [=](double x, double) {
    return 0.05 + 0.5 * 0.5 * std::erfc((x - edge_px) / 1.2);
  });
  add_normal_noise(picture, 0.003, index);
  return picture;
}

// Light on a plane that ends 2 px farther right on the real one: an edge of light, not the part's.
TEST_F(SurfaceEdges, OnOneSurfaceAreEdgesOfLight) {
  const ListedEdges listed = edges(lit_to(100.0, 0), lit_to(102.0, 1), kWidth);
  ASSERT_EQ(listed.edges.size(), 1U);
  EXPECT_EQ(listed.edges[0].name, "edge of light 1");
  EXPECT_EQ(listed.edges[0].surface, "plane facing +z at z = 0.0 mm");
  EXPECT_EQ(listed.edges[0].beyond, listed.edges[0].surface);
  EXPECT_NEAR(listed.edges[0].offset_px, 2.0, 0.05);
  EXPECT_EQ(listed.unlisted.outline_share, 0.0);
}

// The same pictures of a plane that ends where the light does: its outline.
TEST_F(SurfaceEdges, WhereThePartEndsAreItsOutline) {
  const ListedEdges listed = edges(lit_to(100.0, 0), lit_to(102.0, 1), 100);
  ASSERT_EQ(listed.edges.size(), 1U);
  EXPECT_EQ(listed.edges[0].name, "outline 1");
  EXPECT_EQ(listed.edges[0].beyond, "background");
  EXPECT_NEAR(listed.edges[0].offset_mm, 0.18, 0.005);
}

}  // namespace
}  // namespace glint
