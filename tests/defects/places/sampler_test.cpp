// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/places/sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/thread_pool.h"
#include "defects/places/sample_wall.h"
#include "tests/defects/places/sampler_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

/// Every number of a defect as text.
std::string defect_bytes(const Defect& d) {
  return fmt::format("{} {} {} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a}",
                     d.label,
                     d.id,
                     d.seed,
                     d.place.centre_mm.x(),
                     d.place.centre_mm.y(),
                     d.place.centre_mm.z(),
                     d.place.u_axis.x(),
                     d.place.normal.y(),
                     d.depth_mm,
                     d.wall_mm,
                     d.diameter_mm,
                     d.length_mm,
                     d.width_mm,
                     d.angle_rad,
                     d.tilt_rad,
                     d.tilt_direction_rad);
}

double chi_square_of_equal_shares(const std::vector<int>& seen) {
  double total = 0.0;
  for (const int n : seen) {
    total += n;
  }
  const double expected = total / static_cast<double>(seen.size());
  double sum = 0.0;
  for (const int n : seen) {
    sum += (n - expected) * (n - expected) / expected;
  }
  return sum;
}

TEST(DefectSampler, EachGroupDrawsItsOwnNumber) {
  DefectGroup some = sampler_dents(0);
  some.count = {2.0, 5.0};
  const Sampled s(sampler_plate(), {{"dents", some}, {"bumps", sampler_dents(3)}});
  std::map<std::size_t, int> seen;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const auto slots = s.sampler.slots(seed);
    ++seen[slots.size() - 3];
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const std::size_t of_dents = slots.size() - 3;
      EXPECT_EQ(slots[i].id, static_cast<int>(i) + 1);
      EXPECT_EQ(slots[i].group, i < of_dents ? 0U : 1U);
      EXPECT_EQ(slots[i].number, static_cast<int>(i < of_dents ? i : i - of_dents));
    }
  }
  ASSERT_EQ(seen.size(), 4U);  // 2, 3, 4, 5: 250 times each with a standard deviation of 13.7
  for (const auto& [count, times] : seen) {
    EXPECT_NEAR(times, 250, 4 * 13.7);
    EXPECT_TRUE(count >= 2 && count <= 5);
  }
}

// Shares 3 : 1 of 4000: 3000 with a standard deviation of sqrt(4000 * 3/4 * 1/4) = 27.4.
TEST(DefectSampler, ATotalIsSharedByWeight) {
  DefectGroup heavy = sampler_dents(0);
  heavy.share = 3.0;
  const DefectGroup fixed = {.x_mm = {1.0, 2.0}, .y_mm = {0.0, 0.0}};
  const std::vector<NamedGroup> groups = {
      {"dents", heavy}, {"fixed", fixed}, {"pits", sampler_dents(7)}};
  const Sampled s(sampler_plate(), groups, {.count = 4000.0});
  std::vector<int> counts(3, 0);
  for (const DefectSlot& slot : s.sampler.slots(4)) {
    ++counts[slot.group];
  }
  EXPECT_EQ(counts[1], 2);
  EXPECT_EQ(counts[0] + counts[2], 4000);
  EXPECT_NEAR(counts[0], 3000, 4 * 27.4);
}

TEST(DefectSampler, ALargerTotalOnlyAddsDefects) {
  const std::vector<NamedGroup> groups = {{"dents", sampler_dents(0)}, {"pits", sampler_dents(0)}};
  std::vector<int> before(2, 0);
  for (int total = 1; total < 40; ++total) {
    const Sampled s(sampler_plate(), groups, {.count = static_cast<double>(total)});
    std::vector<int> counts(2, 0);
    for (const DefectSlot& slot : s.sampler.slots(9)) {
      ++counts[slot.group];
    }
    EXPECT_EQ(counts[0] + counts[1], total);
    EXPECT_TRUE(counts[0] >= before[0] && counts[1] >= before[1]);
    before = counts;
  }
}

TEST(DefectSampler, ATotalThatNobodySharesIsAnError) {
  const DefectGroup fixed = {.x_mm = {1.0}, .y_mm = {0.0}};
  EXPECT_THAT(
      [&] {
        Sampled(sampler_plate(), {{"dents", fixed}}, {.count = 5.0});
      },
      ThrowsMessage<ConfigError>(StartsWith("imprint.count: no group")));
}

// The z of a uniform point of a sphere is uniform (Archimedes): 20 slices of equal height; 19
// degrees of freedom exceed 43.8 once in 1000. Slices of equal angle would be told.
TEST(DefectSampler, PlacesAreUniformOverASphere) {
  const PartSettings ball = {
      .shape = PartSettings::Shape::kSphereCap, .radius_mm = 20.0, .height_mm = 40.0};
  const Sampled s(posed_part(ball), {{"dents", sampler_dents(1)}});
  std::vector<int> by_height(20, 0);
  std::vector<int> by_angle(20, 0);
  const auto cell = [](double share) {
    return static_cast<std::size_t>(std::clamp(20.0 * share, 0.0, 19.0));
  };
  for (int i = 0; i < 20000; ++i) {
    const auto drawn = s.draw(1, i);
    const double z = s.in_part(*drawn.defect).z() / 20.0;
    EXPECT_LE(std::abs(z), 1.0 + 1e-9);
    ++by_height[cell(0.5 + 0.5 * z)];
    ++by_angle[cell(std::acos(std::clamp(z, -1.0, 1.0)) / kPi)];
  }
  EXPECT_LT(chi_square_of_equal_shares(by_height), 43.8);
  EXPECT_GT(chi_square_of_equal_shares(by_angle), 1000.0);
}

// A cylinder of radius 10 mm, 80 mm long: its ends are 2 pi r^2 of 2 pi r (r + l), one in 9. Of
// 5000 that is 555.6 with a standard deviation of 22.2.
TEST(DefectSampler, ACylindersEndsGetTheShareOfTheirArea) {
  const PartSettings cylinder = {
      .shape = PartSettings::Shape::kCylinder, .length_mm = 80.0, .radius_mm = 10.0};
  const Sampled s(posed_part(cylinder), {{"dents", sampler_dents(1)}});
  int at_ends = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = s.in_part(*s.draw(2, i).defect);
    const bool is_end = std::abs(std::abs(p.x()) - 40.0) < 1e-9;
    EXPECT_TRUE(is_end || std::abs(std::hypot(p.y(), p.z()) - 10.0) < 1e-9);
    at_ends += is_end ? 1 : 0;
  }
  EXPECT_NEAR(at_ends, 5000.0 / 9.0, 4 * 22.2);
}

TEST(DefectSampler, NumbersLieInTheirRangesAndFillThem) {
  DefectGroup group = sampler_dents(1);
  group.type = DefectType::kScratch;
  group.height_mm = {0.01, 0.03};
  group.length_mm = {2.0, 5.0};
  group.width_mm = {0.2, 0.4};
  group.angle_rad = {-1.0, 2.0};
  group.tilt_rad = {0.1, 0.2};
  const Sampled s(posed_part(sampler_plate()), {{"scratches", group}});
  const std::vector<Interval> ranges = {group.height_mm,
                                        group.length_mm,
                                        group.width_mm,
                                        group.angle_rad,
                                        group.tilt_rad,
                                        {0.0, 2.0 * kPi}};
  std::vector<double> sums(ranges.size(), 0.0);
  for (int i = 0; i < 2000; ++i) {
    const Defect d = *s.draw(3, i).defect;
    const std::vector<double> drawn = {
        d.wanted_depth_mm, d.length_mm, d.width_mm, d.angle_rad, d.tilt_rad, d.tilt_direction_rad};
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const double share = (drawn[k] - ranges[k].min) / (ranges[k].max - ranges[k].min);
      EXPECT_TRUE(share >= 0.0 && share <= 1.0);
      sums[k] += share / 2000.0;
    }
    EXPECT_EQ(d.diameter_mm, 0.0);
    EXPECT_EQ(d.tool, "scratch");
  }
  for (const double mean : sums) {  // 1/2 with a standard deviation of sqrt(1/12/2000) = 0.00645
    EXPECT_NEAR(mean, 0.5, 4 * 0.00645);
  }
}

TEST(DefectSampler, TheFrameStandsOnTheSurfaceAndTurnsByTheAngle) {
  DefectGroup group = sampler_dents(1);
  group.angle_rad = 0.6;
  group.region.facing_rad = 0.1;
  const Sampled s(posed_part(sampler_plate()), {{"dents", group}});
  const Eigen::Matrix3d& rotation = s.part.scene_from_part.rotation;
  for (int i = 0; i < 1000; ++i) {
    const SurfacePlace place = s.draw(5, i).defect->place;
    EXPECT_LT((place.normal - rotation.col(2)).norm(), 1e-12);
    const Vector3d along = std::cos(0.6) * rotation.col(0) + std::sin(0.6) * rotation.col(1);
    EXPECT_LT((place.u_axis - along).norm(), 1e-12);
    EXPECT_LT((place.normal.cross(place.u_axis) - place.v_axis).norm(), 1e-12);
  }
}

TEST(DefectSampler, EveryOrderAndThreadGivesTheSameBytes) {
  DefectGroup group = sampler_dents(300);
  group.diameter_mm = {0.2, 1.0};
  const Sampled s(posed_part(sampler_plate()), {{"dents", group}, {"pits", group}});
  const auto slots = s.sampler.slots(6);
  std::vector<std::string> forwards;
  for (const DefectSlot& slot : slots) {
    forwards.push_back(defect_bytes(*s.sampler.draw(6, slot, 0, {}).defect));
  }
  for (std::size_t i = slots.size(); i-- > 0;) {
    EXPECT_EQ(defect_bytes(*s.sampler.draw(6, slots[i], 0, {}).defect), forwards[i]);
  }
  ThreadPool pool(4);
  const auto threaded =
      pool.map<std::string>(static_cast<std::int64_t>(slots.size()), [&](std::int64_t i) {
        return defect_bytes(*s.sampler.draw(6, slots[static_cast<std::size_t>(i)], 0, {}).defect);
      });
  EXPECT_EQ(threaded, forwards);
  EXPECT_NE(defect_bytes(*s.sampler.draw(7, slots[0], 0, {}).defect), forwards[0]);
  EXPECT_NE(defect_bytes(*s.sampler.draw(6, slots[0], 1, {}).defect), forwards[0]);
  std::set<std::uint64_t> seeds;
  for (const DefectSlot& slot : slots) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      seeds.insert(s.sampler.draw(6, slot, attempt, {}).defect->seed);
    }
  }
  EXPECT_EQ(seeds.size(), 3 * slots.size());
}

// With the first defect refused, moved away or missing, all others are what they were.
TEST(DefectSampler, ARefusedDefectDoesNotMoveTheOthers) {
  DefectGroup group = sampler_dents(60);
  group.min_distance_mm = 0.5;
  const Sampled s(sampler_plate(), {{"dents", group}});
  const auto slots = s.sampler.slots(8);
  const Defect second = *s.sampler.draw(8, slots[1], 0, {}).defect;
  Defect blocker = second;
  blocker.label = "blocker_1";
  const auto refused = s.sampler.draw(8, slots[1], 0, std::vector{blocker});
  EXPECT_FALSE(refused.defect.has_value());
  EXPECT_EQ(refused.reason, "nearer than 0.5 mm to another defect");
  EXPECT_EQ(refused.refused.seed, second.seed) << "what was refused is told";
  const auto again = s.sampler.draw(8, slots[1], 1, std::vector{blocker});
  ASSERT_TRUE(again.defect.has_value());
  EXPECT_NE(again.defect->seed, second.seed);
  for (std::size_t i = 2; i < slots.size(); ++i) {
    const auto with = s.sampler.draw(8, slots[i], 0, std::vector{blocker, *again.defect});
    const auto without = s.sampler.draw(8, slots[i], 0, {});
    if (with.defect) {
      EXPECT_EQ(defect_bytes(*with.defect), defect_bytes(*without.defect));
    }
  }
}

// A group more at the beginning of the file changes ids and nothing else.
TEST(DefectSampler, AnotherGroupDoesNotMoveTheOthers) {
  const Sampled alone(sampler_plate(), {{"dents", sampler_dents(5)}});
  const Sampled with(sampler_plate(), {{"bumps", sampler_dents(5)}, {"dents", sampler_dents(5)}});
  for (int i = 0; i < 5; ++i) {
    const DefectSlot slot = with.sampler.slots(2)[static_cast<std::size_t>(5 + i)];
    EXPECT_EQ(slot.id, 6 + i);
    Defect moved = *with.sampler.draw(2, slot, 0, {}).defect;
    EXPECT_EQ(moved.id, 6 + i);
    moved.id = 1 + i;
    EXPECT_EQ(defect_bytes(*alone.draw(2, i).defect), defect_bytes(moved));
    EXPECT_NE(alone.draw(2, i).defect->seed, with.draw(2, i).defect->seed);
  }
}

TEST(DefectSampler, FixedPlacesAreSeenFromAbove) {
  const DefectGroup group = {.x_mm = {5.0, -7.0}, .y_mm = {1.0, 2.0}, .diameter_mm = 0.8};
  const Sampled s(posed_part(sampler_plate()), {{"pits", group}});
  ASSERT_EQ(s.sampler.slots(0).size(), 2U);
  for (int attempt = 0; attempt < 5; ++attempt) {
    const Defect second = *s.draw(0, 1, attempt).defect;
    EXPECT_EQ(second.label, "pits_2");
    EXPECT_LT((s.in_part(second) - Vector3d(-7.0, 2.0, 1.0)).norm(), 1e-5);
    EXPECT_EQ(second.off_surface_mm, 0.0);
  }
}

// 0.4 mm over the side x = 30 mm of the plate.
TEST(DefectSampler, PlacesInSpaceArePutOntoTheSurface) {
  const DefectGroup group = {.at_mm = {30.4, 3.0, 0.2}};
  const Sampled s(posed_part(sampler_plate()), {{"dents", group}});
  const Defect defect = *s.draw(0, 0).defect;
  EXPECT_LT((s.in_part(defect) - Vector3d(30.0, 3.0, 0.2)).norm(), 1e-9);
  EXPECT_NEAR(defect.off_surface_mm, 0.4, 1e-9);
  EXPECT_LT((defect.place.normal - s.part.scene_from_part.rotation.col(0)).norm(), 1e-9);
}

// The diagonal is sqrt(60^2 + 40^2 + 2^2) = 72.14 mm, 1 % of it below 1 mm: up to 1 mm is allowed.
TEST(DefectSampler, PlacesBesideThePartAreErrors) {
  EXPECT_THAT(
      [] {
        Sampled(sampler_plate(), {{"dent", {.x_mm = {45.0}, .y_mm = {0.0}}}});
      },
      ThrowsMessage<ConfigError>(StartsWith("defects.dent: place 1 at x 45 mm, y 0 mm is beside "
                                            "the part; the part reaches over 60 x 40 mm; x "
                                            "28.56 mm, y 0 mm is on it")));
  EXPECT_THAT(
      [] {
        Sampled(sampler_plate(), {{"dent", {.at_mm = {0.0, 0.0, 2.01}}}});
      },
      ThrowsMessage<ConfigError>(
          StartsWith("defects.dent.at_mm: place 1 at 0, 0, 2.01 mm: coordinates off the "
                     "surface by 1.01 mm")));
  EXPECT_NO_THROW(Sampled(sampler_plate(), {{"dent", {.at_mm = {0.0, 0.0, 1.99}}}}));
}

TEST(DefectSampler, ADefectLargerThanThePartIsAnError) {
  EXPECT_THAT(
      [] {
        Sampled(sampler_plate(), {{"dents", {.diameter_mm = {1.0, 80.0}}}});
      },
      ThrowsMessage<ConfigError>(StartsWith(
          "defects.dents.diameter_mm: 80 mm is larger than the part, which is 72.14 mm")));
  EXPECT_THAT(
      [] {
        Sampled(sampler_plate(),
                {{"s", {.type = DefectType::kScratch, .diameter_mm = 500.0, .length_mm = 80.0}}});
      },
      ThrowsMessage<ConfigError>(StartsWith("defects.s.length_mm: 80 mm is larger")));
}

// The plate is 2 mm thick; half of that is 1 mm.
TEST(DefectSampler, AThinWallMakesADefectShallowerOrRefusesIt) {
  DefectGroup group = {.height_mm = 1.5};
  const Defect clamped =
      *Sampled(posed_part(sampler_plate()), {{"dents", group}}).draw(0, 0).defect;
  EXPECT_NEAR(clamped.wall_mm, 2.0, 1e-5);
  EXPECT_NEAR(clamped.depth_mm, 1.0, 1e-5);
  EXPECT_EQ(clamped.wanted_depth_mm, 1.5);
  group.when_thin = DefectGroup::Thin::kRefuse;
  const auto refused = Sampled(sampler_plate(), {{"dents", group}}).draw(0, 0);
  EXPECT_FALSE(refused.defect.has_value());
  EXPECT_EQ(refused.reason, "the wall is too thin for the depth");
  group.height_mm = 0.9;
  EXPECT_EQ(Sampled(sampler_plate(), {{"dents", group}}).draw(0, 0).defect->depth_mm, 0.9);
  group.height_mm = 1.5;
  group.type = DefectType::kBump;
  EXPECT_EQ(Sampled(sampler_plate(), {{"bumps", group}}).draw(0, 0).defect->depth_mm, 1.5);
}

TEST(DefectSampler, NoDepthTakesMoreThanItsShareOfTheWall) {
  DefectGroup group = sampler_dents(1);
  group.height_mm = {0.1, 5.0};
  group.wall_share = 0.3;
  const PartSettings gear = {.shape = PartSettings::Shape::kSpurGear,
                             .gear = {.teeth = 14, .face_width_mm = 12.0, .bore_mm = 8.0}};
  const Sampled s(posed_part(gear), {{"dents", group}});
  int clamped = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto drawn = s.draw(14, i);
    if (!drawn.defect) {
      continue;  // at a tooth's edge
    }
    const Defect& d = *drawn.defect;
    EXPECT_LE(d.depth_mm, std::min(d.wanted_depth_mm, 0.3 * d.wall_mm));
    EXPECT_LE(d.wall_mm, 40.0);  // a gear is closed: every ray comes out
    clamped += d.depth_mm < d.wanted_depth_mm ? 1 : 0;
  }
  EXPECT_GT(clamped, 100);
  EXPECT_LT(clamped, 900);
}

// A cap of radius R = 25 mm, 10 mm high, stands on a plane 15 mm from the centre. Along the normal
// the wall at an arc s from the top is R - 15 / cos(s / R): 10 mm at the top; a scratch 20 mm long
// and 0.3 mm wide ends its line at s = 9.85 mm, where it is 25 - 15 / cos(0.394) = 8.7554 mm.
TEST(DefectSampler, TheWallOfALineIsItsThinnest) {
  DefectGroup group = {
      .type = DefectType::kScratch, .height_mm = 0.1, .length_mm = 20.0, .width_mm = 0.3};
  const PartSettings cap = {
      .shape = PartSettings::Shape::kSphereCap, .radius_mm = 25.0, .height_mm = 10.0};
  const Sampled s(cap, {{"scratch", group}});
  EXPECT_NEAR(s.draw(0, 0).defect->wall_mm, 25.0 - 15.0 / std::cos(0.394), 1e-4);
  group.type = DefectType::kDent;
  EXPECT_NEAR(Sampled(cap, {{"dent", group}}).draw(0, 0).defect->wall_mm, 10.0, 1e-4);
}

TEST(WallBelow, IsInfiniteWhereNothingLiesBelow) {
  Part sheet;
  sheet.mesh.vertices_mm = {{-5.0, -5.0, 0.0}, {5.0, -5.0, 0.0}, {0.0, 5.0, 0.0}};
  sheet.mesh.triangles = {{0, 1, 2}};
  smooth_normals(sheet.mesh, 0.5);
  sheet.box_in_part_mm = bounding_box(sheet.mesh);
  const Bvh bvh(sheet.mesh);
  EXPECT_TRUE(std::isinf(wall_below(sheet, bvh, Vector3d::Zero(), Vector3d::UnitZ())));
}

}  // namespace
}  // namespace glint
