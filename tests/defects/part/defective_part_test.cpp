// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defective_part.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/defects/boolean/mesh_faults.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

PartSettings cylinder_settings() {
  return {.shape = PartSettings::Shape::kCylinder, .length_mm = 40.0, .radius_mm = 15.0};
}

/// A part with its maker, kept together.
class Workshop {
 public:
  explicit Workshop(std::vector<NamedGroup> groups,
                    const ImprintSettings& settings = {},
                    const PartSettings& part = cylinder_settings())
      : part_(std::make_shared<const Part>(build_part(part))),
        maker_(part_,
               std::make_shared<const Bvh>(part_->mesh),
               std::move(groups),
               settings,
               part.crease_rad) {}

  DefectivePart make(std::uint64_t seed = 1) const {
    return maker_.make(seed,
                       [](const Defect&, const DefectGroup&) { return Realisation::kNormal; });
  }

  const Part& part() const { return *part_; }

 private:
  std::shared_ptr<const Part> part_;
  DefectMaker maker_;
};

DefectGroup random_dents(double count, Realisation realisation) {
  DefectGroup group;
  group.realisation = realisation;
  group.count = count;
  group.height_mm = {0.1, 0.3};
  group.diameter_mm = {1.0, 2.0};
  return group;
}

DefectGroup random_scratches(double count) {
  DefectGroup group;
  group.type = DefectType::kScratch;
  group.realisation = Realisation::kImprinted;
  group.count = count;
  group.height_mm = {0.05, 0.1};
  group.length_mm = {3.0, 8.0};
  group.width_mm = {0.1, 0.3};
  group.angle_rad = {-3.0, 3.0};
  return group;
}

int num_made(const DefectivePart& part) {
  return static_cast<int>(std::ranges::count_if(part.defects, &RealisedDefect::is_made));
}

// Of facets that are the surface themselves: under an exact one they would be made finer first.
TEST(DefectMaker, ImprintsAreClosedLabelledAndTakeAwayWhatTheySay) {
  PartSettings settings = cylinder_settings();
  settings.facets_mm = kChordTolerance_mm;
  const Workshop shop(
      {{"dents", random_dents(6, Realisation::kImprinted)}, {"scratches", random_scratches(4)}},
      {},
      settings);
  const DefectivePart made = shop.make();
  ASSERT_EQ(num_made(made), 10);
  ASSERT_TRUE(made.has_own_mesh());
  EXPECT_TRUE(find_faults(made.mesh).none());
  EXPECT_EQ(made.labels.size(), made.mesh.num_triangles());
  EXPECT_EQ(made.mesh.corner_normals.size(), made.mesh.num_triangles());
  double removed_mm3 = 0.0;
  for (const RealisedDefect& defect : made.defects) {
    EXPECT_GT(defect.removed_volume_mm3, 0.0) << defect.defect.label;
    EXPECT_GT(defect.faces, 0) << defect.defect.label;
    EXPECT_EQ(std::ranges::count(made.labels, defect.defect.id), defect.faces);
    removed_mm3 += defect.removed_volume_mm3;
  }
  const double before_mm3 = enclosed_volume_mm3(shop.part().mesh);
  const double after_mm3 = enclosed_volume_mm3(made.mesh);
  EXPECT_NEAR(removed_mm3, before_mm3 - after_mm3, 1e-9 * before_mm3);
}

// Nothing is refined twice and nothing is left open where dents lie on top of each other, and a
// refused imprint leaves no finer facets behind: all there are lie beside a dent.
TEST(DefectMaker, DentsThatOverlapOnAnExactSurfaceAreClosed) {
  DefectGroup dents = random_dents(30, Realisation::kImprinted);
  dents.height_mm = {0.004, 0.05};
  dents.region.kind = DefectRegion::Kind::kSphere;
  dents.region.centre_mm = {0.0, 0.0, 15.0};
  dents.region.radius_mm = 3.0;
  const Workshop shop({{"dents", dents}});
  const DefectivePart made = shop.make();
  EXPECT_GE(num_made(made), 20);
  EXPECT_TRUE(find_faults(made.mesh).none());
}

TEST(DefectMaker, AGroupWithoutCountAndPlacesHasNoDefect) {
  DefectGroup none = random_dents(0, Realisation::kImprinted);
  none.x_mm.clear();
  none.y_mm.clear();
  const Workshop shop({{"none", none}, {"dents", random_dents(2, Realisation::kImprinted)}});
  const DefectivePart made = shop.make();
  ASSERT_EQ(made.defects.size(), 2U);
  EXPECT_EQ(made.defects[0].defect.label, "dents_1");
  EXPECT_TRUE(Workshop({{"none", none}}).make().defects.empty());
}

TEST(DefectMaker, BumpsAddMaterial) {
  DefectGroup bumps = random_dents(3, Realisation::kImprinted);
  bumps.type = DefectType::kBump;
  const Workshop shop({{"bumps", bumps}});
  const DefectivePart made = shop.make();
  ASSERT_EQ(num_made(made), 3);
  EXPECT_LT(made.defects[0].removed_volume_mm3, 0.0);
  EXPECT_GT(enclosed_volume_mm3(made.mesh), enclosed_volume_mm3(shop.part().mesh));
  EXPECT_TRUE(find_faults(made.mesh).none());
}

// Faces that no tool met still stand for the cylinder itself, faces of tools for nothing exact.
TEST(DefectMaker, FacesThatAreLeftKeepTheirExactSurface) {
  const Workshop shop({{"dents", random_dents(4, Realisation::kImprinted)}});
  const DefectivePart made = shop.make();
  for (std::size_t i = 0; i < made.mesh.num_triangles(); ++i) {
    EXPECT_EQ(made.mesh.patch_of(i) < 0, made.labels[i] > 0);
  }
}

TEST(DefectMaker, TheSameSeedGivesTheSameBytesOnAnyThread) {
  const Workshop shop(
      {{"dents", random_dents(5, Realisation::kImprinted)}, {"scratches", random_scratches(3)}});
  const DefectivePart first = shop.make(7);
  std::vector<DefectivePart> others(3);
  {
    std::vector<std::jthread> threads;
    for (DefectivePart& other : others) {
      threads.emplace_back([&] { other = shop.make(7); });
    }
  }
  for (const DefectivePart& other : others) {
    EXPECT_EQ(other.mesh.vertices_mm, first.mesh.vertices_mm);
    EXPECT_EQ(other.mesh.triangles, first.mesh.triangles);
    EXPECT_EQ(other.labels, first.labels);
  }
  EXPECT_NE(shop.make(8).mesh.vertices_mm, first.mesh.vertices_mm);
}

// The second group's defects stay where they are when the first group's are refused, here because
// they would take away less than is asked for.
TEST(DefectMaker, ADefectThatIsGivenUpDoesNotMoveTheOthers) {
  DefectGroup tiny = random_dents(3, Realisation::kImprinted);
  tiny.height_mm = 1e-3;
  tiny.diameter_mm = 0.05;
  DefectGroup dents = random_dents(4, Realisation::kImprinted);
  const ImprintSettings strict = {.max_attempts = 3, .min_removed_mm3 = 1e-3};
  const DefectivePart with = Workshop({{"tiny", tiny}, {"dents", dents}}, strict).make();
  const DefectivePart without = Workshop({{"dents", dents}}, strict).make();
  ASSERT_EQ(with.defects.size(), 7U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_FALSE(with.defects[i].is_made);
    EXPECT_EQ(with.defects[i].attempts, 3);
    EXPECT_THAT(with.defects[i].reason, StartsWith("given up after 3 samples"));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(with.defects[3 + i].defect.place.centre_mm,
              without.defects[i].defect.place.centre_mm);
    EXPECT_EQ(with.defects[3 + i].removed_volume_mm3, without.defects[i].removed_volume_mm3);
  }
}

// 60 mm from rim to rim on a part of 50 mm: the first leaves no room for the others.
TEST(DefectMaker, TellsWhatItLastDrewOfADefectWithoutRoom) {
  DefectGroup dents = random_dents(3, Realisation::kImprinted);
  dents.min_distance_mm = 60.0;
  const DefectivePart made = Workshop({{"dents", dents}}, {.max_attempts = 5}).make();
  ASSERT_EQ(num_made(made), 1);
  for (const std::size_t i : {1U, 2U}) {
    const RealisedDefect& refused = made.defects[i];
    EXPECT_EQ(
        refused.refusals,
        (std::vector<std::pair<std::string, int>>{{"nearer than 60 mm to another defect", 5}}));
    EXPECT_EQ(refused.defect.realisation, Realisation::kImprinted);
    EXPECT_EQ(refused.defect.attempt, 4);
    EXPECT_EQ(refused.defect.id, static_cast<int>(i) + 1);
    EXPECT_GE(refused.defect.diameter_mm, 1.0);
    EXPECT_GE(refused.defect.triangle, 0);
  }
}

TEST(DefectMaker, TellsHowManyVerticesCouldNotMoveAsTheNoiseAsked) {
  ImprintSettings settings;
  const auto limited = [&] {
    return Workshop({{"dents", random_dents(1, Realisation::kImprinted)}}, settings)
        .make()
        .limited_vertices;
  };
  EXPECT_EQ(limited(), 0);
  settings.processing.vertex_noise_mm = 1.0;  // the dent's triangles are smaller
  EXPECT_GT(limited(), 100);
}

TEST(DefectMaker, GivingUpCanBeAnError) {
  DefectGroup tiny = random_dents(1, Realisation::kImprinted);
  tiny.height_mm = 1e-3;
  tiny.diameter_mm = 0.05;
  const Workshop shop({{"tiny", tiny}},
                      {.max_attempts = 2, .min_removed_mm3 = 1e-3, .may_be_fewer = false});
  EXPECT_THAT([&] { shop.make(); },
              ThrowsMessage<ConfigError>(HasSubstr("imprint.may_be_fewer: is false, but tiny_1")));
}

// 4 sigma = 1 mm, 2 um deep: a plane dent takes away 2 pi sigma^2 h = 7.85e-4 mm3.
TEST(DefectMaker, OneListCanBeRealisedInThreeWays) {
  const auto make = [](Realisation realisation) {
    DefectGroup dent;
    dent.realisation = realisation;
    dent.height_mm = 2e-3;
    dent.diameter_mm = 1.0;
    dent.roughness = 0.0;
    return Workshop({{"dent", dent}},
                    {},
                    {.shape = PartSettings::Shape::kPlate, .length_mm = 30.0, .width_mm = 20.0})
        .make();
  };
  const DefectivePart normal = make(Realisation::kNormal);
  EXPECT_FALSE(normal.has_own_mesh());
  ASSERT_EQ(normal.features.size(), 1U);
  const DefectivePart displaced = make(Realisation::kDisplaced);
  EXPECT_TRUE(displaced.has_own_mesh());
  EXPECT_TRUE(displaced.features.empty());
  EXPECT_NEAR(displaced.defects[0].removed_volume_mm3, 7.854e-4, 0.01 * 7.854e-4);
  const DefectivePart imprinted = make(Realisation::kImprinted);
  EXPECT_TRUE(imprinted.has_own_mesh());
  // The cap of opening d and depth h: about pi h d^2 / 8.
  EXPECT_NEAR(imprinted.defects[0].removed_volume_mm3, 7.854e-4, 0.02 * 7.854e-4);
  for (const DefectivePart* part : {&normal, &displaced, &imprinted}) {
    ASSERT_EQ(part->outlines.size(), 1U);
    EXPECT_EQ(part->outlines[0].centre_mm, normal.outlines[0].centre_mm);
  }
}

TEST(DefectMaker, AutoAsksForEveryDefect) {
  const auto part = std::make_shared<const Part>(build_part(cylinder_settings()));
  const DefectMaker maker(part,
                          std::make_shared<const Bvh>(part->mesh),
                          {{"dents", random_dents(6, Realisation::kAuto)}},
                          {},
                          0.5);
  int asked = 0;
  const DefectivePart made = maker.make(3, [&](const Defect& defect, const DefectGroup&) {
    ++asked;
    return defect.number % 2 == 0 ? Realisation::kNormal : Realisation::kImprinted;
  });
  EXPECT_EQ(asked, 6);
  EXPECT_EQ(made.features.size(), 3U);
  EXPECT_EQ(made.defects[1].defect.realisation, Realisation::kImprinted);
  EXPECT_GT(made.defects[1].faces, 0);
  EXPECT_EQ(made.defects[0].faces, 0);
}

TEST(DefectMaker, TellsItsProgress) {
  const auto part = std::make_shared<const Part>(build_part(cylinder_settings()));
  const DefectMaker maker(part,
                          std::make_shared<const Bvh>(part->mesh),
                          {{"dents", random_dents(4, Realisation::kNormal)}},
                          {},
                          0.5);
  std::vector<int> told;
  maker.make(1, {}, [&](int done) { told.push_back(done); });
  EXPECT_EQ(told, (std::vector<int>{1, 2, 3, 4}));
}

// A hundred scratches on one small cylinder: they cross each other, and the part stays sound.
TEST(DefectMaker, ManyDefectsMayCrossEachOther) {
  const Workshop shop(
      {{"dents", random_dents(60, Realisation::kImprinted)}, {"scratches", random_scratches(60)}});
  const DefectivePart made = shop.make();
  EXPECT_GE(num_made(made), 114);
  EXPECT_TRUE(find_faults(made.mesh).none());
}

}  // namespace
}  // namespace glint
