// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compare_sources.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class PlanComparison : public CompareFiles {
 protected:
  void add(const std::string& name) { write(name, ImageF(4, 3, 0.5F)); }

  /// A folder as `glint render` leaves it.
  void add_view(const std::string& name) {
    add(name + "/image.png");
    add(name + "/part_mask.png");
    write_file(folder() / name / "scene.toml", "schema = 1\n");
  }
};

TEST_F(PlanComparison, TakesViewsOfRunsByTheirNames) {
  for (const char* name : {"a/view_01", "a/view_02", "b/view_02", "b/view_01"}) {
    add_view(name);
  }
  const ComparePlan plan =
      plan_comparison({.simulated = folder() / "a", .reals = {folder() / "b"}});
  ASSERT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.pairs[1].simulated.name, "view_02");
  EXPECT_EQ(plan.pairs[1].real.picture, folder() / "b/view_02/image.png");
  EXPECT_TRUE(plan.pairs[1].simulated.is_rendered());
  EXPECT_EQ(plan.pairs[1].simulated.mask, folder() / "a/view_02/part_mask.png");
  EXPECT_TRUE(plan.notes.empty());
}

TEST_F(PlanComparison, TakesOneViewWithEveryPhotograph) {
  add_view("a");
  add("photos/p2.png");
  add("photos/p10.png");
  const ComparePlan plan =
      plan_comparison({.simulated = folder() / "a", .reals = {folder() / "photos"}});
  ASSERT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.pairs[0].real.name, "p2");  // natural order
  EXPECT_EQ(plan.pairs[1].real.name, "p10");
  EXPECT_FALSE(plan.pairs[0].real.is_rendered());
}

TEST_F(PlanComparison, PairsEqualNumbersByOrderAndSaysSo) {
  add("a/one.png");
  add("a/two.png");
  add("b/img1.png");
  add("b/img2.png");
  const ComparePlan plan =
      plan_comparison({.simulated = folder() / "a", .reals = {folder() / "b"}});
  ASSERT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.pairs[0].simulated.name, "one");
  EXPECT_EQ(plan.pairs[0].real.name, "img1");
  EXPECT_EQ(plan.notes.size(), 1U);
}

TEST_F(PlanComparison, PutsOnePhotographBesideEachDesignOfARun) {
  for (const char* design : {"baseline", "winner"}) {
    add(std::string("run/") + design + "/aspect.png");
    write_file(folder() / "run" / design / "scene.toml", "schema = 1\n");
  }
  add("photo.png");
  const ComparePlan plan =
      plan_comparison({.simulated = folder() / "run", .reals = {folder() / "photo.png"}});
  ASSERT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.pairs[1].simulated.name, "winner");
  EXPECT_EQ(plan.pairs[1].real.name, "photo");
  EXPECT_EQ(plan.notes.size(), 1U);
}

TEST_F(PlanComparison, NamesThePictureWithoutAPartner) {
  add("a/one.png");
  add("a/two.png");
  add("b/one.png");
  EXPECT_THAT([&] { plan_comparison({.simulated = folder() / "a", .reals = {folder() / "b"}}); },
              ThrowsMessage<ConfigError>(HasSubstr("two.png: has no real picture")));
}

TEST_F(PlanComparison, FollowsACsvFile) {
  add("a/one.png");
  add("a/two.png");
  add("b/x.png");
  write_file(folder() / "pairs.csv", "simulated,real\ntwo,x\none,x.png\n");
  const CompareInputs inputs = {
      .simulated = folder() / "a", .reals = {folder() / "b"}, .pairs = folder() / "pairs.csv"};
  const ComparePlan plan = plan_comparison(inputs);
  ASSERT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.pairs[0].simulated.name, "two");
  EXPECT_EQ(plan.pairs[1].real.name, "x");
  write_file(folder() / "pairs.csv", "two,y\n");
  EXPECT_THAT([&] { plan_comparison(inputs); },
              ThrowsMessage<ConfigError>(HasSubstr("pairs.csv:1:5: there is no real picture y")));
  write_file(folder() / "pairs.csv", "two,x,a/one.png,4\n");
  EXPECT_THAT(
      [&] { plan_comparison(inputs); },
      ThrowsMessage<ConfigError>(HasSubstr("pairs.csv:1:1: 4 fields, must be two or three")));
}

TEST_F(PlanComparison, RefusesANameThatTwoPicturesHave) {
  add("a/one.png");
  add("b/01.png");
  add("c/01.png");
  write_file(folder() / "pairs.csv", "one,01\n");
  const CompareInputs inputs = {.simulated = folder() / "a",
                                .reals = {folder() / "b", folder() / "c"},
                                .pairs = folder() / "pairs.csv"};
  EXPECT_THAT([&] { plan_comparison(inputs); },
              ThrowsMessage<ConfigError>(HasSubstr(
                  "pairs.csv:1:5: 2 real pictures are called 01: name each by its path")));
  const std::string second = folder() / "c/01.png";
  write_file(folder() / "pairs.csv", "one," + second + "\n");
  EXPECT_EQ(plan_comparison(inputs).pairs[0].real.picture, second);
}

TEST_F(PlanComparison, TakesMasksOfSinglePicturesFromTheCsvFile) {
  add("a/one.png");
  add("a/two.png");
  add("b/x.png");
  add("masks/x.png");
  write_file(folder() / "pairs.csv", "simulated,real,mask\ntwo,x,masks/x.png\none,x,\n");
  const CompareInputs inputs = {
      .simulated = folder() / "a", .reals = {folder() / "b"}, .pairs = folder() / "pairs.csv"};
  const ComparePlan plan = plan_comparison(inputs);
  ASSERT_EQ(plan.pairs.size(), 2U);
  EXPECT_EQ(plan.pairs[0].real_mask, folder() / "masks/x.png");
  EXPECT_TRUE(plan.pairs[1].real_mask.empty());
  write_file(folder() / "pairs.csv", "two,x,masks/y.png\n");
  EXPECT_THAT([&] { plan_comparison(inputs); },
              ThrowsMessage<ConfigError>(HasSubstr("pairs.csv:1:7: there is no mask")));
}

// `glint render --masks` writes pictures of masks: none of them is one of the part.
TEST_F(PlanComparison, RefusesAViewOfMasksAlone) {
  for (const char* name : {"part_mask.png", "mask.png", "defects.png"}) {
    add(std::string("masks/baseline/") + name);
  }
  write_file(folder() / "masks/baseline/scene.toml", "schema = 1\n");
  for (const char* given : {"masks", "masks/baseline"}) {
    EXPECT_THAT([&] { compare_sources(folder() / given); },
                ThrowsMessage<ConfigError>(
                    HasSubstr("masks/baseline: holds the masks of a view and no picture of it")))
        << given;
  }
  add("masks/baseline/image.png");
  EXPECT_TRUE(compare_sources(folder() / "masks").front().is_rendered());
}

TEST_F(PlanComparison, RefusesWhatIsNotThere) {
  EXPECT_THROW(compare_sources(folder() / "nothing"), IoError);
  std::filesystem::create_directories(folder() / "empty");
  EXPECT_THROW(compare_sources(folder() / "empty"), ConfigError);
}

}  // namespace
}  // namespace glint
