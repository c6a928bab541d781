// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/preview/preview.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A square of two triangles about (0, 0, z) that looks towards +z.
void add_square(TriangleMesh& mesh, double half_mm, double z_mm) {
  const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
  mesh.vertices_mm.insert(mesh.vertices_mm.end(),
                          {Vector3d(-half_mm, -half_mm, z_mm),
                           Vector3d(half_mm, -half_mm, z_mm),
                           Vector3d(half_mm, half_mm, z_mm),
                           Vector3d(-half_mm, half_mm, z_mm)});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// What is drawn with everything it refers to.
struct PreviewScene {
  TriangleMesh mesh;
  std::vector<std::int32_t> labels;
  SurfaceDetail detail;

  PreviewPictures draw(const PreviewView& view, int threads = 2) {
    smooth_normals(mesh, 0.5);
    const Bvh bvh(mesh);
    ThreadPool pool(threads);
    return draw_preview({.mesh = mesh, .bvh = bvh, .labels = labels, .detail = detail}, view, pool);
  }
};

double mean_of(const ImageF& image) {
  double sum = 0.0;
  for (const float value : image.values()) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(image.size());
}

/// The place at the origin that looks towards +z, in the middle of a field that wide.
PreviewView view_of_origin(const TriangleMesh& mesh, double field_mm, double height_mm = 0.0) {
  const Bvh bvh(mesh);
  const double size_mm = field_mm / 1.8;  // a round defect takes that share of its tile
  return place_view(bvh, {}, {.along_mm = size_mm, .across_mm = size_mm, .height_mm = height_mm});
}

TEST(DrawPreview, MapIsWhiteOnDefectsAndGreyBesideThePart) {
  PreviewScene scene;
  add_square(scene.mesh, 1.0, 0.0);
  scene.labels = {7, 0};
  // 4 mm of which the square takes 2: a quarter of the area, half of that defective:
  // 0.75 * 0.3 + 0.125 * 1 = 0.35.
  const PreviewPictures pictures = scene.draw(view_of_origin(scene.mesh, 4.0));
  EXPECT_NEAR(mean_of(pictures.map), 0.75 * static_cast<double>(kMapBackground) + 0.125, 1e-3);
  EXPECT_FLOAT_EQ(pictures.map(0, 0), kMapBackground);
  // The first triangle lies at +x -y: right and below.
  EXPECT_FLOAT_EQ(pictures.map(kTileSide_px / 2 + 30, kTileSide_px / 2 + 10), 1.0F);
  EXPECT_FLOAT_EQ(pictures.map(kTileSide_px / 2 - 30, kTileSide_px / 2 - 10), 0.0F);
  EXPECT_GT(pictures.image(0, 0), 0.9F);
}

TEST(DrawPreview, ShowsDefectsThatAreOnlyNormals) {
  PreviewScene scene;
  add_square(scene.mesh, 2.0, 0.0);
  const PreviewPictures flat = scene.draw(view_of_origin(scene.mesh, 2.0));
  HeightFeature dent;
  dent.id = 1;
  dent.height_mm = -0.05;
  dent.sigma_mm = 0.25;
  scene.detail = SurfaceDetail({dent});
  const PreviewPictures dented = scene.draw(view_of_origin(scene.mesh, 2.0));
  // The dent is 4 sigma = 1 mm wide in a field of 2 mm: pi / 4 * 1 / 4 of the picture.
  EXPECT_NEAR(mean_of(dented.map), 3.14159 / 16.0, 2e-3);
  const auto [low, high] = std::ranges::minmax(dented.image.values());
  const auto [flat_low, flat_high] = std::ranges::minmax(flat.image.values());
  EXPECT_LT(flat_high - flat_low, 0.02F);
  EXPECT_GT(high - low, 0.1F);
}

TEST(DrawPreview, GivesTheSameBytesForAnyNumberOfThreads) {
  PreviewScene scene;
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 40; ++i) {
    add_square(scene.mesh, rng.uniform(0.2, 1.0), rng.uniform(-1.0, 1.0));
    scene.labels.insert(scene.labels.end(), {i % 3, 0});
  }
  const PreviewView view = fitted_view(scene.mesh, {-1.0, 1.0, -1.0}, 301);
  const PreviewPictures one = scene.draw(view, 1);
  const PreviewPictures four = scene.draw(view, 4);
  EXPECT_EQ(one.image, four.image);
  EXPECT_EQ(one.map, four.map);
}

TEST(FittedView, HoldsTheWholeMeshAndLittleElse) {
  Rng rng(6, Stream::kTest, 0);
  for (int k = 0; k < 1000; ++k) {
    TriangleMesh mesh;
    for (int i = 0; i < 5; ++i) {
      const auto number = [&] { return rng.uniform(-30.0, 30.0); };
      mesh.vertices_mm.emplace_back(number(), number(), number());
    }
    mesh.triangles = {{0, 1, 2}, {2, 3, 4}};
    const PreviewView view = fitted_view(mesh, {rng.uniform(0.2, 1.0), rng.normal(), rng.normal()});
    const PinholeCamera camera(view.intrinsics);
    Vector2d low = Vector2d::Constant(1e300);
    Vector2d high = -low;
    for (const Vector3d& vertex : mesh.vertices_mm) {
      const auto pixel = camera.project(view.camera_from_world * vertex);
      ASSERT_TRUE(pixel.has_value());
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
    }
    const Vector2d size(view.intrinsics.width_px, view.intrinsics.height_px);
    EXPECT_EQ(size.maxCoeff(), kPreviewSide_px);
    EXPECT_GE(low.minCoeff(), -0.5);
    EXPECT_LE((high - size).maxCoeff(), 0.5);
    EXPECT_GE((high - low).maxCoeff(), 0.95 * kPreviewSide_px);
  }
}

TEST(AutomaticViews, SeeAPartFromOppositeSides) {
  TriangleMesh mesh;
  add_square(mesh, 10.0, 0.0);
  const auto views = automatic_views(mesh);
  ASSERT_EQ(views.size(), 2U);
  const Vector3d first = views[0].camera_from_world.rotation.row(2);
  const Vector3d second = views[1].camera_from_world.rotation.row(2);
  EXPECT_NEAR(first.dot(second), -1.0, 1e-12);
}

TEST(CameraView, KeepsTheFieldOfViewOfTheCamera) {
  CameraSettings camera;
  camera.width_px = 2048;
  camera.height_px = 512;
  const PreviewView view = camera_view(camera, default_viewpoint(camera));
  EXPECT_EQ(view.intrinsics.width_px, 1024);
  EXPECT_EQ(view.intrinsics.height_px, 256);
  EXPECT_DOUBLE_EQ(view.intrinsics.focal_px.x(), 0.5 * intrinsics_of(camera).focal_px.x());
}

TEST(PlaceView, StartsBelowWhatHangsOverThePlace) {
  PreviewScene scene;
  add_square(scene.mesh, 5.0, 0.0);
  add_square(scene.mesh, 5.0, 1.0);  // a roof
  scene.labels = {0, 0, 1, 1};
  EXPECT_EQ(mean_of(scene.draw(view_of_origin(scene.mesh, 4.0)).map), 0.0);
  // With something 1.5 mm high at the place the roof belongs to it.
  EXPECT_EQ(mean_of(scene.draw(view_of_origin(scene.mesh, 4.0, 1.5)).map), 1.0);
}

// A block beside the place, higher than the rays start: they begin inside it and leave through its
// side or top from behind.
TEST(PlaceView, CutsWhatCannotBeAvoided) {
  PreviewScene scene;
  add_square(scene.mesh, 5.0, 0.0);
  add_square(scene.mesh, 5.0, 0.02);
  std::swap(scene.mesh.triangles[2][1],
            scene.mesh.triangles[2][2]);  // looks down: seen from inside
  std::swap(scene.mesh.triangles[3][1], scene.mesh.triangles[3][2]);
  const PreviewPictures pictures = scene.draw(view_of_origin(scene.mesh, 4.0));
  // The rays start 0.12 * 4 mm + 0.01 * 4 mm over the place and meet the roof from outside, but it
  // is turned away from them.
  EXPECT_FLOAT_EQ(pictures.image(10, 10), 0.5F);
}

TEST(ContactSheet, PutsSixTilesInARowAndNumbersThem) {
  const ImageF tile(kTileSide_px, kTileSide_px, 0.5F);
  const ImageF sheet = contact_sheet(std::vector<ImageF>(7, tile), {1, 2, 3, 4, 5, 6, 0});
  const int step = kTileSide_px + 6;
  EXPECT_EQ(sheet.width(), 6 * step + 6);
  EXPECT_EQ(sheet.height(), 2 * step + 6);
  EXPECT_EQ(sheet(2, 2), 1.0F) << "paper";
  EXPECT_EQ(sheet(6, 6), 0.0F) << "behind the number";
  EXPECT_EQ(sheet(6, 6 + step), 0.5F) << "number 0 is not drawn";
  EXPECT_EQ(sheet(6 + step, 6 + step), 1.0F) << "no eighth tile";
}

}  // namespace
}  // namespace glint
