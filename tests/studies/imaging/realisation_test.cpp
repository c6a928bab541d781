// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/realisation.h"

#include <gtest/gtest.h>

#include "tests/studies/imaging/realisation_support.h"

namespace glint {
namespace {

Defect dent_of(double depth_mm, double diameter_mm) {
  return {.type = DefectType::kDent, .depth_mm = depth_mm, .diameter_mm = diameter_mm};
}

// A Gaussian dent that is small against the viewing distance: its normals are all that matters.
TEST(Realisation, NormalsShowASmallDentAsADisplacedMeshDoes) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const realisation::Difference seen = realisation::difference(store, {.depth_um = 4.0});
  EXPECT_GT(seen.contrast, 0.02);
  EXPECT_LT(seen.max_share, 0.01);
}

// A negative control: half as deep is another picture.
TEST(Realisation, AnotherDepthIsAnotherPicture) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const auto aspect = [&](double depth_um) {
    return evaluate(store,
                    realisation::dent_scene({.depth_um = depth_um}, Realisation::kDisplaced),
                    [](int, const ImageF&) {})
        .aspect;
  };
  const ImageF deep = aspect(4.0);
  const ImageF shallow = aspect(2.0);
  float largest = 0.0F;
  for (std::size_t i = 0; i < deep.size(); ++i) {
    largest = std::max(largest, std::abs(deep.values()[i] - shallow.values()[i]));
  }
  EXPECT_GT(largest, 0.01F);
}

TEST(Realisation, TheErrorOfNormalsGrowsWithSlopeAndViewingAngle) {
  const Defect flat = dent_of(2e-3, 0.8);
  const Defect steep = dent_of(20e-3, 0.8);
  EXPECT_LT(normal_error(flat, 0.0, 100.0), 1e-4);
  EXPECT_LT(normal_error(flat, 0.5, 100.0), normal_error(steep, 0.5, 100.0));
  EXPECT_LT(normal_error(steep, 0.2, 100.0), normal_error(steep, 0.9, 100.0));
  EXPECT_TRUE(std::isinf(normal_error(dent_of(0.5, 0.8), 0.8, 100.0)));
}

TEST(Realisation, AutoTakesTheCheapestThatIsGoodEnough) {
  const auto chosen = [](const Defect& defect, const DefectGroup& group, double view_rad) {
    Defect placed = defect;
    placed.place.normal = Eigen::Vector3d::UnitZ();
    return cheapest_realisation(
        placed, group, realisation::dent_scene({.view_rad = view_rad}, Realisation::kAuto));
  };
  const DefectGroup group;
  EXPECT_EQ(chosen(dent_of(4e-3, 0.8), group, 0.0), Realisation::kNormal);
  EXPECT_EQ(chosen(dent_of(4e-3, 0.8), group, 1.0), Realisation::kDisplaced);
  EXPECT_EQ(chosen(dent_of(4e-3, 0.8), {.tolerance = 0.1}, 1.0), Realisation::kNormal);
  EXPECT_EQ(chosen(dent_of(0.1, 0.8), group, 0.0), Realisation::kDisplaced);
  EXPECT_EQ(chosen(dent_of(0.6, 0.8), group, 0.0), Realisation::kImprinted);
  Defect pit = dent_of(4e-3, 0.8);
  pit.type = DefectType::kPit;
  EXPECT_EQ(chosen(pit, group, 0.0), Realisation::kImprinted);
  EXPECT_EQ(chosen(pit, {.roughness = 0.0}, 0.0), Realisation::kNormal);
  Defect stain = dent_of(0.6, 0.8);
  stain.type = DefectType::kStain;
  EXPECT_EQ(chosen(stain, group, 1.0), Realisation::kNormal);
}

}  // namespace
}  // namespace glint
